//! Marks of sync against the clock: samples taken while the wires change move a mark by a clock, or damage a code.
//!
//! ```text
//! HSYNC  ____|‾|________|‾‾‾|_____      a marker that is a clock longer than the others: it still shows the clock before
//! codes  FF 00 00 80    D7 04 00 80     the same on data wires; the third byte, after a zero, is a zero in any case
//! ```
//!
//! A clock too many or too few moves all marks after it, and one way; a wobble moves single ones, there and back.

use std::collections::BTreeMap;

use super::finding::{Evidence, Finding};
use super::recording::Recording;
use super::remedy;
use super::shape::Shape;
use super::structure::{At, found, mode};
use crate::fault::FaultKind;
use crate::profile::{Profile, SyncMode};

/// More marks than this share are moved: the edge is wrong, not wobbling. Of wires, and of codes, which change often.
const WRONG: (f64, f64) = (0.12, 0.45);
/// Fewest marks from which a share is told.
const FEWEST: u64 = 16;

/// How many marks of sync are where they should be.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Marks {
    /// Marks that were looked at.
    all: u64,
    /// Of these, those that show another clock's levels.
    moved: u64,
    /// The clock of the first one.
    first: u64,
    codes: bool,
}

impl Marks {
    pub(super) fn of(recording: &Recording, profile: &Profile, shape: &Shape) -> Self {
        match profile.bus.sync {
            SyncMode::Gated => Self::of_levels(shape),
            SyncMode::Marker => Self::of_markers(recording, profile),
            SyncMode::Embedded => Self::of_codes(recording, profile),
        }
    }

    /// Starts of lines, by the distance to the one before.
    fn of_levels(shape: &Shape) -> Self {
        let frames = shape.frames.iter().chain(&shape.open);
        let steps: Vec<(usize, usize)> = frames
            .flat_map(|frame| {
                frame.lines.windows(2).map(|pair| (pair[1].start, pair[1].start - pair[0].start))
            })
            .collect();
        Self::of_steps(&steps)
    }

    /// Distances of marks that differ by one from the usual, both ways.
    fn of_steps(steps: &[(usize, usize)]) -> Self {
        let Some(period) = mode(steps.iter().map(|(_, step)| *step)) else { return Self::default() };
        let (mut late, mut early, mut all, mut first) = (0, 0, 0, None);
        for &(clock, step) in steps {
            // Marks between may be lost.
            let over = (step + 1) % period.max(2);
            if over > 2 {
                continue;
            }
            all += 1;
            (late, early) = (late + u64::from(over == 2), early + u64::from(over == 0));
            if over != 1 {
                first.get_or_insert(clock as u64);
            }
        }
        Self { all, moved: late.min(early), first: first.unwrap_or(0), codes: false }
    }

    fn of_markers(recording: &Recording, profile: &Profile) -> Self {
        let active = profile.bus.hsync_blank.is_high();
        // VSYNC cuts runs as well.
        let mut markers: Vec<(usize, usize)> = Vec::new();
        let mut inside = false;
        for run in &recording.runs {
            let now = run.sync.hsync == active;
            match markers.last_mut() {
                Some((_, length)) if now && inside => *length += run.length,
                _ if now => markers.push((run.start, run.length)),
                _ => {}
            }
            inside = now;
        }
        let steps: Vec<_> = markers.windows(2).map(|pair| (pair[1].0, pair[1].0 - pair[0].0)).collect();
        let mut marks = Self::of_steps(&steps);
        let usual = mode(markers.iter().map(|(_, length)| *length)).unwrap_or(1);
        let period = (profile.clocks_per_line() as usize).max(3);
        let phase = mode(markers.iter().map(|(start, _)| start % period)).unwrap_or(0);
        // Pulses within lines are another matter.
        let longer = markers
            .iter()
            .filter(|(start, length)| *length == usual + 1 && (start + period + 1 - phase) % period <= 2);
        let Some((first, _)) = longer.clone().next() else { return marks };
        let first = *first as u64;
        marks.first = if marks.moved == 0 { first } else { first.min(marks.first) };
        marks.moved += longer.count() as u64;
        marks
    }

    /// Zeros that stand below one another, line by line, are third bytes of codes: no picture has zeros there.
    fn of_codes(recording: &Recording, profile: &Profile) -> Self {
        let (samples, line) = (&recording.samples, profile.clocks_per_line() as usize);
        let mut marks = Self { codes: true, ..Self::default() };
        let mut kinds: BTreeMap<(u16, u16), u64> = BTreeMap::new();
        for at in line.max(3)..samples.len().saturating_sub(line + 1) {
            if samples[at] != 0 || samples[at - line] != 0 || samples[at + line] != 0 || samples[at + 1] == 0
            {
                continue;
            }
            marks.all += 1;
            let lead = (samples[at - 2], samples[at - 1]);
            if lead != (0xFF, 0) {
                if marks.moved == 0 {
                    marks.first = at as u64 - 2;
                }
                marks.moved += 1;
                *kinds.entry(lead).or_default() += 1;
            }
        }
        // Wires that are wrong damage all codes alike.
        let most = kinds.values().max().copied().unwrap_or(0);
        if marks.moved > 3 && 2 * most > marks.moved {
            marks.moved = 0;
        }
        marks
    }

