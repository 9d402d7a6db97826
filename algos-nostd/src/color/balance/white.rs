//! The colour of a light, and scaling of red, green and blue so that it becomes neutral.
//!
//! ```text
//! out = min(255, in × gain)        gain = target / white, for each channel by itself
//! ```
//!
//! J. von Kries, "Beitrag zur Physiologie der Gesichtsempfindung" (1878), with the camera's own channels in place of
//! the cones: the "wrong von Kries" transform, and what every white balance register of a sensor does.
//!
//! **Fixed point.** Gains are Q12 in 16 bits, 0 to 15.9998. A product is rounded once, to the nearest with halves up, and
//! saturates at 255: `(in × gain + 2048) >> 12`, computed as a high half of 16 × 16 bits, which gives the same.
//!
//! **Cost.** One pass in place over the bytes, a multiplication each; the gains repeat every 96 bytes, so that
//! the loop over bytes needs no knowledge of pixels and vectorises.

use crate::color::pointwise::PixelMap;
use crate::image::{Error, Rgb};
use crate::pixel::rgb888;

/// The colour of a light as the camera sees it: intensities in 1/256 of a code, 0 to 65,280.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct White {
    /// Red.
    pub r: u16,
    /// Green.
    pub g: u16,
    /// Blue.
    pub b: u16,
}

impl White {
    /// The colour of a pixel.
    #[must_use]
    pub const fn of(pixel: Rgb) -> Self {
        Self { r: (pixel.r as u16) << 8, g: (pixel.g as u16) << 8, b: (pixel.b as u16) << 8 }
    }

    /// The mean of three sums over `count` pixels, to the nearest 1/256. Black for no pixels.
    #[must_use]
    pub fn mean(sums: [u64; 3], count: u64) -> Self {
        let mean = |sum: u64| {
            let scaled = sum.saturating_mul(256).saturating_add(count / 2);
            u16::try_from(scaled.checked_div(count).unwrap_or(0)).unwrap_or(u16::MAX)
        };
        Self { r: mean(sums[0]), g: mean(sums[1]), b: mean(sums[2]) }
    }

    /// The gray of the same mean intensity.
    #[must_use]
    pub const fn gray(self) -> Self {
        let gray = ((self.r as u32 + self.g as u32 + self.b as u32 + 1) / 3) as u16;
        Self { r: gray, g: gray, b: gray }
    }

    pub(super) const fn channels(self) -> [u16; 3] {
        [self.r, self.g, self.b]
    }
}

/// Bytes after which red, green and blue and a vector's lanes are where they were.
const PERIOD: usize = 96;

/// A factor for each of red, green and blue, in Q12.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gains([u16; 3]);

impl Gains {
    /// A gain of one.
    pub const ONE: u16 = 1 << 12;

    /// Leaves every pixel as it is.
    pub const IDENTITY: Self = Self([Self::ONE; 3]);

    /// Gains for red, green and blue, in Q12.
    #[must_use]
    pub const fn from_q12(gains: [u16; 3]) -> Self {
        Self(gains)
    }

    /// The gains for red, green and blue, in Q12.
    #[must_use]
    pub const fn to_q12(self) -> [u16; 3] {
        self.0
    }

    /// Gains that make `white` the colour `target`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a channel of `white` is so dark that its gain would be 16 or more: such a light cannot be
    /// balanced.
    pub fn scaling(white: White, target: White) -> Result<Self, Error> {
        let mut gains = [0; 3];
        for ((gain, from), to) in gains.iter_mut().zip(white.channels()).zip(target.channels()) {
            let scaled = ((u32::from(to) << 12) + u32::from(from) / 2).checked_div(from.into());
            *gain = scaled.and_then(|scaled| u16::try_from(scaled).ok()).ok_or(Error::Parameter {
                name: "white",
                got: from.into(),
                allowed: "more than a 16th of the target in every channel",
            })?;
        }
        Ok(Self(gains))
    }

    /// Gains that make `white` the gray of the same mean intensity.
    ///
    /// # Errors
    /// As [`Gains::scaling`].
    pub fn neutralizing(white: White) -> Result<Self, Error> {
        Self::scaling(white, white.gray())
    }

    /// One pixel, scaled.
    #[inline]
    #[must_use]
    pub fn apply(&self, pixel: Rgb) -> Rgb {
        let [r, g, b] = self.0;
        Rgb { r: scale(pixel.r, r), g: scale(pixel.g, g), b: scale(pixel.b, b) }
    }
}

impl PixelMap<Rgb> for Gains {
    fn apply_line(&self, line: &mut [Rgb]) {
        scale_bytes(rgb888::as_bytes_mut(line), self.0);
    }
}

/// `min(255, (value × gain + 2048) >> 12)`.
#[inline]
fn scale(value: u8, gain: u16) -> u8 {
    // The high half of a product of two 16-bit numbers: one instruction in vector units.
    let sixteenths = (u32::from(u16::from(value) << 8) * u32::from(gain)) >> 16;
    // `min` and not a comparison: it is an instruction of vector units, and half as fast again.
    ((sixteenths as u16 + 8) >> 4).min(255) as u8
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn scale_bytes(bytes: &mut [u8], gains: [u16; 3]) {
    let mut pattern = [0; PERIOD];
    pattern.iter_mut().zip(gains.iter().cycle()).for_each(|(place, &gain)| *place = gain);
    let (periods, rest) = bytes.as_chunks_mut::<PERIOD>();
    for period in periods {
        period.iter_mut().zip(&pattern).for_each(|(byte, &gain)| *byte = scale(*byte, gain));
    }
    rest.iter_mut().zip(&pattern).for_each(|(byte, &gain)| *byte = scale(*byte, gain));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_product_is_rounded_to_the_nearest() {
        for gain in (0..=u16::MAX).step_by(7) {
            for value in 0..=255u8 {
                let expected = ((u32::from(value) * u32::from(gain) + 2048) >> 12).min(255);
                assert_eq!(u32::from(scale(value, gain)), expected, "{value} × {gain}");
            }
        }
    }

    #[test]
    fn the_light_becomes_gray() {
        let light = Rgb::new(200, 100, 150);
        let gains = Gains::neutralizing(White::of(light)).unwrap();
        let mut line = [light; 70];
        gains.apply_line(&mut line);
        assert_eq!(line, [Rgb::new(150, 150, 150); 70], "whole periods and the rest alike");
        assert_eq!(gains.apply(Rgb::new(255, 255, 255)), Rgb::new(191, 255, 255), "and white saturates");
    }

    #[test]
    fn darkness_is_refused() {
        let error = Gains::neutralizing(White::of(Rgb::new(255, 255, 0))).unwrap_err();
        assert!(matches!(error, Error::Parameter { name: "white", got: 0, .. }));
        assert!(Gains::neutralizing(White { r: 1, g: 40, b: 40 }).is_err());
        assert_eq!(White::mean([0; 3], 0), White { r: 0, g: 0, b: 0 });
    }
}
