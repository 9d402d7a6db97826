//! Single lines and frames that deviate, and what their lengths say.
//!
//! ```text
//! line longer or shorter ─► and the line's period with it?  ─ yes ─► clocks too many or too few
//!                                                           └ no ──► its end moved
//! two lines that make one ─► a pulse within a line      one that makes two ─► a line's end is missing
//! ```

use std::collections::BTreeMap;

use super::finding::{Evidence, Finding};
use super::remedy;
use super::shape::{Frame, Line};
use super::structure::{At, Structure, found};
use crate::fault::FaultKind;
use crate::profile::SyncMode;

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

impl Structure<'_> {
    /// The deviations of a frame.
    pub(super) fn frame(&self, number: usize, frame: &Frame, events: &mut Events) {
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

    /// Findings of the deviations, by how many of them each class explains.
    pub(super) fn rank(&self, events: &Events) -> Vec<Finding> {
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
                let of = format!("{count} of {of} {}", if frames { "frames" } else { "lines" });
                let text = format!("{of}: {}", self.shows(kind));
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

    /// What such a deviation looks like.
    fn shows(&self, kind: FaultKind) -> &'static str {
        use FaultKind as K;
        match kind {
            K::ClockGlitch => "one or two samples too many, and all that follows is as much later",
            K::MissingClock => "one or two samples too few, and all that follows is as much earlier",
            K::ClockJitter => "a mark or an end is a clock late or early, and what follows is on time",
            K::ShortLine if self.profile.bus.sync == SyncMode::Gated => {
                "too short, and the next begins on time"
            }
            K::LongLine if self.profile.bus.sync == SyncMode::Gated => {
                "too long, and the next begins on time"
            }
            K::ShortLine => "more than two samples too few",
            K::LongLine => "more than two samples too many",
            K::MissingHsync => "as long as two lines and the gap between them, or more",
            K::SpuriousHsync => "cut in two by a short pulse; the parts make one line",
            K::MissingVsync => "as many lines as two frames have, or more",
            K::SpuriousVsync => "lines are missing at a pulse of VSYNC that is too short, or within a line",
            K::VsyncInFrame => "lines are missing, and VSYNC has its usual length",
            _ => "not as the profile says",
        }
    }
}
