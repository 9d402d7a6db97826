//! How an image ends: QEMU's exit status is 0 if all went well, and 1 after a failed check, a panic or a fault.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use defmt_semihosting as _;
use semihosting::process;

/// All went well.
pub fn success() -> ! {
    process::exit(0)
}

/// Something did not; the reason has been logged.
pub fn failure() -> ! {
    process::exit(1)
}

#[panic_handler]
fn panicked(_: &PanicInfo<'_>) -> ! {
    defmt::error!("panicked");
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
