//! Capture line by line: the state machine behind [`LineCamera`](super::LineCamera).
//!
//! ```text
//!  target 0:  line 0        line 2        line 4            the DMA holds two buffers; a line is handed on
//!  target 1:         line 1        line 3        line 5     if another buffer can take its place, else dropped
//! ```
//!
//! Where the part ends a transfer with the line, each line starts in a buffer of its own, whatever came before: a short or
//! long line damages nothing but itself. Elsewhere a transfer is the configured length of a line, so one line of another
//! length shifts all that follow until the frame's end, whose verdict says so; then the DMA starts anew.
//!
//! A frame of which no line was kept has no end either: the next verdict's `dropped_before` counts it.

use super::chunks::IN_FLIGHT;
use super::config::Config;
use super::engine::{Engine, POLLS, Progress, even_burst};
use super::machine::{Machine, Parts, Phase};
use super::meter::{Expectation, Meter};
use super::tally::{Absence, Tally};
use super::verdict::{Outcome, Verdict};
use crate::buffers::ring::{LineInfo, LineRing};
use crate::camif::registers::{Burst, DmaMode, Events, FrameRate};
use crate::port::{DmaError, Port, Target, Transfer};

/// The state of a capture of lines.
#[derive(Debug)]
pub(super) struct Lines<'m, P, const N: usize> {
    pub(super) engine: Engine<'m, P>,
    pub(super) ring: LineRing<N>,
    pub(super) phase: Phase,
    burst: Burst,
    /// The part ends a transfer with the line.
    by_line: bool,
    expected: Expectation,
    meter: Meter,
    /// Buffers at targets 0 and 1.
    aimed: [u8; 2],
    /// Bytes of the line that ended last, if they were counted.
    line_bytes: Option<u32>,
    /// Lines of the frame that are complete in memory, and how many of them were kept.
    complete: u32,
    kept: u32,
    /// The frame has ended on the wires, and its last line is on its way.
    ended: Option<Verdict>,
    /// A line or an end is there that the consumer was not woken for.
    pub(super) fresh: bool,
    pub(super) tally: Tally,
}

impl<'m, P: Port<'m>, const N: usize> Machine<'m> for Lines<'m, P, N> {
    type Port = P;

    fn parts(&mut self) -> Parts<'_, 'm, P> {
        let Self { engine, phase, meter, tally, fresh, .. } = self;
        Parts { engine, phase: *phase, meter, tally, fresh }
    }

    fn run(&mut self, events: Events) -> Result<(), Outcome> {
        if events.line() {
            let bytes = self.engine.line_bytes();
            self.meter.line(&self.expected, bytes);
            self.line_bytes = Some(bytes);
        }
        self.advance()?;
        if events.frame() { self.frame_ended() } else { Ok(()) }
    }

    fn lose(&mut self, outcome: Outcome, in_frame: bool) {
        self.tally.evidence.words_moved |= self.position() > 0;
        let ended = self.ended.take();
        self.tally.lose_in_flight(outcome, ended.is_some(), in_frame);
        let bytes = self.complete.saturating_mul(self.expected.line_bytes);
        let verdict = ended.unwrap_or_else(|| self.sealed(bytes, Some(self.complete)));
        // The frame's end says why.
        self.put_end(Verdict { outcome, overruns: self.tally.statistics.overruns, ..verdict });
        self.recover();
    }

    fn restart(&mut self) {
        if self.engine.is_quiet() {
            // A refusal is told to whoever waits.
            let _ = self.launch();
        } else {
            self.phase = Phase::Flushing;
        }
    }

    fn position(&mut self) -> u32 {
        let complete = self.complete.saturating_mul(self.expected.line_bytes) / 4;
        if self.phase == Phase::Running { complete + self.engine.moved() } else { 0 }
    }
}

