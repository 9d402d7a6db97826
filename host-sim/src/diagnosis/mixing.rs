//! Samples that show wires of the sample before them: taken while the data changed.
//!
//! ```text
//! above    70 70 70      the middle one fits neither its neighbours nor anything but a mixture of the byte before it, D5,
//! here     71 D1 72      and something like 71: D1 = D5 on some wires, 71 on the others
//! below    70 71 71
//! ```
//!
//! A picture has no side from which its edges come more often; a sample that is taken too early does. So what the
//! byte before explains is counted against what the byte after would explain.

use algos_nostd::pixel::format::Format;

use super::finding::{Evidence, Finding};
use super::planes::{Matrix, period, rows};
use super::remedy;
use super::structure::{At, found};
use crate::fault::FaultKind;
use crate::profile::Profile;

/// More samples than this share show the byte before: the edge is wrong, not wobbling.
const WRONG: f64 = 0.08;
/// One side must be ahead by so many standard deviations.
const AHEAD: f64 = 7.0;
/// It must be so many times as large: where sync shows something as well, and where the picture alone does.
pub(super) const TIMES: (f64, f64) = (1.3, 1.6);

/// Samples that show bits of the sample before them: how many, how many show those of the one after, of all.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mixing {
    before: u64,
    after: u64,
    /// Samples that could show it.
    all: u64,
    /// The clock of the first line with such samples.
    first: u64,
}

/// Whether `value` can be a mixture of `other` with something from `from` to `to`, wire by wire.
fn mixes(value: u8, other: u8, from: u8, to: u8) -> bool {
    // Where the two differ, the wire shows the something.
    let shown = value ^ other;
    (from..=to).any(|something| (something ^ value) & shown == 0)
}

impl Mixing {
    /// Compares each sample with those of its colour around it, and with those to either side on the wires.
    pub(super) fn of(matrix: &Matrix, format: Format) -> Self {
        match format {
            // A byte of these is no number.
            Format::Rgb565Be | Format::Rgb565Le => Self::of_bits(matrix, format),
            _ => Self::of_values(matrix, format),
        }
    }

    fn count(&mut self, before: bool, after: bool, clock: usize) {
        match (before, after) {
            (true, false) => {
                if self.before == 0 {
                    self.first = clock as u64;
                }
                self.before += 1;
            }
            (false, true) => self.after += 1,
            _ => {}
        }
    }

    /// By the range that neighbours of the same colour leave.
    fn of_values(matrix: &Matrix, format: Format) -> Self {
        let mut mixing = Self::default();
        let (rows, step) = (rows(format), period(format));
        // Eight bits tell; those below are noise.
        let low = matrix.bits.saturating_sub(8);
        let byte = |sample: u16| (sample >> low) as u8;
        for y in rows..matrix.height().saturating_sub(rows) {
            let (up, line, down) = (matrix.line(y - rows), matrix.line(y), matrix.line(y + rows));
            for x in step..matrix.width.saturating_sub(step) {
                let around = [up[x], down[x], line[x - step], line[x + step]].map(byte);
                let (least, most) = around.iter().fold((255, 0), |(a, b), &v| (v.min(a), v.max(b)));
                let margin = (most - least) / 2 + 3;
                let (from, to) = (least.saturating_sub(margin), most.saturating_add(margin));
                // Where the picture is as rough as this nothing is an outlier.
                if to - from > 96 {
                    continue;
                }
                let fits = |value: u8| (from..=to).contains(&value);
                let (value, before, after) = (byte(line[x]), byte(line[x - 1]), byte(line[x + 1]));
                mixing.all += u64::from(!fits(before));
                if !fits(value) {
                    let shows = |other: u8| mixes(value, other, from, to);
                    mixing.count(shows(before), shows(after), matrix.starts[y]);
                }
            }
        }
        mixing
    }

    /// By the bits on which neighbours of the same colour agree.
    fn of_bits(matrix: &Matrix, format: Format) -> Self {
        let mut mixing = Self::default();
        let (rows, step) = (rows(format), period(format));
        for y in rows..matrix.height().saturating_sub(rows) {
            let (up, line, down) = (matrix.line(y - rows), matrix.line(y), matrix.line(y + rows));
            for x in step..matrix.width.saturating_sub(step) {
                // The one to the side is no witness where it is on trial.
                let sides = if step > 1 { line[x - step] ^ up[x] | line[x + step] ^ up[x] } else { 0 };
                let agree = !(up[x] ^ down[x] | sides);
                let differs = (line[x] ^ up[x]) & agree;
                mixing.all += u64::from((line[x - 1] ^ up[x]) & agree != 0);
                if differs != 0 {
                    let shows = |other: u16| (line[x] ^ other) & differs == 0;
                    mixing.count(shows(line[x - 1]), shows(line[x + 1]), matrix.starts[y]);
                }
            }
        }
        mixing
    }

    /// What it means, if it means anything.
    pub(super) fn finding(&self, profile: &Profile, times: f64) -> Option<Finding> {
        let (before, after) = (self.before as f64, self.after as f64);
        let ahead = before - after;
        let deviations = ahead / (before + after).sqrt().max(1.0);
        let share = ahead / self.all.max(1) as f64;
        let (more, fewer) = (before.max(after), before.min(after));
        if deviations.abs() < AHEAD || more < 40.0 || share.abs() < 0.001 || more < times * fewer {
            return None;
        }
        let kind = if share.abs() > WRONG { FaultKind::WrongEdge } else { FaultKind::ClockJitter };
        let text = format!(
            "{:.2} % of the samples that can tell show bits of the sample {} them ({more} against {fewer} the other way)",
            100.0 * share.abs(),
            if share > 0.0 { "before" } else { "after" },
        );
        let evidence =
            Evidence::new(text).with("share_of_samples", share).with("standard_deviations", deviations);
        let at = At { clock: self.first, line: None };
        Some(found(kind, 0.96, at, evidence, remedy::of(kind, profile)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth picture in three colours that are far apart.
    fn picture() -> Matrix {
        let mut matrix = Matrix { width: 192, bits: 8, ..Matrix::default() };
        for y in 0..40u16 {
            matrix.starts.push(192 * usize::from(y));
            matrix.samples.extend((0..192).map(|x| [20, 120, 230][usize::from(x % 3)] + x / 32 + y / 8));
        }
        matrix
    }

    #[test]
    fn a_mixture_of_two_bytes_is_one_wire_by_wire() {
        assert!(mixes(0xD1, 0xD5, 0x70, 0x75), "D1 has 4 fewer than D5, as 71 has");
        assert!(!mixes(0x0F, 0xF0, 0x70, 0x75));
        assert!(mixes(0x72, 0xFF, 0x70, 0x75), "what fits by itself does so with anything");
    }

    #[test]
    fn samples_that_show_the_one_before_are_told_from_a_picture() {
        let profile = Profile::default();
        let clean = picture();
        assert_eq!(Mixing::of(&clean, Format::Rgb888).finding(&profile, 1.3), None);
        let mut hit = clean.clone();
        for at in (40..hit.samples.len()).step_by(29) {
            hit.samples[at] = clean.samples[at - 1] & 0xA5 | clean.samples[at] & 0x5A;
        }
        let finding = Mixing::of(&hit, Format::Rgb888).finding(&profile, 1.3).unwrap();
        assert_eq!(finding.fault, FaultKind::ClockJitter, "{}", finding.evidence.text);
        let share = finding.evidence.numbers["share_of_samples"];
        assert!((0.01..0.05).contains(&share), "one in 29 was hit: {share}");
    }
}
