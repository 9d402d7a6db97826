//! What a frame should be, what was measured of it, and what comes of the comparison.

use super::config::{Config, LineSelect};
use super::verdict::{Outcome, Verdict};
use crate::camif::Part;

/// What a frame should be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Expectation {
    /// Bytes a frame; the most for compressed ones.
    pub(super) bytes: u32,
    /// Whole words of them.
    pub(super) words: u32,
    /// Lines a frame.
    pub(super) lines: u32,
    /// Bytes a line.
    pub(super) line_bytes: u32,
    /// Frames have no fixed length.
    pub(super) jpeg: bool,
    /// The part counts bytes and lines.
    pub(super) counters: bool,
    /// Lines are measured, and each line on the wires is one in memory or known not to be.
    metered: bool,
}

impl Expectation {
    pub(super) fn new(config: &Config, part: &Part) -> Self {
        let geometry = config.geometry();
        let every_line = config.crop.is_none() && config.line_select == LineSelect::All;
        Self {
            bytes: u32::try_from(geometry.bytes()).unwrap_or(u32::MAX),
            words: u32::try_from(geometry.words()).unwrap_or(u32::MAX),
            lines: geometry.lines,
            line_bytes: geometry.line_bytes,
            jpeg: config.jpeg,
            counters: part.counters,
            metered: config.line_interrupts && !config.jpeg && (part.counters || every_line),
        }
    }

    /// What came of a frame of so many bytes; so many lines if they were counted exactly.
    pub(super) fn verdict(&self, bytes: u32, lines: Option<u32>, meter: &Meter) -> Verdict {
        let counted = lines.unwrap_or(if self.metered { meter.lines } else { self.lines_of(bytes) });
        let (min_line_bytes, max_line_bytes) = meter.extremes(bytes, counted);
        let even = (min_line_bytes, max_line_bytes) == (self.line_bytes, self.line_bytes);
        let outcome = match () {
            () if self.jpeg && bytes > 0 && bytes <= self.bytes => Outcome::Good,
            () if bytes < self.bytes => Outcome::Short { expected: self.bytes },
            () if bytes > self.bytes => Outcome::Long { expected: self.bytes },
            () if lines.is_some() && counted != self.lines => Outcome::LineCount { expected: self.lines },
            // Interrupts that were served late may have missed lines, but can't have made any up.
            () if counted > self.lines => Outcome::LineCount { expected: self.lines },
            () if self.counters && meter.lines > 0 && !even => {
                Outcome::LineLength { expected: self.line_bytes }
            }
            () => Outcome::Good,
        };
        Verdict { lines: counted, min_line_bytes, max_line_bytes, bytes, outcome, ..Verdict::default() }
    }

    fn lines_of(&self, bytes: u32) -> u32 {
        if self.jpeg { 0 } else { bytes.div_ceil(self.line_bytes.max(1)) }
    }
}

/// The lines of the frame in progress, measured as they end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Meter {
    lines: u32,
    least: u32,
    most: u32,
    /// Where the last line ended, in bytes of the frame (without counters).
    end: u32,
}

impl Meter {
    /// A line has ended: `value` is its bytes, or without counters the bytes of the frame that have reached memory.
    pub(super) fn line(&mut self, expected: &Expectation, value: u32) {
        if !expected.metered {
            return;
        }
        let bytes = if expected.counters {
            value
        } else {
            let start = core::mem::replace(&mut self.end, value);
            value.saturating_sub(start)
        };
        // Lines without data (in vertical blanking, or outside the crop window) don't count.
        if bytes > 0 {
            self.least = if self.lines == 0 { bytes } else { self.least.min(bytes) };
            self.most = self.most.max(bytes);
            self.lines = self.lines.saturating_add(1);
        }
    }

    /// The frame ended after `lines` lines, the last of `bytes`: that one is missing if the frame's end was its end too.
    pub(super) fn close(&mut self, expected: &Expectation, lines: u32, bytes: u32) {
        if self.lines.checked_add(1) == Some(lines) {
            self.line(expected, bytes);
        }
    }

    /// Least and most bytes a line; the mean where lines were not measured.
    pub(super) fn extremes(&self, bytes: u32, lines: u32) -> (u32, u32) {
        if self.lines > 0 {
            return (self.least, self.most);
        }
        let lines = lines.max(1);
        (bytes / lines, bytes.div_ceil(lines))
    }
}

#[cfg(test)]
mod tests {
    use super::super::config::tests::GATED;
    use super::*;

    fn expectation(part: &Part) -> Expectation {
        Expectation::new(&Config::new(GATED, 8, 4), part)
    }

    fn outcome(part: &Part, lines: &[u32], total: u32, counted: Option<u32>) -> Outcome {
        let expected = expectation(part);
        let mut meter = Meter::default();
        for &line in lines {
            meter.line(&expected, line);
        }
        expected.verdict(total, counted, &meter).outcome
    }

    #[test]
    fn counted_frames_are_judged_to_the_byte() {
        let judge = |lines: &[u32], count| outcome(&Part::CAMIF, lines, lines.iter().sum(), Some(count));
        assert_eq!(judge(&[8, 0, 8, 8, 8, 0], 4), Outcome::Good, "empty lines don't count");
        assert_eq!(judge(&[8, 8, 8, 7], 4), Outcome::Short { expected: 32 });
        assert_eq!(judge(&[8, 8, 8, 8, 1], 5), Outcome::Long { expected: 32 });
        assert_eq!(judge(&[8, 8, 16], 3), Outcome::LineCount { expected: 4 });
        assert_eq!(judge(&[8, 7, 9, 8], 4), Outcome::LineLength { expected: 8 });
        assert_eq!(outcome(&Part::CAMIF, &[], 32, Some(4)), Outcome::Good, "lines were not measured");
    }

    #[test]
    fn positions_are_uncertain_and_only_their_sum_is_judged() {
        let judge = |ends: &[u32], total| outcome(&Part::STM32F4, ends, total, None);
        assert_eq!(judge(&[4, 12, 20, 28], 32), Outcome::Good);
        assert_eq!(judge(&[4, 12, 28], 32), Outcome::Good, "a late interrupt misses a line");
        assert_eq!(judge(&[4, 12, 20, 24, 28], 32), Outcome::LineCount { expected: 4 });
        assert_eq!(judge(&[4, 12, 20, 28], 28), Outcome::Short { expected: 32 });
    }

    #[test]
    fn a_line_that_ends_with_its_frame_is_closed() {
        let expected = expectation(&Part::CAMIF);
        let mut meter = Meter::default();
        for _ in 0..3 {
            meter.line(&expected, 8);
        }
        meter.close(&expected, 4, 5);
        assert_eq!((meter.lines, meter.extremes(29, 4)), (4, (5, 8)));
        meter.close(&expected, 4, 5);
        assert_eq!(meter.lines, 4);
    }

    #[test]
    fn compressed_frames_have_any_length_up_to_the_most() {
        let expected = Expectation { jpeg: true, ..expectation(&Part::CAMIF) };
        let outcome = |bytes| expected.verdict(bytes, None, &Meter::default()).outcome;
        assert_eq!([outcome(1), outcome(32)], [Outcome::Good; 2]);
        assert_eq!(outcome(33), Outcome::Long { expected: 32 });
        assert_eq!(outcome(0), Outcome::Short { expected: 32 });
    }
}
