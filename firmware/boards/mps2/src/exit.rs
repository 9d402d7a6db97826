//! How an image ends: QEMU's exit status is 0 if all went well, and 1 after a failed check, a panic or a fault.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use defmt_semihosting as _;

/// All went well.
pub fn success() -> ! {
    defmt::flush();
    debug::exit(EXIT_SUCCESS);
    halt()
}

/// Something did not; the reason has been logged.
pub fn failure() -> ! {
    defmt::flush();
    debug::exit(EXIT_FAILURE);
    halt()
}

/// Nothing is left to do if the semihosting host did not end the machine.
fn halt() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
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

// SAFETY: an exception that nobody expects; nothing of the interrupted code runs again.
#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    defmt::error!("unexpected exception {=i16}", number);
    failure()
}
