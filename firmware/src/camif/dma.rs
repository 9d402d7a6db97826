//! The burst DMA: moves words from the FIFO into memory that it was lent.
//!
//! ```text
//! FIFO ≥ burst ─► request ─► (bus delay) ─► grant ─► burst ─► target 0 ─► half ─► complete ─┐
//!                                                   ▲            target 1 ◄──── Double ─────┤
//!                                                   └──── Circular: target 0 again ◄────────┘  Single: stops
//! ```
//!
//! A burst is moved at the clock of its grant: the time that its beats take is part of the bus's delay.

use super::registers::{Burst, DmaAddress, DmaControl, DmaMode, DmaStatus};
use crate::port::SLOTS;

/// State of the DMA.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct BurstDma<'m> {
    pub(super) memory: [Option<&'m mut [u32]>; SLOTS],
    pub(super) control: DmaControl,
    pub(super) status: DmaStatus,
    pub(super) targets: [DmaAddress; 2],
    /// Words a transfer, as programmed.
    pub(super) count: u32,
    /// Words left of the transfer in progress.
    pub(super) remaining: u32,
    /// Words that must press before a burst is requested; more than there can be while the DMA is off.
    threshold: u8,
}

/// A threshold that no FIFO reaches.
const OFF: u8 = u8::MAX;

impl Default for BurstDma<'_> {
    fn default() -> Self {
        Self {
            memory: Default::default(),
            control: DmaControl::default(),
            status: DmaStatus::default(),
            targets: [DmaAddress::default(); 2],
            count: 0,
            remaining: 0,
            threshold: OFF,
        }
    }
}

impl BurstDma<'_> {
    /// Takes a new control word: an enable that rises starts at target 0.
    pub(super) fn set_control(&mut self, control: DmaControl) {
        let starts = control.enable() && !self.control.enable();
        self.control = control;
        self.threshold = if control.enable() { self.burst_words() as u8 } else { OFF };
        if starts {
            self.remaining = self.count;
            self.status.set_target(false);
            if self.count == 0 {
                self.fail();
            }
        }
    }

    /// A burst is due when so many words press.
    #[inline]
    pub(super) fn is_due(&self, pressure: u8) -> bool {
        pressure >= self.threshold
    }

    #[inline]
    pub(super) fn enabled(&self) -> bool {
        self.control.enable()
    }

    /// Words a burst; the reserved value counts as one.
    pub(super) fn burst_words(&self) -> u32 {
        self.control.burst().map_or(1, Burst::words)
    }

    #[inline]
    pub(super) fn interrupt(&self) -> bool {
        // Each flag stands in the same bit as its enable.
        self.status.raw_value() & self.control.raw_value() & DmaStatus::MASK != 0
    }

    /// Index of the target in use.
    pub(super) fn current(&self) -> usize {
        usize::from(self.status.target())
    }

    /// Words that can be moved before a flag is set; those at the flag must go one by one.
    pub(super) fn words_before_event(&self) -> u32 {
        let half = self.count - self.count / 2;
        let until = if self.remaining > half { self.remaining - half } else { self.remaining };
        until.saturating_sub(1)
    }

    /// The next `words` words of the target in use, if they lie within lent memory.
    pub(super) fn window(&mut self, words: usize) -> Option<&mut [u32]> {
        let target = self.targets[self.current()];
        let start = target.word().value() as usize + (self.count - self.remaining) as usize;
        let memory = self.memory[usize::from(target.slot().value())].as_deref_mut()?;
        memory.get_mut(start..start.checked_add(words)?)
    }

    /// Moves one word, the last of its line if `last`.
    #[inline]
    pub(super) fn store(&mut self, word: u32, last: bool) {
        if !self.enabled() {
            return;
        }
        // Line by line nothing is left only when the line is longer than its transfer: the rest of it is dropped.
        if self.remaining > 0 {
            let Some([place]) = self.window(1) else { return self.fail() };
            *place = word;
            self.remaining -= 1;
            if self.remaining == self.count - self.count / 2 {
                self.status.set_half(true);
            }
        }
        let line_by_line = self.control.line_by_line();
        if if line_by_line { last } else { self.remaining == 0 } {
            self.complete();
        }
    }

    /// Ends the transfer in progress.
    pub(super) fn complete(&mut self) {
        if !self.enabled() {
            return;
        }
        self.status.set_complete(true);
        if self.control.line_by_line() {
            let moved = self.count - self.remaining;
            self.status.set_line_words(u16::try_from(moved).unwrap_or(u16::MAX));
        }
        match self.control.mode() {
            Ok(DmaMode::Double) => self.status.set_target(!self.status.target()),
            Ok(DmaMode::Circular) => {}
            // The reserved mode stops, as the harmless one.
            Ok(DmaMode::Single) | Err(_) => self.disable(),
        }
        if self.enabled() {
            self.remaining = self.count;
        }
    }

    /// The bus, or what was programmed, leads nowhere: says so, and stops.
    pub(super) fn fail(&mut self) {
        self.status.set_error(true);
        self.disable();
    }

    fn disable(&mut self) {
        self.control.set_enable(false);
        self.threshold = OFF;
    }

    /// The DMA runs and may go to memory in this slot.
    pub(super) fn aims_at(&self, slot: usize) -> bool {
        let double = self.control.mode() == Ok(DmaMode::Double);
        self.enabled()
            && self.targets.iter().enumerate().any(|(index, target)| {
                (double || index == self.current()) && usize::from(target.slot().value()) == slot
            })
    }
}
