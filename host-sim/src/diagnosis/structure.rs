//! What the lengths of lines, gaps, frames and pulses say.
//!
//! | what | file |
//! |---|---|
//! | wires that do not move, blanking that is short | here |
//! | every line of another length | `common` |
//! | single lines and frames that deviate | `deviations` |

use super::deviations::Events;
use super::finding::{Evidence, Finding, Remedy};
use super::recording::Recording;
use super::remedy;
use super::shape::{Frame, Shape};
use crate::fault::FaultKind;
use crate::frequency::most_frequent;
use crate::profile::{Profile, SyncMode};

/// The number that occurs most often.
pub(super) fn mode(numbers: impl Iterator<Item = usize>) -> Option<usize> {
    most_frequent(numbers).map(|(number, _)| number)
}

pub(super) fn median(mut numbers: Vec<usize>) -> Option<usize> {
    numbers.sort_unstable();
    numbers.get(numbers.len() / 2).copied()
}

/// The wires seen by the profile, with what both lead to.
pub(super) struct Structure<'a> {
    pub(super) profile: &'a Profile,
    pub(super) shape: &'a Shape,
    /// Clocks from a line's first sample to the next one's, as measured.
    pub(super) period: usize,
    pub(super) samples: usize,
    pub(super) height: usize,
    /// Clocks from a frame's start to its first line, as measured.
    pub(super) porch: Option<usize>,
}

/// Where a finding shows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct At {
    pub(super) clock: u64,
    pub(super) line: Option<u32>,
}

pub(super) fn found(fault: FaultKind, score: f64, at: At, evidence: Evidence, remedy: Remedy) -> Finding {
    Finding { fault, confidence: score, score, at_pclk: at.clock, line: at.line, evidence, remedy }
}

impl<'a> Structure<'a> {
    pub(super) fn new(profile: &'a Profile, shape: &'a Shape) -> Self {
        let starts = |frame: &'a Frame| frame.lines.windows(2).map(|pair| pair[1].start - pair[0].start);
        let measured = mode(shape.frames.iter().chain(&shape.open).flat_map(starts));
        let claimed = profile.clocks_per_line() as usize;
        let porches = shape.frames.iter().filter_map(|frame| Some(frame.lines.first()?.start - frame.start));
        Self {
            porch: mode(porches),
            profile,
            shape,
            period: measured.unwrap_or(claimed),
            samples: profile.samples_per_line() as usize,
            height: profile.frame.height as usize,
        }
    }

    /// Findings, the most likely first; none if everything is as the profile says.
    pub(super) fn findings(&self, recording: &Recording) -> Vec<Finding> {
        let all = self.common();
        if !all.is_empty() {
            return all;
        }
        if let Some(finding) = self.nothing(recording) {
            return vec![finding];
        }

        let mut events = Events::default();
        for (number, frame) in self.shape.frames.iter().enumerate() {
            self.frame(number, frame, &mut events);
        }
        self.rank(&events)
    }

    /// Wires that do not move at all.
    fn nothing(&self, recording: &Recording) -> Option<Finding> {
        let (hsync, vsync) = recording.edges();
        let lines = self.shape.lines().count();
        if recording.samples.is_empty() {
            let evidence =
                Evidence::new("the trace has no active edge of the pixel clock").with("clocks", 0.0);
            let remedy =
                Remedy::new("check that the sensor has its input clock and is out of reset and power-down");
            return Some(found(FaultKind::MissingClock, 0.9, At::default(), evidence, remedy));
        }
        if !self.shape.frames.is_empty() && lines > 0 {
            return None;
        }
        let numbers = |text: String| {
            Evidence::new(text)
                .with("hsync_edges", hsync as f64)
                .with("vsync_edges", vsync as f64)
                .with("lines", lines as f64)
        };
        let clocks = recording.samples.len();
        if lines == 0 && self.profile.bus.sync != SyncMode::Embedded {
            let evidence = numbers(format!("no line is valid in {clocks} clocks: HSYNC has {hsync} edges"));
            return Some(found(
                FaultKind::MissingHsync,
                0.6,
                At::default(),
                evidence,
                remedy::of(FaultKind::MissingHsync, self.profile),
            ));
        }
        // A trace that is shorter than a frame shows no end of one, and that is no fault of the wires.
        let enough = clocks as u64 > self.profile.clocks_per_frame() + self.profile.clocks_per_frame() / 2;
        enough.then(|| {
            let evidence = numbers(format!("{lines} lines and no end of a frame in {clocks} clocks"));
            found(
                FaultKind::MissingVsync,
                0.8,
                At::default(),
                evidence,
                remedy::of(FaultKind::MissingVsync, self.profile),
            )
        })
    }

    /// Gaps between lines much shorter than promised, in lines that are as they should be.
    pub(super) fn blanking(&self) -> Option<Finding> {
        let claimed = self.profile.timing.hblank as usize;
        if self.profile.bus.sync == SyncMode::Marker || claimed < 2 {
            return None;
        }
        let codes = if self.profile.bus.sync == SyncMode::Embedded { 8 } else { 0 };
        let gap = self.period.checked_sub(self.samples).filter(|gap| *gap > 0)?;
        // The codes take their clocks whatever is left between them.
        let percent = 100.0 * gap.saturating_sub(codes) as f64 / (claimed - codes).max(1) as f64;
        if percent > 75.0 || claimed == codes {
            return None;
        }
        let first = self.shape.lines().next()?;
        let at = At { clock: first.end() as u64, line: Some(0) };
        let evidence =
            Evidence::new(format!("{gap} clocks between lines where the profile promises {claimed}"))
                .with("blanking_clocks", gap as f64)
                .with("blanking_expected_clocks", claimed as f64);
        Some(found(
            FaultKind::ShortBlanking,
            0.9,
            at,
            evidence,
            remedy::of(FaultKind::ShortBlanking, self.profile),
        ))
    }
}
