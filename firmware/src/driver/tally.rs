//! The count of frames: each one on the wires ends up in exactly one column of [`Statistics`].

use super::deadline::Evidence;
use super::machine::Phase;
use super::verdict::{Outcome, Statistics, Verdict};
use crate::camif::registers::{Events, FrameRate};

/// Which column takes a frame that is not captured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Absence {
    /// The consumer did not keep up.
    Dropped,
    /// Capture recovers.
    Lost,
    /// It was not asked for.
    Skipped,
}

/// Frames on the wires, and what became of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tally {
    pub(super) statistics: Statistics,
    pub(super) evidence: Evidence,
    /// Frame ends on the wires since the start: the sequence number of the frame in progress.
    passed: u32,
    /// The frame in progress is accounted for, or will be when its buffer is.
    accounted: bool,
    /// A frame was captured, from which on all count.
    begun: bool,
    /// The column of frames that are not captured while capture runs.
    uncaptured: Absence,
    /// The column of the frame in progress unless it is captured.
    pub(super) absence: Absence,
    /// Sequence number after that of the frame handed out last.
    next: u32,
    /// Overruns before it.
    overruns_before: u32,
}

impl Tally {
    /// Nothing counted yet of frames of so many words, all of which or some are wanted.
    pub(super) fn new(words_expected: u32, rate: FrameRate) -> Self {
        Self {
            statistics: Statistics::default(),
            evidence: Evidence::expecting(words_expected),
            passed: 0,
            accounted: false,
            begun: false,
            uncaptured: if rate == FrameRate::All { Absence::Lost } else { Absence::Skipped },
            absence: Absence::Lost,
            next: 0,
            overruns_before: 0,
        }
    }

    /// Sequence number of the frame in progress.
    pub(super) fn sequence(&self) -> u32 {
        self.passed
    }

    /// The frame in progress was captured, or damaged: false if that was known already.
    pub(super) fn account(&mut self) -> bool {
        if !self.begun {
            (self.begun, self.next) = (true, self.passed);
        }
        !core::mem::replace(&mut self.accounted, true)
    }

    /// A frame is lost that was captured whole or in part.
    pub(super) fn lose(&mut self, outcome: Outcome) {
        self.statistics.lost = self.statistics.lost.wrapping_add(1);
        self.evidence.damage(outcome);
    }

    /// What was in flight is lost: the frame that had `ended`, and the one on the wires if it is touched.
    pub(super) fn lose_in_flight(&mut self, outcome: Outcome, ended: bool, in_frame: bool) {
        if ended {
            self.lose(outcome);
        }
        if (in_frame || !ended) && self.account() {
            self.lose(outcome);
        }
        if outcome == Outcome::DmaError {
            self.statistics.dma_errors = self.statistics.dma_errors.wrapping_add(1);
        }
    }

    /// Frames were recycled before they were taken.
    pub(super) fn drop_ready(&mut self, frames: u32) {
        self.statistics.dropped = self.statistics.dropped.wrapping_add(frames);
    }

    /// Overruns and errors count as they happen. `Err` if there was one, the overrun before the error.
    pub(super) fn events(&mut self, events: Events) -> Result<(), Outcome> {
        let (statistics, evidence) = (&mut self.statistics, &mut self.evidence);
        if events.overrun() {
            statistics.overruns = statistics.overruns.wrapping_add(1);
            evidence.overruns = evidence.overruns.saturating_add(1);
        }
        if events.error() {
            statistics.sync_errors = statistics.sync_errors.wrapping_add(1);
        }
        match () {
            () if events.overrun() => Err(Outcome::Overrun),
            () if events.error() => Err(Outcome::SyncError),
            () => Ok(()),
        }
    }

    /// A frame ended on the wires. The phase tells the column of the next one unless it is captured.
    pub(super) fn vsync(&mut self, phase: Phase) {
        self.passed = self.passed.wrapping_add(1);
        self.evidence.vsyncs = self.evidence.vsyncs.saturating_add(1);
        let statistics = &mut self.statistics;
        if !core::mem::take(&mut self.accounted) && self.begun {
            let column = match self.absence {
                Absence::Dropped => &mut statistics.dropped,
                Absence::Lost => &mut statistics.lost,
                Absence::Skipped => &mut statistics.skipped,
            };
            *column = column.wrapping_add(1);
        }
        self.absence = match phase {
            Phase::Paused => Absence::Dropped,
            Phase::Idle | Phase::Stopped => Absence::Skipped,
            Phase::Flushing => Absence::Lost,
            Phase::Running => self.uncaptured,
        };
    }

    /// A line ended on the wires.
    pub(super) fn line(&mut self) {
        self.evidence.lines = self.evidence.lines.saturating_add(1);
    }

    /// A frame is handed to the consumer.
    pub(super) fn deliver(&mut self, verdict: &mut Verdict) {
        self.statistics.delivered = self.statistics.delivered.wrapping_add(1);
        self.hand_out(verdict);
    }

    /// A verdict is handed out: it says what was missed before it, and a wait starts anew.
    pub(super) fn hand_out(&mut self, verdict: &mut Verdict) {
        verdict.dropped_before = verdict.sequence.wrapping_sub(self.next);
        // The verdict holds the sum since the start until now.
        let overruns = verdict.overruns;
        verdict.overruns = overruns.wrapping_sub(self.overruns_before);
        (self.next, self.overruns_before) = (verdict.sequence.wrapping_add(1), overruns);
        self.evidence = Evidence::expecting(self.evidence.words_expected);
    }
}
