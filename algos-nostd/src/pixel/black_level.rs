//! Black level: what a sensor reads in the dark is taken off, and what is left stretched to white again.
//!
//! ```text
//! sample   0 … black … white        out = (sample − black) × white / (white − black), rounded, 0 below black
//! out      0 …   0   … white
//! ```
//!
//! Each of the four places of the mosaic has its own black, because their amplifiers differ. The factor is in Q18,
//! rounded up, so that white comes out as white; a result lies at most 9/16 above and 1/2 below the exact quotient. Cost: a subtraction and a multiplication a sample, in place.

use super::layout::BitDepth;
use crate::image::Error;

/// Takes the black level off lines of RAW samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlackLevel {
    levels: [u16; 4],
    gains: [u32; 4],
    white: u16,
}

impl BlackLevel {
    /// `levels` are those at (0, 0), (1, 0), (0, 1) and (1, 1), in samples of `depth`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a level lies above half of white: that is no dark sensor.
    pub fn new(levels: [u16; 4], depth: BitDepth) -> Result<Self, Error> {
        let white = depth.max();
        if let Some(&level) = levels.iter().find(|&&level| level > white / 2) {
            return Err(Error::Parameter {
                name: "levels",
                got: level.into(),
                allowed: "at most half of the largest sample",
            });
        }
        let gains = levels.map(|level| (u32::from(white) << 18).div_ceil(u32::from(white - level)));
        Ok(Self { levels, gains, white })
    }

    /// Treats line `y` of a picture in place.
    pub fn apply_line(&self, samples: &mut [u16], y: usize) {
        let place = 2 * (y % 2);
        let (levels, gains) = (&self.levels[place..place + 2], &self.gains[place..place + 2]);
        for (x, sample) in samples.iter_mut().enumerate() {
            let light = (*sample).min(self.white).saturating_sub(levels[x % 2]);
            // At most white × 2¹⁸ + white: 14-bit samples and the half just stay within 32 bits.
            let stretched = (u32::from(light) * gains[x % 2] + (1 << 17)) >> 18;
            *sample = (stretched as u16).min(self.white);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_becomes_zero_and_white_stays() {
        for depth in [BitDepth::Bits8, BitDepth::Bits10, BitDepth::Bits12, BitDepth::Bits14] {
            let white = depth.max();
            for level in [0, 1, white / 16, white / 2] {
                let filter = BlackLevel::new([0, level, 0, 0], depth).unwrap();
                for sample in 0..=white {
                    let mut line = [sample, sample];
                    filter.apply_line(&mut line, 2);
                    let (light, span) = (u64::from(sample.saturating_sub(level)), u64::from(white - level));
                    assert_eq!(line[0], sample, "another place has another level");
                    // In sixteenths of a step.
                    let (got, exact) = (16 * u64::from(line[1]) * span, 16 * light * u64::from(white));
                    assert!(got <= exact + 9 * span && exact <= got + 8 * span, "{sample} − {level}");
                }
            }
        }
    }

    #[test]
    fn a_bright_black_is_refused() {
        assert!(BlackLevel::new([0, 0, 512, 0], BitDepth::Bits10).is_err());
    }
}
