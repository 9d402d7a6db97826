//! Time since the start, by CMSDK timer 1, which also wakes the core that sleeps.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;

use crate::rig::Line;

/// Registers of CMSDK timer 1 (Arm DDI0479, 3.5).
const CONTROL: *mut u32 = 0x4000_1000 as *mut u32;
const VALUE: *mut u32 = 0x4000_1004 as *mut u32;
const RELOAD: *mut u32 = 0x4000_1008 as *mut u32;
const CLEAR: *mut u32 = 0x4000_100C as *mut u32;

/// Clocks of a microsecond.
const PER_MICROSECOND: u32 = 25;
/// Clocks of a millisecond.
const PER_MILLISECOND: u32 = 1_000 * PER_MICROSECOND;

static MILLISECONDS: AtomicU32 = AtomicU32::new(0);

/// Starts counting, an interrupt a millisecond.
pub fn start() {
    // SAFETY: the timer's registers by the boards' memory map, written whole; its interrupt is still masked.
    unsafe { RELOAD.write_volatile(PER_MILLISECOND - 1) };
    // SAFETY: as above; enables timer and interrupt.
    unsafe { CONTROL.write_volatile(0b1001) };
    // SAFETY: the handler is in place, and no critical section relies on a masked interrupt.
    unsafe { NVIC::unmask(Line::Timer1) };
}

/// Microseconds since [`start`]; wraps after 49 days.
#[must_use]
pub fn microseconds() -> u64 {
    loop {
        let milliseconds = MILLISECONDS.load(Ordering::Relaxed);
        // SAFETY: as in `start`; reading has no effect.
        let left = unsafe { VALUE.read_volatile() };
        // A millisecond may have ended between the two.
        if MILLISECONDS.load(Ordering::Relaxed) == milliseconds {
            let part = PER_MILLISECOND.saturating_sub(left) / PER_MICROSECOND;
            return u64::from(milliseconds) * 1_000 + u64::from(part);
        }
    }
}

/// The timer's interrupt.
pub(crate) fn on_interrupt() {
    // SAFETY: acknowledges the interrupt, which is the only thing that this register does.
    unsafe { CLEAR.write_volatile(1) };
    // One writer, and no read-modify-write by others: a load and a store are enough.
    MILLISECONDS.store(MILLISECONDS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
}
