//! What the lengths of lines, gaps, frames and pulses say.
//!
//! ```text
//! line longer or shorter ─► and the line's period with it?  ─ yes ─► clocks too many or too few
//!                                                           └ no ──► its end moved
//! two lines that make one ─► a pulse within a line      one that makes two ─► a line's end is missing
//! ```

use std::collections::BTreeMap;

use super::finding::{Evidence, Finding, Remedy};
use super::recording::Recording;
use super::remedy;
use super::shape::{Frame, Line, Shape};
use crate::fault::FaultKind;
use crate::profile::{Profile, SyncMode};

/// Longest pulse within a line that is a spurious end of line, in clocks.
const SPURIOUS: usize = 64;

/// What deviates, by class: how often, and where first.
#[derive(Debug, Default)]
pub(super) struct Events(BTreeMap<FaultKind, (u64, u64, Option<u32>)>);

impl Events {
    fn add(&mut self, kind: FaultKind, at: usize, line: Option<usize>) {
        let line = line.map(|line| line as u32);
        self.0.entry(kind).or_insert((0, at as u64, line)).0 += 1;
    }

    pub(super) fn count(&self, kind: FaultKind) -> u64 {
        self.0.get(&kind).map_or(0, |(count, ..)| *count)
    }

    fn total(&self) -> u64 {
        self.0.values().map(|(count, ..)| count).sum()
    }
}

/// Numbers that occur most often.
pub(super) fn mode(numbers: impl Iterator<Item = usize>) -> Option<usize> {
    let mut counts = BTreeMap::new();
    for number in numbers {
        *counts.entry(number).or_insert(0usize) += 1;
    }
    counts.into_iter().max_by_key(|&(number, count)| (count, number)).map(|(number, _)| number)
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
    period: usize,
    samples: usize,
    height: usize,
    /// Clocks from a frame's start to its first line, as measured.
    porch: Option<usize>,
}

/// Where a finding shows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct At {
    pub(super) clock: u64,
    pub(super) line: Option<u32>,
}

