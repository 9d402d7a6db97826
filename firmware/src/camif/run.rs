//! Many pixel clocks at once: a stretch at constant sync levels.
//!
//! [`Camif::run`] does what [`Camif::step`] would, clock by clock, and stops where software would be called. It takes two
//! short cuts, each of which ends before the next event, so that every event happens in `step` and nowhere else:
//!
//! - **Idle**: nothing of the stretch is taken (blanking, a frame that is not captured, outside the crop window) and the
//!   DMA is at rest. Time and the clock count jump.
//! - **Lock-step**: bytes flow into memory, and no grant can be so late that the next word finds the burst still waiting.
//!   Then every burst goes the same way and only the last one is left in the FIFO, so the rest is one copy. Where the bus
//!   may be later than that, `step` plays each clock.

use super::block::{Camif, NEVER};
use super::pins::{Pins, Samples, Sync};
use super::selection::{ALL_BYTES, Selection};

impl Camif<'_> {
    /// A stretch of pixel clocks at constant sync levels; returns how many of them were played.
    ///
    /// It returns after the clock at which an interrupt line rises, for the handler to be called, and otherwise plays
    /// them all. Call it again with what is left.
    pub fn run(&mut self, sync: Sync, samples: Samples<'_>) -> usize {
        let before = self.interrupts();
        let total = samples.len();
        let mut done = 0;
        while done < total {
            let skipped = self.leap(sync, samples.skip(done));
            if skipped > 0 {
                done += skipped;
                continue;
            }
            self.step(Pins { sync, data: samples.get(done).unwrap_or(0) });
            done += 1;
            if self.interrupts().rose_since(before) {
                break;
            }
        }
        done
    }

    /// Plays as many clocks as can be played without an event; 0 if the next one must be stepped.
    #[inline]
    fn leap(&mut self, sync: Sync, samples: Samples<'_>) -> usize {
        let enabled = self.control.enable();
        if enabled && (self.levels != Some(sync) || self.control.embedded_sync()) {
            return 0;
        }
        let from = self.selection.from;
        if !enabled || !self.in_line || self.selection == Selection::NOTHING || self.x >= self.selection.to {
            self.idle(samples.len())
        } else if self.x < from {
            self.idle(samples.len().min((from - self.x) as usize))
        } else {
            self.flow(samples.take((self.selection.to - self.x) as usize))
        }
    }

    fn idle(&mut self, clocks: usize) -> usize {
        if self.grant_at != NEVER || self.wants_bus() {
            return 0;
        }
        self.clock += clocks as u64;
        if self.in_line && self.control.enable() {
            self.x = self.x.wrapping_add(clocks as u32);
        }
        clocks
    }

    fn flow(&mut self, samples: Samples<'_>) -> usize {
        let per_word = 32_u32.checked_div(self.sample_bits).map_or(1, |samples| samples.max(1));
        let burst = self.dma.burst_words();
        // The same bus width on both sides, or the samples would have to be converted one by one.
        let fits = match samples {
            Samples::Bytes(_) => self.sample_bits == 8,
            Samples::Words(_) => self.sample_bits == 16,
            Samples::Repeat { .. } => false,
        };
        if !fits || self.selection.bytes != ALL_BYTES || !self.packer.is_empty() || !self.dma.enabled() {
            return 0;
        }
        // Words that wait: none, or one whole burst whose grant comes before the next word.
        let waiting = if self.grant_at == NEVER {
            if !self.fifo.is_empty() || self.bus_busy_until > self.clock {
                return 0;
            }
            0
        } else {
            let soon = self.grant_at <= self.clock + u64::from(per_word);
            if !soon || self.fifo.len() as u32 != burst || self.fifo.holds_last() {
                return 0;
            }
            burst
        };
        // `stored` words go to memory: those that wait and all that come, but for the last burst.
        let available = samples.len() as u32 / per_word;
        let stored = (available + waiting).saturating_sub(burst).min(self.dma.words_before_event());
        // Never zero, which the compiler cannot see.
        let burst = burst.max(1);
        let words = (stored + burst - waiting) / burst * burst;
        let stored = words + waiting - burst;
        let bursts = u64::from(words / burst);
        let requests = self.requests..self.requests + bursts;
        // The request that is pending is the one before.
        let fails =
            self.bus.error.is_some_and(|at| (requests.start.saturating_sub(1)..requests.end).contains(&at));
        if words < 2 * burst || fails || self.bus.delay_bound(requests.start, requests.end) >= per_word {
            return 0;
        }
        let mask = self.data_mask;
        let old = self.fifo.len();
        let Some((first, rest)) =
            self.dma.window(stored as usize).and_then(|window| window.split_at_mut_checked(old))
        else {
            return 0;
        };
        for (place, (word, _)) in first.iter_mut().zip(core::iter::from_fn(|| self.fifo.pop())) {
            *place = word;
        }
        let clocks = (words * per_word) as usize;
        let tail = clocks - (burst * per_word) as usize;
        match samples {
            Samples::Bytes(bytes) => pack_bytes(rest, bytes),
            Samples::Words(samples) => pack_words(rest, samples, mask),
            Samples::Repeat { .. } => {}
        }
        let mut last = [0; super::fifo::FIFO_WORDS];
        let last = last.get_mut(..burst as usize).unwrap_or_default();
        match samples {
            Samples::Bytes(bytes) => pack_bytes(last, bytes.get(tail..).unwrap_or_default()),
            Samples::Words(samples) => pack_words(last, samples.get(tail..).unwrap_or_default(), mask),
            Samples::Repeat { .. } => {}
        }
        for &mut word in last {
            self.fifo.push(word);
        }
        self.dma.remaining -= stored;
        self.x += clocks as u32;
        self.bytes_in_line += words * 4;
        self.clock += clocks as u64;
        self.requests += bursts;
        self.grant_at = self.clock + 1 + u64::from(self.bus.delay(self.requests - 1));
        clocks
    }
}

/// Fills `words` from the start of `bytes`, which must hold enough.
#[inline]
fn pack_bytes(words: &mut [u32], bytes: &[u8]) {
    for (word, chunk) in words.iter_mut().zip(bytes.as_chunks().0) {
        *word = u32::from_le_bytes(*chunk);
    }
}

/// Fills `words` from the start of `samples`, which must hold enough.
#[inline]
fn pack_words(words: &mut [u32], samples: &[u16], mask: u32) {
    for (word, &[low, high]) in words.iter_mut().zip(samples.as_chunks().0) {
        *word = (u32::from(low) & mask) | (u32::from(high) & mask) << 16;
    }
}
