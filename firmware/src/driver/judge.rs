//! How the end of a frame is judged: at once by the block's counters, else by the DMA's position.
//!
//! ```text
//!          counters                        no counters                     one by one
//! FRAME ─► bytes and lines are exact? ─►   FIFO drained (bounded)          FIFO drained (bounded)
//!          ready when its last             position is exactly             position is the length
//!          transfer completes              the frame's end?
//! ```

use super::chunks::IN_FLIGHT;
use super::config::Damaged;
use super::engine::POLLS;
use super::frames::{Filling, Frames};
use super::machine::Machine;
use super::verdict::{Outcome, Verdict};
use crate::port::Port;

impl<'m, P: Port<'m>, const N: usize> Frames<'m, P, N> {
    /// A frame, or its crop window, has ended on the wires.
    pub(super) fn frame_ended(&mut self) -> Result<(), Outcome> {
        if !self.tally.account() {
            // Two ends of frames at one passing: the interrupt was served more than a frame late.
            return Err(Outcome::LateInterrupt);
        }
        let judged = match () {
            () if !self.plan.seamless => self.judge_alone(),
            () if self.expected.counters => self.judge_by_counters(),
            () => self.judge_by_position(),
        };
        if let Err(outcome) = judged {
            // It is accounted for, so losing it counts here.
            self.tally.lose(outcome);
        }
        judged
    }

    fn judge_by_counters(&mut self) -> Result<(), Outcome> {
        let verdict = self.counted();
        if verdict.outcome.is_good() {
            return self.whole(verdict);
        }
        let words = (verdict.bytes / 4).min(self.expected.words);
        if self.damaged == Damaged::Deliver {
            self.drain(|frames| frames.position() >= words)?;
        }
        self.damage(verdict)
    }

    fn judge_by_position(&mut self) -> Result<(), Outcome> {
        self.drain(|_| false)?;
        // What is in the next frame's buffer already is too much of this one: its first words are not due yet.
        let beyond = match (self.transferred, self.filling) {
            (Some(_), next) => next.map_or(0, |next| next.window * self.plan.chunk) + self.engine.moved(),
            (None, _) => 0,
        };
        let bytes = (self.position() + beyond).saturating_mul(4);
        let words_lost = self.expected.bytes % 4;
        let verdict =
            self.sealed(bytes + if bytes / 4 == self.expected.words { words_lost } else { 0 }, None);
        if verdict.outcome.is_good() { self.whole(verdict) } else { self.damage(verdict) }
    }

    fn judge_alone(&mut self) -> Result<(), Outcome> {
        // With the buffer full, what is left in the FIFO is too much.
        let drained = self.drain(|_| false);
        drained.map_err(|outcome| if self.full() { self.too_long() } else { outcome })?;
        let words = self.position();
        let verdict = if self.expected.counters {
            let verdict = self.counted();
            let arrived = if self.expected.jpeg { verdict.bytes.div_ceil(4) } else { verdict.bytes / 4 };
            if arrived != words && verdict.outcome.is_good() {
                return Err(Outcome::DmaStalled);
            }
            verdict
        } else {
            let rest =
                if self.expected.jpeg || words != self.expected.words { 0 } else { self.expected.bytes % 4 };
            self.sealed(words.saturating_mul(4) + rest, None)
        };
        if !verdict.outcome.is_good() {
            return self.damage(verdict);
        }
        let Some(filling) = self.filling.take() else { return Err(Outcome::LateInterrupt) };
        self.engine.stop_dma();
        self.finish(filling.slot, verdict)
    }

    /// The verdict by the counters.
    fn counted(&mut self) -> Verdict {
        let (bytes, lines) = self.engine.frame_counts();
        let last = self.engine.line_bytes();
        self.meter.close(&self.expected, lines, last);
        self.sealed(bytes, Some(lines))
    }

    fn sealed(&mut self, bytes: u32, lines: Option<u32>) -> Verdict {
        let meter = core::mem::take(&mut self.meter);
        let verdict = self.expected.verdict(bytes, lines, &meter);
        let overruns = self.tally.statistics.overruns;
        Verdict { sequence: self.tally.sequence(), overruns, ..verdict }
    }

    /// A good frame has ended: it is ready as soon as its last word is in memory.
    fn whole(&mut self, verdict: Verdict) -> Result<(), Outcome> {
        if let Some(slot) = self.transferred.take() {
            return self.finish(slot, verdict);
        }
        let missing = self.expected.words.saturating_sub(self.position());
        match &mut self.filling {
            // All its words have left the wires, so only what the FIFO holds may be missing.
            Some(filling) if filling.ended.is_none() && missing <= IN_FLIGHT => {
                filling.ended = Some(verdict);
                Ok(())
            }
            _ => Err(Outcome::LateInterrupt),
        }
    }

    /// A frame that is not as configured has ended: hands it out if that is wanted, and starts anew.
    fn damage(&mut self, verdict: Verdict) -> Result<(), Outcome> {
        // Without a next buffer what is too much of a frame runs over its own.
        let no_next = self.filling.is_none() || !self.plan.seamless && self.full();
        let spilled = matches!(verdict.outcome, Outcome::Long { .. }) && no_next;
        if self.damaged == Damaged::Discard || !verdict.outcome.is_in_place() || spilled {
            return Err(verdict.outcome);
        }
        let slot = self.transferred.take().or_else(|| self.filling.take().map(|filling| filling.slot));
        if let Some(slot) = slot {
            self.pool.finish(usize::from(slot), verdict);
            (self.fresh, self.pending) = (true, false);
        }
        self.tally.evidence.damage(verdict.outcome);
        self.recover();
        Ok(())
    }

    fn full(&self) -> bool {
        self.filling.is_some_and(|Filling { window, .. }| window >= self.plan.count)
    }

    /// Waits, within bounds, until the DMA has emptied the FIFO or `enough` of it.
    fn drain(&mut self, enough: impl Fn(&mut Self) -> bool) -> Result<(), Outcome> {
        for _ in 0..POLLS {
            // Empty first, progress after: what left the FIFO before the look is counted.
            let empty = !self.engine.status().fifo_not_empty();
            self.advance()?;
            if empty || enough(self) {
                return Ok(());
            }
        }
        Err(Outcome::DmaStalled)
    }
}
