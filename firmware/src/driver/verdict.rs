//! The verdict on a frame: what came of it, measured.

use core::fmt;

/// What came of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outcome {
    /// All of it, and nothing else.
    #[default]
    Good,
    /// Fewer bytes than configured.
    Short {
        /// Bytes configured.
        expected: u32,
    },
    /// More bytes than configured; or the next frame began before this one could be measured.
    Long {
        /// Bytes configured.
        expected: u32,
    },
    /// The right number of bytes in the wrong number of lines.
    LineCount {
        /// Lines configured.
        expected: u32,
    },
    /// The right number of bytes and lines, but of uneven length.
    LineLength {
        /// Bytes a line configured.
        expected: u32,
    },
    /// Lines were given up because no buffer was free (capture line by line).
    LinesDropped {
        /// How many.
        lines: u32,
    },
    /// The FIFO overran: the bus was too slow for the sensor.
    Overrun,
    /// An embedded synchronisation code came out of order.
    SyncError,
    /// The DMA met an error.
    DmaError,
    /// The FIFO was not emptied after the frame's end.
    DmaStalled,
    /// The interrupt was served so late that the DMA had already gone on to memory not meant for it.
    LateInterrupt,
}

impl Outcome {
    /// The frame is as configured.
    #[must_use]
    pub const fn is_good(&self) -> bool {
        matches!(self, Self::Good)
    }

    /// What arrived of the frame stands in its place, from the first byte on.
    #[must_use]
    pub const fn is_in_place(&self) -> bool {
        !matches!(
            self,
            Self::Overrun | Self::SyncError | Self::DmaError | Self::DmaStalled | Self::LateInterrupt
        )
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Good => write!(f, "good"),
            Self::Short { expected } => write!(f, "short: {expected} bytes were configured"),
            Self::Long { expected } => write!(f, "long: {expected} bytes were configured"),
            Self::LineCount { expected } => write!(f, "wrong number of lines: {expected} were configured"),
            Self::LineLength { expected } => write!(f, "uneven lines: {expected} bytes each were configured"),
            Self::LinesDropped { lines } => write!(f, "{lines} lines dropped for want of a free buffer"),
            Self::Overrun => write!(f, "overrun: the bus was too slow for the sensor"),
            Self::SyncError => write!(f, "a synchronisation code out of order"),
            Self::DmaError => write!(f, "the DMA met an error"),
            Self::DmaStalled => write!(f, "the DMA did not empty the FIFO after the frame's end"),
            Self::LateInterrupt => write!(f, "the interrupt was served too late"),
        }
    }
}

/// What is known of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Number of the frame among all that passed on the wires since the start, captured or not; wraps.
    pub sequence: u32,
    /// Lines with data.
    pub lines: u32,
    /// Bytes of the shortest line. See [`Config::line_interrupts`](super::Config::line_interrupts); on a part without
    /// counters it is read off the DMA's position, and what is in the FIFO makes it uncertain by ± 20 bytes.
    pub min_line_bytes: u32,
    /// Bytes of the longest line, likewise.
    pub max_line_bytes: u32,
    /// Bytes of the frame; without counters whole words of them.
    pub bytes: u32,
    /// What came of it.
    pub outcome: Outcome,
    /// Overruns since the frame handed out before this one.
    pub overruns: u32,
    /// Frames on the wires between the one handed out before and this one: dropped, lost, or skipped by the frame rate.
    pub dropped_before: u32,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sequence, lines, min_line_bytes: least, max_line_bytes: most, bytes, outcome, .. } = self;
        write!(f, "frame {sequence}: {outcome} ({bytes} bytes in {lines} lines of {least} to {most} bytes)")
    }
}

/// What became of all frames that passed on the wires since the first captured one.
///
/// Each is in exactly one of `delivered`, `dropped`, `lost` and `skipped`, or still in a buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Handed to the consumer.
    pub delivered: u32,
    /// Given up because the consumer did not keep up.
    pub dropped: u32,
    /// Damaged, or passed while capture recovered from damage.
    pub lost: u32,
    /// Left out by the frame rate, or because no snapshot was asked for.
    pub skipped: u32,
    /// Overruns of the FIFO.
    pub overruns: u32,
    /// Synchronisation codes out of order.
    pub sync_errors: u32,
    /// Errors of the DMA.
    pub dma_errors: u32,
    /// Lines given up (capture line by line).
    pub lines_dropped: u32,
}

impl Statistics {
    /// Frames whose fate is known.
    #[must_use]
    pub const fn frames(&self) -> u32 {
        self.delivered.wrapping_add(self.dropped).wrapping_add(self.lost).wrapping_add(self.skipped)
    }
}

impl core::ops::Add for Statistics {
    type Output = Self;

    /// Those of two captures, one after the other; each count wraps.
    fn add(self, other: Self) -> Self {
        Self {
            delivered: self.delivered.wrapping_add(other.delivered),
            dropped: self.dropped.wrapping_add(other.dropped),
            lost: self.lost.wrapping_add(other.lost),
            skipped: self.skipped.wrapping_add(other.skipped),
            overruns: self.overruns.wrapping_add(other.overruns),
            sync_errors: self.sync_errors.wrapping_add(other.sync_errors),
            dma_errors: self.dma_errors.wrapping_add(other.dma_errors),
            lines_dropped: self.lines_dropped.wrapping_add(other.lines_dropped),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_reads_as_a_sentence() {
        let outcome = Outcome::Short { expected: 64 };
        let verdict = Verdict {
            sequence: 3,
            lines: 7,
            min_line_bytes: 8,
            max_line_bytes: 8,
            bytes: 56,
            outcome,
            ..Verdict::default()
        };
        let text = "frame 3: short: 64 bytes were configured (56 bytes in 7 lines of 8 to 8 bytes)";
        assert_eq!(verdict.to_string(), text);
    }

    #[test]
    fn counts_of_two_captures_are_added_each_to_its_own_and_wrap() {
        let one =
            Statistics { delivered: u32::MAX, dropped: 1, lost: 2, skipped: 3, ..Statistics::default() };
        let other = Statistics { overruns: 5, sync_errors: 6, dma_errors: 7, lines_dropped: 8, ..one };
        let sum = Statistics {
            delivered: u32::MAX - 1,
            dropped: 2,
            lost: 4,
            skipped: 6,
            overruns: 5,
            sync_errors: 6,
            dma_errors: 7,
            lines_dropped: 8,
        };
        assert_eq!(one + other, sum);
    }
}