pub(super) fn found(
    fault: FaultKind,
    confidence: f64,
    at: At,
    evidence: Evidence,
    remedy: Remedy,
) -> Finding {
    Finding { fault, confidence, at_pclk: at.clock, line: at.line, evidence, remedy }
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

    /// What is wrong with every line alike.
    fn common(&self) -> Vec<Finding> {
        let lengths: Vec<usize> = self.shape.lines().map(|line| line.length).collect();
        let Some(usual) = median(lengths.clone()) else { return Vec::new() };
        let near = |length: usize| lengths.iter().filter(|l| l.abs_diff(length) <= 1).count() as f64;
        let share = near(usual) / lengths.len() as f64;
        if usual == self.samples || share < 0.75 {
            return Vec::new();
        }
        let first =
            self.shape.lines().find(|line| line.length.abs_diff(usual) <= 1).map_or(0, |line| line.start);
        let at = At { clock: first as u64, line: None };
        let exact = lengths.iter().filter(|length| **length == usual).count() as f64 / lengths.len() as f64;
        let (samples, line) = (self.samples as f64, self.profile.clocks_per_line() as f64);
        let ratio = usual as f64 / samples;
        let numbers = |text: String| {
            Evidence::new(text)
                .with("samples_a_line", usual as f64)
                .with("samples_expected", samples)
                .with("period_clocks", self.period as f64)
                .with("period_expected_clocks", line)
                .with("share_of_lines", share)
        };
        let mut findings = Vec::new();
        let scaled = (self.period as f64 - ratio * line).abs() <= 2.0 + line / samples * 1.0;
        let late = self.samples > usual && self.period as f64 == line;
        let other = self.other_format(usual).filter(|_| exact > 0.95);
        let gated = self.profile.bus.sync == SyncMode::Gated;
        // Sync without blanking is scaled in any case: then every line as long as another says that clocks are not missed.
        let missed = ratio < 0.995
            && (!gated || (self.period as f64) < line - 0.5)
            && scaled
            && (gated || exact < 0.98 || other.is_none() && self.samples - usual > 16);
        if missed {
            let evidence = numbers(format!(
                "lines have {usual} samples of {} and gaps shrink alike: {:.0} % of the clocks are seen",
                self.samples,
                100.0 * ratio
            ));
            findings.push(found(
                FaultKind::Undersampling,
                0.9,
                at,
                evidence,
                remedy::of(FaultKind::Undersampling, self.profile),
            ));
        }
        if let Some(name) = other {
            let evidence = numbers(format!(
                "every line has {usual} samples, not {}: as many as {name} has",
                self.samples
            ));
            let remedy = Remedy::new(format!(
                "set the sensor to {}, or tell the profile what it sends",
                self.profile.frame.format.name()
            ))
            .profile(format!("frame.format = \"{name}\""));
            findings.push(found(
                FaultKind::FormatMismatch,
                if missed { 0.3 } else { 0.9 },
                at,
                evidence,
                remedy,
            ));
        }
        if usual < self.samples && (late || !gated) {
            let lost = self.samples - usual;
            let evidence =
                numbers(format!("every line lacks {lost} samples, and HSYNC's period is as it should be"));
            let confidence = if late {
                0.9
            } else if missed || other.is_some() {
                0.2
            } else {
                0.8
            };
            findings.push(found(
                FaultKind::LineStartLoss,
                confidence,
                at,
                evidence,
                remedy::of(FaultKind::LineStartLoss, self.profile),
            ));
        }
        if findings.is_empty() {
            let fault = if usual < self.samples { FaultKind::ShortLine } else { FaultKind::LongLine };
            let evidence = numbers(format!("every line has {usual} samples, not {}", self.samples));
            let remedy = Remedy::new("compare the sensor's window registers with the profile").profile(
                format!("frame.width = {}", usual as u32 / self.profile.frame.samples_per_pixel().max(1)),
            );
            findings.push(found(fault, 0.6, at, evidence, remedy));
        }
        findings.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        findings
    }

    /// The format of which a line has so many samples.
    fn other_format(&self, samples: usize) -> Option<&'static str> {
        use algos_nostd::pixel::format::Format;
        let width = self.profile.frame.width as usize;
        let format = match samples.checked_div(width)? {
            _ if !samples.is_multiple_of(width) || self.profile.bus.bits != 8 => return None,
            1 => Format::Gray8,
            2 => Format::Yuyv,
            3 => Format::Rgb888,
            _ => return None,
        };
        Some(format.name())
    }

    /// The deviations of a frame.
    fn frame(&self, number: usize, frame: &Frame, events: &mut Events) {
        let lines = &frame.lines;
        let mut effective = 0;
        let mut at = 0;
        while at < lines.len() {
            let line = lines[at];
            // A stream of markers begins anywhere in a line.
            let unmarked = self.profile.bus.sync == SyncMode::Marker && number == 0 && at == 0;
            let torn = unmarked || at == 0 && frame.torn.0 || at + 1 == lines.len() && frame.torn.1;
            if line.length == self.samples || torn {
                (at, effective) = (at + 1, effective + 1);
                continue;
            }
            if let Some(parts) = self.parts(&lines[at..]) {
                events.add(FaultKind::SpuriousHsync, line.end(), Some(effective));
                (at, effective) = (at + parts, effective + 1);
                continue;
            }
            let merged = line.length.saturating_sub(self.samples) as f64 / self.period as f64;
            if merged > 0.9 && (merged - merged.round()).abs() * self.period as f64 <= 4.0 {
                events.add(FaultKind::MissingHsync, line.start + self.samples, Some(effective));
                (at, effective) = (at + 1, effective + 1 + merged.round() as usize);
                continue;
            }
            // The first line's start is measured from where others are in their frames.
            let before = match at.checked_sub(1) {
                Some(before) => Some(line.start - lines[before].start),
                None => {
                    self.porch.map(|porch| (line.start - frame.start + self.period).saturating_sub(porch))
                }
            };
            let kind = self.uneven(line, lines.get(at + 1), before);
            events.add(kind, line.start + line.length.min(self.samples), Some(effective));
            (at, effective) = (at + 1, effective + 1);
        }
        self.height_of(number, frame, effective, events);
    }

    /// How many of these lines are one that was cut by pulses.
    fn parts(&self, lines: &[Line]) -> Option<usize> {
        let first = lines.first()?;
        if first.length >= self.samples {
            return None;
        }
        let marker = self.profile.bus.sync == SyncMode::Marker;
        for (index, pair) in lines.windows(2).enumerate() {
            let gap = pair[1].start - pair[0].end();
            let (covered, short) = (pair[1].end() - first.start, pair[1].length < self.samples);
            // Between the wobbling ends of two lines of nearly the right length there is no pulse.
            if gap > SPURIOUS
                || !short
                || covered > self.samples
                || marker && pair[1].length + 1 >= self.samples
            {
                return None;
            }
            if covered == self.samples {
                return Some(index + 2);
            }
        }
        None
    }

    /// A line of a length that is only a little wrong.
    fn uneven(&self, line: Line, next: Option<&Line>, before: Option<usize>) -> FaultKind {
        let (more, by) = (line.length > self.samples, line.length.abs_diff(self.samples));
        let moved = next.map(|next| (next.start - line.start) as i64 - self.period as i64);
        let expected = line.length as i64 - self.samples as i64;
        let clocks = if more { FaultKind::ClockGlitch } else { FaultKind::MissingClock };
        let ends = if more { FaultKind::LongLine } else { FaultKind::ShortLine };
        if self.profile.bus.sync == SyncMode::Gated {
            // The line's period says whether clocks came or went, or only the level moved.
            let late = |before: usize| before as i64 - self.period as i64 == -expected;
            return match moved {
                _ if by == 1 && before.is_some_and(late) => FaultKind::ClockJitter,
                Some(moved) if moved == expected => clocks,
                Some(_) if by == 1 => FaultKind::ClockJitter,
                None if by == 1 && before.is_some_and(|before| before != self.period) => {
                    FaultKind::ClockJitter
                }
                None if by == 1 => clocks,
                _ => ends,
            };
        }
        // Without levels what one line lacks its neighbour has, or nobody.
        let paid = next.is_some_and(|next| next.length as i64 - self.samples as i64 == -expected)
            || before.is_some_and(|before| before as i64 - self.period as i64 == -expected);
        match by {
            1 | 2 if paid => FaultKind::ClockJitter,
            1 | 2 => clocks,
            _ => ends,
        }
    }

    /// A frame of the wrong height.
    fn height_of(&self, number: usize, frame: &Frame, effective: usize, events: &mut Events) {
        let split = frame.torn.0 || frame.torn.1;
        if effective == self.height && !split {
            return;
        }
        if effective > self.height + self.height / 2 {
            events.add(FaultKind::MissingVsync, frame.start + self.period * self.height, None);
            return;
        }
        if effective == 0 || effective >= self.height && !split {
            return;
        }
        // The pulse that cuts: after this frame if that is where lines are missing.
        let timing = &self.profile.timing;
        let usual = match self.profile.bus.sync {
            SyncMode::Gated => {
                timing.vblank.saturating_sub(timing.vfront).saturating_sub(timing.vback) as usize
            }
            SyncMode::Marker => 0,
            SyncMode::Embedded => (timing.vblank.saturating_sub(timing.hblank)) as usize,
        };
        let pulse =
            self.shape.frames.get(number + 1).or(self.shape.open.as_ref()).and_then(|next| next.pulse_before);
        let short = |pulse: Option<usize>| pulse.is_some_and(|pulse| pulse * 2 < usual);
        let spurious = match self.profile.bus.sync {
            SyncMode::Gated => split && (short(pulse) || short(frame.pulse_before)),
            SyncMode::Marker => split,
            SyncMode::Embedded => {
                let short_end = frame.lines.last().is_some_and(|line| line.length != self.samples);
                let next_missing = pulse.is_some_and(|pulse| pulse < self.period + 8);
                let before_missing = frame.pulse_before.is_some_and(|pulse| pulse < self.period + 8);
                short_end && next_missing || before_missing
            }
        };
        let kind = if spurious { FaultKind::SpuriousVsync } else { FaultKind::VsyncInFrame };
        events.add(kind, frame.end, Some(effective.min(self.height)));
    }

    fn rank(&self, events: &Events) -> Vec<Finding> {
        let total = events.total() as f64;
        let lines = self.shape.lines().count().max(1) as f64;
        // What cuts frames explains lines that are cut with them.
        let weight = |kind: FaultKind, count: u64| match kind {
            FaultKind::MissingVsync | FaultKind::SpuriousVsync | FaultKind::VsyncInFrame => {
                count as f64 * 3.0
            }
            _ => count as f64,
        };
        let sum: f64 = events.0.iter().map(|(kind, (count, ..))| weight(*kind, *count)).sum();
        let mut findings: Vec<Finding> = events
            .0
            .iter()
            .map(|(&kind, &(count, clock, line))| {
                let share = weight(kind, count) / sum;
                let frames = matches!(
                    kind,
                    FaultKind::MissingVsync | FaultKind::SpuriousVsync | FaultKind::VsyncInFrame
                );
                let of = if frames { self.shape.frames.len() } else { lines as usize };
                let text = format!(
                    "{count} of {of} {} show it; the first at clock {clock}{}",
                    if frames { "frames" } else { "lines" },
                    line.map(|line| format!(", line {line}")).unwrap_or_default()
                );
                let evidence = Evidence::new(text)
                    .with("events", count as f64)
                    .with("deviations", total)
                    .with("lines", lines)
                    .with("samples_expected", self.samples as f64)
                    .with("period_clocks", self.period as f64);
                found(kind, 0.95 * share, At { clock, line }, evidence, remedy::of(kind, self.profile))
            })
            .collect();
        findings.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        // A marker of one clock is lost as well where samples are taken at the wrong time.
        if let Some(first) = findings.first()
            && self.profile.bus.sync == SyncMode::Marker
            && first.fault == FaultKind::MissingHsync
            && events.count(FaultKind::ClockJitter) == 0
        {
            let (kind, at) = (FaultKind::ClockJitter, At { clock: first.at_pclk, line: first.line });
            let evidence =
                Evidence::new("markers are lost, which samples taken while HSYNC changes do as well");
            findings
                .insert(1, found(kind, 0.3 * first.confidence, at, evidence, remedy::of(kind, self.profile)));
        }
        // Ends of lines that wander everywhere are not a clock that slips now and then.
        let wander = events.count(FaultKind::ClockJitter)
            + events.count(FaultKind::ClockGlitch)
            + events.count(FaultKind::MissingClock)
            + if self.profile.bus.sync == SyncMode::Marker {
                events.count(FaultKind::MissingHsync)
            } else {
                0
            };
        if wander as f64 > 0.3 * lines && events.count(FaultKind::ClockJitter) as f64 > 0.06 * lines {
            for finding in findings.iter_mut().filter(|finding| finding.fault == FaultKind::ClockJitter) {
                finding.fault = FaultKind::WrongEdge;
                finding.confidence = 0.9;
                finding.remedy = remedy::of(FaultKind::WrongEdge, self.profile);
            }
            findings.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        }
        findings
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