impl<'m, P: Port<'m>, const N: usize> Lines<'m, P, N> {
    pub(super) fn new(engine: Engine<'m, P>) -> Self {
        Self {
            engine,
            ring: LineRing::new(),
            phase: Phase::Stopped,
            burst: Burst::One,
            by_line: false,
            expected: Expectation::default(),
            meter: Meter::default(),
            aimed: [0; 2],
            line_bytes: None,
            complete: 0,
            kept: 0,
            ended: None,
            fresh: false,
            tally: Tally::new(0, FrameRate::All),
        }
    }

    /// Starts as configured. The configuration has been linted, and the buffers are long enough.
    pub(super) fn start(&mut self, config: &Config) -> Result<(), DmaError> {
        self.stop();
        let part = self.engine.port().part();
        // Without counters nothing would be read at a line's end that its transfer does not tell.
        let measured = config.line_interrupts && part.counters;
        self.expected = Expectation::new(&Config { line_interrupts: measured, ..*config }, &part);
        self.by_line = part.line_by_line;
        let words = self.expected.line_bytes.div_ceil(4);
        self.burst = if self.by_line { config.burst } else { even_burst(config.burst, words) };
        self.tally = Tally::new(self.expected.words, config.frame_rate);
        self.engine.program(config, false, measured);
        self.launch()
    }

    /// Stops at once. Lines that are ready are given up; leased ones stay.
    pub(super) fn stop(&mut self) {
        self.engine.off();
        self.phase = Phase::Stopped;
        self.ring.clear();
        self.ended = None;
    }

    /// Hands on a line that is complete, if another buffer can take its place.
    fn advance(&mut self) -> Result<(), Outcome> {
        let Progress::Completed { freed, line_words } = self.engine.progress()? else { return Ok(()) };
        self.tally.evidence.words_moved = true;
        let bytes = self.bytes_of_line(line_words);
        let place = &mut self.aimed[usize::from(freed == Target::One)];
        let slot = usize::from(*place);
        let frame = self.ended.map_or(self.tally.sequence(), |verdict| verdict.sequence);
        let line = LineInfo { frame, index: self.complete, bytes };
        self.complete += 1;
        match self.ring.claim() {
            Some(free) => {
                *place = free as u8;
                self.engine.aim_free(free as u8, 0)?;
                self.ring.push(slot, line);
                self.kept += 1;
                self.fresh = true;
            }
            None => {
                let dropped = &mut self.tally.statistics.lines_dropped;
                *dropped = dropped.wrapping_add(1);
            }
        }
        if let Some(verdict) = self.ended.filter(|verdict| verdict.lines <= self.complete) {
            self.ended = None;
            self.end_frame(verdict);
        }
        Ok(())
    }

    fn bytes_of_line(&mut self, line_words: u32) -> u32 {
        if !self.by_line {
            return self.expected.line_bytes;
        }
        let most = line_words.saturating_mul(4).min(self.expected.line_bytes);
        match self.line_bytes.take() {
            // To the byte, if this is the line that was counted.
            Some(bytes) if bytes.div_ceil(4) == line_words => bytes.min(most),
            _ => most,
        }
    }

    fn frame_ended(&mut self) -> Result<(), Outcome> {
        if self.ended.is_some() {
            // The last line of the frame before is still in the FIFO.
            return Err(Outcome::DmaStalled);
        }
        if !self.tally.account() {
            return Err(Outcome::LateInterrupt);
        }
        let verdict = self.judge().inspect_err(|&outcome| self.tally.lose(outcome))?;
        let missing = verdict.lines.saturating_sub(self.complete);
        if missing > 0 && self.starts_lines_anew(&verdict) {
            // A line is a word at least, so no more of them can be on their way.
            if missing > IN_FLIGHT {
                self.tally.lose(Outcome::LateInterrupt);
                return Err(Outcome::LateInterrupt);
            }
            self.ended = Some(verdict);
            return Ok(());
        }
        let shifted = !self.starts_lines_anew(&verdict);
        self.end_frame(verdict);
        if shifted {
            self.recover();
        }
        Ok(())
    }

    /// The next frame's first line will be at the start of a buffer.
    fn starts_lines_anew(&self, verdict: &Verdict) -> bool {
        self.by_line || verdict.outcome.is_good()
    }

    fn judge(&mut self) -> Result<Verdict, Outcome> {
        if self.expected.counters {
            let (bytes, lines) = self.engine.frame_counts();
            let last = self.engine.line_bytes();
            self.meter.close(&self.expected, lines, last);
            if lines > self.complete {
                self.line_bytes = Some(last);
            }
            return Ok(self.sealed(bytes, Some(lines)));
        }
        for _ in 0..POLLS {
            let empty = !self.engine.status().fifo_not_empty();
            self.advance()?;
            if empty {
                let rest = self.engine.moved();
                let bytes = self.complete.saturating_mul(self.expected.line_bytes).saturating_add(rest * 4);
                return Ok(self.sealed(bytes, None));
            }
        }
        Err(Outcome::DmaStalled)
    }

    fn sealed(&mut self, bytes: u32, lines: Option<u32>) -> Verdict {
        let meter = core::mem::take(&mut self.meter);
        let overruns = self.tally.statistics.overruns;
        let verdict = self.expected.verdict(bytes, lines, &meter);
        Verdict { sequence: self.tally.sequence(), overruns, ..verdict }
    }

    /// The last line of a frame has been handed on or dropped.
    fn end_frame(&mut self, mut verdict: Verdict) {
        let dropped = self.complete.saturating_sub(self.kept);
        if dropped > 0 && verdict.outcome.is_good() {
            verdict.outcome = Outcome::LinesDropped { lines: dropped };
        }
        let statistics = &mut self.tally.statistics;
        match verdict.outcome {
            Outcome::Good => statistics.delivered = statistics.delivered.wrapping_add(1),
            Outcome::LinesDropped { .. } => statistics.dropped = statistics.dropped.wrapping_add(1),
            outcome => self.tally.lose(outcome),
        }
        self.put_end(verdict);
    }

    fn put_end(&mut self, verdict: Verdict) {
        if self.kept > 0 {
            self.ring.end_frame(verdict);
            self.fresh = true;
        }
        (self.complete, self.kept) = (0, 0);
    }

    /// Stops the DMA and what is being captured, and starts again.
    fn recover(&mut self) {
        self.engine.stop_dma();
        self.ring.disarm();
        self.engine.capture(false);
        self.tally.absence = Absence::Lost;
        self.restart();
    }

    /// Aims at two free buffers and lets the next frame in.
    fn launch(&mut self) -> Result<(), DmaError> {
        self.meter = Meter::default();
        (self.complete, self.kept, self.line_bytes) = (0, 0, None);
        let (Some(first), Some(second)) = (self.ring.claim(), self.ring.claim()) else {
            self.ring.disarm();
            self.phase = Phase::Paused;
            self.tally.absence = Absence::Dropped;
            return Ok(());
        };
        self.aimed = [first as u8, second as u8];
        let transfer = Transfer {
            words: self.expected.line_bytes.div_ceil(4),
            mode: DmaMode::Double,
            burst: self.burst,
            line_by_line: self.by_line,
            half_interrupt: false,
        };
        let aimed = self.engine.aim(Target::Zero, first as u8, 0);
        let aimed = aimed.and_then(|()| self.engine.aim(Target::One, second as u8, 0));
        match aimed.and_then(|()| self.engine.arm(transfer)) {
            Ok(()) => self.phase = Phase::Running,
            Err(error) => {
                self.stop();
                self.tally.evidence.refused = true;
                return Err(error);
            }
        }
        Ok(())
    }

    /// A leased buffer is free again.
    pub(super) fn release(&mut self, slot: usize) {
        self.ring.release(slot);
        if self.phase == Phase::Paused {
            self.restart();
        }
    }
}
