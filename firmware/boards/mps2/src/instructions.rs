//! Counts instructions.
//!
//! With `-icount shift=0` every instruction takes a nanosecond of the machine's time, and SysTick counts that time at the
//! board's 25 MHz. How many instructions that is a tick is not assumed but measured, on a loop of known length.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;

/// SysTick counts down from here, 24 bits, and starts over.
const RELOAD: u32 = 0x00FF_FFFF;

/// Times that it started over.
static WRAPS: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    // One core, and nobody else writes.
    WRAPS.store(WRAPS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
}

/// A counter of instructions that runs.
#[derive(Debug)]
pub struct Counter {
    /// Instructions of the loop that was measured, and the ticks that it took.
    per_ticks: (u64, u64),
    /// Ticks of a count of nothing.
    overhead: u64,
    started: u64,
    /// Instructions of the count that stopped last.
    counted: u64,
}

impl Counter {
    /// Starts SysTick, and finds out how many instructions a tick takes.
    #[must_use]
    pub fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_interrupt();
        timer.enable_counter();
        // Cleared, it reads 0 until its first tick, and that 0 is no end of a round.
        while SYST::get_current() == 0 {}
        const TURNS: u32 = 1_000_000;
        let begin = ticks();
        turn(TURNS);
        let middle = ticks();
        turn(2 * TURNS);
        let end = ticks();
        // What is not the loop falls out of the difference.
        let per_ticks = (2 * u64::from(TURNS), (end - middle) - (middle - begin));
        let mut counter = Self { per_ticks, overhead: 0, started: 0, counted: 0 };
        counter.begin();
        counter.overhead = ticks() - counter.started;
        counter
    }

    /// Instructions that 1,000 ticks take.
    #[must_use]
    pub fn calibration(&self) -> u32 {
        (self.per_ticks.0 * 1000 / self.per_ticks.1.max(1)) as u32
    }

    /// Counts from here.
    pub fn begin(&mut self) {
        self.started = ticks();
    }

    /// Counts to here.
    pub fn end(&mut self) {
        let ticks = (ticks() - self.started).saturating_sub(self.overhead);
        self.counted = ticks * self.per_ticks.0 / self.per_ticks.1.max(1);
    }

    /// Instructions between the last begin and the last end; exact to about the instructions of a tick.
    #[must_use]
    pub fn counted(&self) -> u64 {
        self.counted
    }
}

impl exercise::Clock for Counter {
    fn start(&mut self) {
        self.begin();
    }

    fn stop(&mut self) {
        self.end();
    }
}

/// Ticks since the start.
fn ticks() -> u64 {
    loop {
        let wraps = WRAPS.load(Ordering::Relaxed);
        let current = SYST::get_current();
        // SysTick may have started over between the two.
        if WRAPS.load(Ordering::Relaxed) == wraps {
            return (u64::from(wraps) + 1) * (u64::from(RELOAD) + 1) - u64::from(current);
        }
    }
}

/// Two instructions a turn.
fn turn(turns: u32) {
    // SAFETY: it counts a register of its own down to 0, and touches no memory.
    unsafe {
        core::arch::asm!(
            "2: subs {turns}, #1",
            "bne 2b",
            turns = inout(reg) turns => _,
            options(nomem, nostack),
        );
    }
}