    fn share(&self) -> f64 {
        self.moved as f64 / self.all.max(1) as f64
    }

    /// Wrong edge or wobbling edge, if marks are enough to tell.
    pub(super) fn kind(&self) -> Option<FaultKind> {
        let wrong = if self.codes { WRONG.1 } else { WRONG.0 };
        let kind = if self.share() > wrong { FaultKind::WrongEdge } else { FaultKind::ClockJitter };
        (self.all >= FEWEST && self.moved > 0).then_some(kind)
    }

    /// What it means, if it means anything.
    pub(super) fn finding(&self, profile: &Profile) -> Option<Finding> {
        let kind = self.kind()?;
        let text = format!(
            "{} of {} {} ({:.1} %)",
            self.moved,
            self.all,
            if self.codes {
                "sync codes have wires of the byte before in them"
            } else {
                "marks of HSYNC are a clock late or long, and those after them are not"
            },
            100.0 * self.share()
        );
        let evidence =
            Evidence::new(text).with("marks", self.all as f64).with("marks_moved", self.moved as f64);
        let confidence = if self.moved >= 4 { 0.95 } else { 0.8 };
        let at = At { clock: self.first, line: None };
        Some(found(kind, confidence, at, evidence, remedy::of(kind, profile)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::recording::Run;
    use firmware::camif::pins::Sync;

    /// A recording of markers that start at these clocks and are so long.
    fn markers(marks: &[(usize, usize)], clocks: usize) -> Recording {
        let mut recording =
            Recording { samples: vec![7; clocks], clocks: clocks as u64, ..Recording::default() };
        let mut at = 0;
        let mut run = |hsync, from: usize, to: usize| {
            recording.runs.push(Run { sync: Sync { hsync, vsync: false }, start: from, length: to - from });
        };
        for &(start, length) in marks {
            run(false, at, start);
            run(true, start, start + length);
            at = start + length;
        }
        run(false, at, clocks);
        recording
    }

    fn profile(text: &str) -> Profile {
        Profile::from_toml(text).unwrap()
    }

    #[test]
    fn single_markers_that_are_late_or_long_are_told_from_clocks_too_many() {
        let profile = profile(
            "[bus]\nsync = \"marker\"\nhsync_blank = \"high\"\nvsync_blank = \"high\"\n\
             [frame]\nwidth = 50\nheight = 40\nformat = \"gray8\"\n[timing]\nhblank = 0\nvblank = 0\n",
        );
        let marks: Vec<(usize, usize)> = (1..40).map(|line| (50 * line, 1)).collect();
        let looked = |marks: &[(usize, usize)]| {
            Marks::of(&markers(marks, 2_100), &profile, &Shape::default()).finding(&profile)
        };
        assert_eq!(looked(&marks), None);
        let mut later = marks.clone();
        later[20..].iter_mut().for_each(|mark| mark.0 += 1);
        assert_eq!(looked(&later), None, "a clock too many");
        let mut long = marks.clone();
        long[3].1 = 2;
        long[9].0 += 1;
        let finding = looked(&long).unwrap();
        assert_eq!(
            (finding.fault, finding.at_pclk),
            (FaultKind::ClockJitter, 200),
            "{}",
            finding.evidence.text
        );
        let mut wrong = marks.clone();
        wrong.iter_mut().step_by(3).for_each(|mark| mark.0 += 1);
        wrong.iter_mut().skip(1).step_by(3).for_each(|mark| mark.1 = 2);
        assert_eq!(looked(&wrong).unwrap().fault, FaultKind::WrongEdge);
    }

    #[test]
    fn damaged_codes_are_told_from_codes_behind_wrong_wires() {
        let profile = Profile::find("bt656-vga-yuv422").unwrap();
        let line = profile.clocks_per_line() as usize;
        let looked = |lead: &dyn Fn(usize) -> [u16; 2]| {
            let mut samples = vec![0x55; 60 * line];
            for row in 0..60 {
                samples[row * line + 9..][..4].copy_from_slice(&[lead(row)[0], lead(row)[1], 0, 0x80]);
            }
            let recording = Recording { samples, ..Recording::default() };
            Marks::of(&recording, &profile, &Shape::default()).finding(&profile).map(|finding| finding.fault)
        };
        assert_eq!(looked(&|_| [0xFF, 0]), None);
        assert_eq!(looked(&|_| [0xF7, 0]), None, "D3 is low");
        let some = |row: usize| if row.is_multiple_of(9) { [0xD5 | row as u16, 0] } else { [0xFF, 0] };
        assert_eq!(looked(&some), Some(FaultKind::ClockJitter));
        assert_eq!(looked(&|row| [0x55 | row as u16, row as u16 & 0x2A]), Some(FaultKind::WrongEdge));
    }
}
