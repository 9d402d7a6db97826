//! One pass over the beginning of a trace: how the sync wires move, whether data lives under each of their levels, and
//! the codes that look like embedded synchronisation.
//!
//! ```text
//! HSYNC  ____‾‾____‾‾____      runs:  (low, low) 4 · (high, low) 2 · (low, low) 4 · …
//! data   abcd00efgh00ijkl      alive: (low, low) changes at each clock · (high, low) never
//! ```
//!
//! Bounded: at most [`MOST_CLOCKS`] are looked at, and [`MOST_RUNS`] runs and codes are kept.

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use crate::trace::polarity::Enough;

/// Clocks that are looked at.
pub const MOST_CLOCKS: u64 = 1 << 26;
/// Runs and codes that are kept.
pub const MOST_RUNS: usize = 1 << 16;

/// Clocks with the same sync levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The levels.
    pub sync: Sync,
    /// Number of its first clock.
    pub start: u64,
    /// Its length in pixel clocks.
    pub clocks: u64,
}

/// `FF 00 00 XY` with a right checksum in XY (ITU-R BT.656-5, table 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// Number of the clock of the FF.
    pub start: u64,
    /// Second field.
    pub field: bool,
    /// Vertical blanking.
    pub blank: bool,
    /// The code ends the active part of a line (EAV) rather than starting it (SAV).
    pub ends: bool,
}

/// How data behaves under one pair of sync levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Life {
    /// Clocks with these levels.
    pub clocks: u64,
    /// Samples that differ from the one before with the same levels.
    pub changes: u64,
    last: Option<u16>,
}

impl Life {
    /// Changes in a thousand clocks.
    #[must_use]
    pub fn per_mille(&self) -> u64 {
        (self.changes * 1000).checked_div(self.clocks).unwrap_or(0)
    }
}

/// What was seen. A sink for the beginning of a trace.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    /// Runs in the order of time.
    pub runs: Vec<Run>,
    /// Codes in the order of time.
    pub codes: Vec<Code>,
    /// By HSYNC + 2 × VSYNC.
    life: [Life; 4],
    /// Pixel clocks seen.
    pub clocks: u64,
    /// All samples ORed together.
    pub used_bits: u16,
    /// The last three samples, for codes that lie across stretches; the newest in the lowest bits.
    recent: u64,
}

const fn index(sync: Sync) -> usize {
    sync.hsync as usize + 2 * sync.vsync as usize
}

impl Survey {
    /// How data behaves while the wires have these levels.
    #[must_use]
    pub fn life(&self, sync: Sync) -> Life {
        self.life[index(sync)]
    }

    fn look(&mut self, sync: Sync, sample: u16, clock: u64) {
        let life = &mut self.life[index(sync)];
        life.changes += u64::from(life.last.is_some_and(|last| last != sample));
        life.last = Some(sample);
        self.used_bits |= sample;
        self.recent = self.recent << 16 | u64::from(sample);
        if self.recent >> 16 == 0x00FF_0000_0000 && self.codes.len() < MOST_RUNS && clock >= 3 {
            self.codes.extend(code(sample, clock - 3));
        }
    }
}

/// The meaning of a code's last byte, if its protection bits are right.
fn code(xy: u16, start: u64) -> Option<Code> {
    let bit = |n: u32| xy >> n & 1 != 0;
    let (field, blank, ends) = (bit(6), bit(5), bit(4));
    let protected = [(3, blank ^ ends), (2, field ^ ends), (1, field ^ blank), (0, field ^ blank ^ ends)];
    let right = xy >> 7 == 1 && protected.into_iter().all(|(n, value)| bit(n) == value);
    right.then_some(Code { start, field, blank, ends })
}

impl StretchSink for Survey {
    type Error = Enough;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Enough> {
        let clocks = samples.len() as u64;
        match self.runs.last_mut() {
            Some(run) if run.sync == sync => run.clocks += clocks,
            _ if clocks > 0 => self.runs.push(Run { sync, start: self.clocks, clocks }),
            _ => {}
        }
        match samples {
            Samples::Repeat { value, clocks: 4.. } => {
                // Four are enough to see the one change and to push older samples out of a code.
                for place in 0..4 {
                    self.look(sync, value, self.clocks + place);
                }
            }
            _ => {
                for place in 0..samples.len() {
                    let sample = samples.get(place).unwrap_or_default();
                    self.look(sync, sample, self.clocks + place as u64);
                }
            }
        }
        self.life[index(sync)].clocks += clocks;
        self.clocks += clocks;
        if self.clocks >= MOST_CLOCKS || self.runs.len() >= MOST_RUNS { Err(Enough) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn play(survey: &mut Survey, hsync: bool, data: &[u8]) {
        survey.stretch(Sync { hsync, vsync: false }, Samples::Bytes(data)).unwrap();
    }

    #[test]
    fn runs_join_and_data_lives_where_it_changes() {
        let mut survey = Survey::default();
        for (hsync, data) in [(false, b"ab"), (false, b"cd"), (true, b"00"), (false, b"ef"), (true, b"00")] {
            play(&mut survey, hsync, data);
        }
        let runs: Vec<_> = survey.runs.iter().map(|run| (run.sync.hsync, run.start, run.clocks)).collect();
        assert_eq!(runs, [(false, 0, 4), (true, 4, 2), (false, 6, 2), (true, 8, 2)]);
        let life = |hsync| survey.life(Sync { hsync, vsync: false });
        assert_eq!((life(false).changes, life(false).clocks), (5, 6));
        assert_eq!((life(true).changes, life(true).per_mille()), (0, 0));
    }

    #[test]
    fn codes_are_found_across_stretches_and_only_with_right_protection_bits() {
        let mut survey = Survey::default();
        for data in [&[1, 0xFF][..], &[0, 0], &[0x80, 5, 0xFF, 0, 0, 0x9D], &[0xFF, 0, 0, 0xFF]] {
            play(&mut survey, false, data);
        }
        let code = |start, ends| Code { start, field: false, blank: false, ends };
        assert_eq!(survey.codes, [code(1, false), code(6, true)], "FF 00 00 FF is pure red, not a code");
    }

    #[test]
    fn a_long_trace_is_looked_at_for_a_while() {
        let mut survey = Survey::default();
        let long = Samples::Repeat { value: 3, clocks: 1 << 25 };
        assert_eq!(survey.stretch(Sync::default(), long), Ok(()));
        assert_eq!(survey.stretch(Sync::default(), long), Err(Enough));
        assert_eq!(survey.life(Sync::default()).changes, 0);
    }
}
