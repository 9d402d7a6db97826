//! Milliseconds by SysTick, which also wake the core that sleeps.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;

static MILLISECONDS: AtomicU32 = AtomicU32::new(0);
/// How often they have wrapped.
static WRAPS: AtomicU32 = AtomicU32::new(0);

/// Starts counting.
pub fn start(mut systick: SYST, core_hz: u32) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(core_hz / 1_000 - 1);
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
}

/// Milliseconds since [`start`]; wraps after 49 days.
#[must_use]
pub fn now() -> u32 {
    MILLISECONDS.load(Ordering::Relaxed)
}

#[exception]
fn SysTick() {
    // One writer, and no read-modify-write by others: a load and a store are enough.
    let next = now().wrapping_add(1);
    MILLISECONDS.store(next, Ordering::Relaxed);
    if next == 0 {
        WRAPS.store(WRAPS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    }
}

/// The time on the link: microseconds since [`start`], in steps of a millisecond; does not wrap. Not for handlers.
#[must_use]
pub fn microseconds() -> u64 {
    loop {
        let wraps = WRAPS.load(Ordering::Relaxed);
        let milliseconds = now();
        // The handler comes as a whole between two of these loads.
        if wraps == WRAPS.load(Ordering::Relaxed) {
            return ((u64::from(wraps) << 32) + u64::from(milliseconds)) * 1_000;
        }
    }
}

/// Sleeps until something happens, a tick at the latest; returns the time then, as [`microseconds`].
pub fn sleep() -> u64 {
    cortex_m::asm::wfi();
    microseconds()
}

/// Waits whole milliseconds, rounded up; asleep but for the ticks.
pub struct Delay;

impl embedded_hal::delay::DelayNs for Delay {
    fn delay_ns(&mut self, nanoseconds: u32) {
        self.delay_ms(nanoseconds.div_ceil(1_000_000));
    }

    fn delay_us(&mut self, microseconds: u32) {
        self.delay_ms(microseconds.div_ceil(1_000));
    }

    fn delay_ms(&mut self, milliseconds: u32) {
        let start = now();
        // The tick in progress is not a whole one.
        while now().wrapping_sub(start) <= milliseconds {
            cortex_m::asm::wfi();
        }
    }
}
