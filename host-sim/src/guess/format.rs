//! Which pixel format the samples of a frame are.

use std::fmt;

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::entropy::POINT;
use super::geometry;
use super::models::{Samples, cost};
use crate::profile::Frame;

/// A format of so many thousandths of the best one's confidence can't be told from it.
const AS_GOOD: u32 = 300;
/// How much a format must cost more to be half as likely: the excess as a part of the best, in thousandths.
const HALVES: u64 = 40;
/// Least cost that counts, in the fixed point: below it a picture is as good as empty. A 32nd of a bit a sample.
const FLOOR: u64 = 8;
/// Fewest samples that say anything.
const ENOUGH: u64 = 64;

/// A format, and what speaks for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormatGuess {
    /// The format, its mosaic and the frame's size.
    pub frame: Frame,
    /// How much speaks for it, of 1000 in all.
    pub confidence: u32,
    /// Bits that a sample takes once the format is known, in thousandths: fewer is better.
    pub millibits: u64,
    /// How usual the frame's size is, of 1000.
    pub usual_size: u64,
}

impl fmt::Display for FormatGuess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Frame { width, height, format, bayer } = self.frame;
        f.write_str(format.name())?;
        if self.frame.is_bayer() {
            write!(f, " {}", bayer.name())?;
        }
        write!(f, " {width}×{height}")
    }
}

/// The formats that fit, the most likely first; empty if none fits.
#[must_use]
pub fn guess(samples: Samples<'_>) -> Vec<FormatGuess> {
    let height = u32::try_from(samples.values.len() / samples.line.max(1)).unwrap_or(u32::MAX);
    let fitting: Vec<(Frame, u64)> = frames(samples, height)
        .filter_map(|frame| {
            let (bits, seen) = cost(samples, frame.format, frame.bayer);
            // A fixed point of 2⁻⁸ is too coarse for a share of it: eight bits more.
            (seen >= ENOUGH).then(|| (frame, (bits << 8) / seen))
        })
        .collect();
    let best = fitting.iter().map(|(_, cost)| *cost).min().unwrap_or(0).max(FLOOR << 8);
    let mut guesses: Vec<(u64, FormatGuess)> = fitting
        .into_iter()
        .map(|(frame, cost)| {
            let excess = cost.saturating_sub(best) * 1000 / best;
            let usual_size = geometry::usual(frame.width, frame.height);
            let millibits = (cost * 1000) >> (POINT + 8);
            let weight = usual_size * half_to_the(excess, HALVES);
            (weight, FormatGuess { frame, confidence: 0, millibits, usual_size })
        })
        .collect();
    let sum = guesses.iter().map(|(weight, _)| weight).sum::<u64>().max(1);
    for (weight, guess) in &mut guesses {
        guess.confidence = (*weight * 1000 / sum) as u32;
    }
    guesses.sort_by_key(|(weight, guess)| (std::cmp::Reverse(*weight), guess.millibits));
    guesses.into_iter().map(|(_, guess)| guess).collect()
}

/// The guesses that can't be told from the first one by the picture.
pub fn ambiguous(guesses: &[FormatGuess]) -> impl Iterator<Item = &FormatGuess> {
    let best = guesses.first().map_or(0, |guess| guess.confidence);
    guesses.iter().skip(1).filter(move |guess| guess.confidence * 1000 >= best * AS_GOOD)
}

/// 2^(-excess / halves), of 65,536.
fn half_to_the(excess: u64, halves: u64) -> u64 {
    let (whole, rest) = (excess / halves, excess % halves);
    let shifted = 65_536_u64.checked_shr(u32::try_from(whole).unwrap_or(u32::MAX)).unwrap_or(0);
    // Between two halvings a straight line.
    shifted - shifted * rest / (2 * halves)
}

/// The frames that lines of so many samples may be.
fn frames(samples: Samples<'_>, height: u32) -> impl Iterator<Item = Frame> {
    let line = samples.line as u32;
    let bits = samples.bits;
    let used = samples.values.iter().fold(0, |all, value| all | value);
    let fits = move |format: Format| {
        let frame = Frame { width: 2, height: 1, format, bayer: BayerOrder::Rggb };
        let needed = frame.sample_bits();
        let wide_enough = if needed == 8 { bits == 8 } else { bits >= needed };
        // Values beyond a format's depth are not of that format.
        wide_enough && u32::from(used) >> needed == 0
    };
    let shallowest = [Format::Raw10, Format::Raw12].into_iter().find(|&format| fits(format));
    Format::ALL.into_iter().filter(move |&format| fits(format)).flat_map(move |format| {
        let frame = Frame { width: 0, height, format, bayer: BayerOrder::Rggb };
        let per_pixel = frame.samples_per_pixel();
        let width = line / per_pixel;
        let whole = line.is_multiple_of(per_pixel) && !(frame.is_yuv422() && width % 2 == 1);
        // On a wide bus the shallowest depth that holds all values.
        let wide = frame.sample_bits() > 8;
        let count = match (whole && width > 0, frame.is_bayer()) {
            (true, true) if !wide || Some(format) == shallowest => 4,
            (true, false) => 1,
            _ => 0,
        };
        BayerOrder::ALL.into_iter().take(count).map(move |bayer| Frame { width, bayer, ..frame })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_is_even() {
        assert_eq!([0, 40, 80, 20].map(|excess| half_to_the(excess, 40)), [65_536, 32_768, 16_384, 49_152]);
        assert_eq!(half_to_the(u64::MAX, 40), 0);
    }

    #[test]
    fn nothing_can_be_told_of_a_plain_frame_but_its_size() {
        let values = vec![90; 640 * 480];
        let guesses = guess(Samples { values: &values, line: 640, bits: 8 });
        assert_eq!(guesses[0].usual_size, 1000);
        let alike: Vec<_> = ambiguous(&guesses).map(|guess| guess.frame.format).collect();
        assert_eq!(alike.len(), 4, "gray8 and four mosaics: {guesses:#?}");
    }

    #[test]
    fn a_wide_bus_carries_the_shallowest_mosaic_that_fits() {
        for (most, expected) in [(1023, Format::Raw10), (4095, Format::Raw12)] {
            let values: Vec<u16> = (0..64 * 48).map(|n| (n * 37 % (most + 1)) as u16).collect();
            let guesses = guess(Samples { values: &values, line: 64, bits: 12 });
            assert!(guesses.len() == 4 && guesses.iter().all(|guess| guess.frame.format == expected));
        }
        let values = vec![0x3FFF; 64 * 4];
        assert!(guess(Samples { values: &values, line: 64, bits: 14 }).is_empty(), "14 bits are no format");
    }
}
