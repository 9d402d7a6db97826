//! How an image ends: QEMU's exit status is 0 if all went well, and 1 after a failed check, a panic or a fault.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m_rt::{ExceptionFrame, exception};
use defmt_semihosting as _;
use semihosting::process;

use crate::stack;

/// All went well: tells how deep the stack went.
pub fn success() -> ! {
    defmt::info!("measured stack high-water mark, bytes {=u32}", stack::high_water());
    process::exit(0)
}

/// Something did not; the reason has been logged.
pub fn failure() -> ! {
    process::exit(1)
}

#[panic_handler]
fn panicked(_: &PanicInfo<'_>) -> ! {
    static AGAIN: AtomicBool = AtomicBool::new(false);
    // The log itself may have been what panicked.
    if !AGAIN.swap(true, Ordering::Relaxed) {
        defmt::error!("panicked");
    }
    failure()
}

#[defmt::panic_handler]
fn defmt_panicked() -> ! {
    failure()
}

// SAFETY: the handler only reads the frame, which cortex-m-rt stacked, and never returns to what faulted.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    defmt::error!("hard fault at {=u32:#010x}, called from {=u32:#010x}", frame.pc(), frame.lr());
    failure()
}

// SAFETY: interrupts that the rig knows are served by safe code of its own; nothing of what any other interrupted runs
// again.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    if !crate::rig::dispatch(number) {
        defmt::error!("unexpected exception {=i16}", number);
        failure()
    }
}
