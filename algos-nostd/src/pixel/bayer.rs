//! The Bayer mosaic: which colour filter lies over which pixel.
//!
//! ```text
//!            x  even odd        even odd        even odd        even odd
//! y even         R   G           B   G           G   R           G   B
//! y odd          G   B           G   R           B   G           R   G
//!                 RGGB            BGGR            GRBG            GBRG
//! ```
//!
//! B. E. Bayer, "Color imaging array", US patent 3,971,065 (1976). Samples of more than 8 bits are right-aligned in
//! a `u16`. The way back is demosaicing, in [`crate::color`].

use super::layout::{BitDepth, check_length};
use crate::image::{Error, Rgb};

/// The colour of one filter of the mosaic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
}

impl Channel {
    /// This channel of a pixel.
    #[inline]
    #[must_use]
    pub const fn of(self, pixel: Rgb) -> u8 {
        match self {
            Self::Red => pixel.r,
            Self::Green => pixel.g,
            Self::Blue => pixel.b,
        }
    }
}

/// The order of the mosaic, read from the top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BayerOrder {
    /// Red at (0, 0), blue at (1, 1).
    Rggb,
    /// Blue at (0, 0), red at (1, 1).
    Bggr,
    /// Green at (0, 0), red at (1, 0).
    Grbg,
    /// Green at (0, 0), blue at (1, 0).
    Gbrg,
}

impl BayerOrder {
    /// All four.
    pub const ALL: [Self; 4] = [Self::Rggb, Self::Bggr, Self::Grbg, Self::Gbrg];

    /// The name in small letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rggb => "rggb",
            Self::Bggr => "bggr",
            Self::Grbg => "grbg",
            Self::Gbrg => "gbrg",
        }
    }

    /// The order of that name, in any case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|order| order.name().eq_ignore_ascii_case(name))
    }

    /// The filters of an even and an odd pixel of line `y`.
    #[inline]
    #[must_use]
    pub const fn line(self, y: usize) -> [Channel; 2] {
        use Channel::{Blue, Green, Red};
        match (self, y.is_multiple_of(2)) {
            (Self::Rggb, true) | (Self::Gbrg, false) => [Red, Green],
            (Self::Rggb, false) | (Self::Gbrg, true) => [Green, Blue],
            (Self::Bggr, true) | (Self::Grbg, false) => [Blue, Green],
            (Self::Bggr, false) | (Self::Grbg, true) => [Green, Red],
        }
    }

    /// The filter over the pixel in column `x` of line `y`.
    #[inline]
    #[must_use]
    pub const fn channel(self, x: usize, y: usize) -> Channel {
        self.line(y)[x % 2]
    }

    /// The order seen from `(x, y)`: that of a picture cropped or flipped so that this pixel becomes its corner.
    #[must_use]
    pub const fn shifted(self, x: usize, y: usize) -> Self {
        let across = match (self, x.is_multiple_of(2)) {
            (same, true) => same,
            (Self::Rggb, false) => Self::Grbg,
            (Self::Bggr, false) => Self::Gbrg,
            (Self::Grbg, false) => Self::Rggb,
            (Self::Gbrg, false) => Self::Bggr,
        };
        match (across, y.is_multiple_of(2)) {
            (same, true) => same,
            (Self::Rggb, false) => Self::Gbrg,
            (Self::Bggr, false) => Self::Grbg,
            (Self::Grbg, false) => Self::Bggr,
            (Self::Gbrg, false) => Self::Rggb,
        }
    }
}

/// What the sensor sees of line `y`: one channel of each pixel, 8 bits a sample.
///
/// # Errors
/// [`Error::BufferLength`] if `samples` is not as long as the line; nothing is then written.
pub fn mosaic_line(pixels: &[Rgb], samples: &mut [u8], order: BayerOrder, y: usize) -> Result<(), Error> {
    check_length("samples", pixels.len(), samples.len())?;
    let filters = order.line(y);
    for (x, (sample, &pixel)) in samples.iter_mut().zip(pixels).enumerate() {
        *sample = filters[x % 2].of(pixel);
    }
    Ok(())
}

/// The same in samples of `depth`, right-aligned; 8 bits are expanded by [`BitDepth::expand`].
///
/// # Errors
/// As [`mosaic_line`].
pub fn mosaic_line_deep(
    pixels: &[Rgb],
    samples: &mut [u16],
    order: BayerOrder,
    y: usize,
    depth: BitDepth,
) -> Result<(), Error> {
    check_length("samples", pixels.len(), samples.len())?;
    let filters = order.line(y);
    for (x, (sample, &pixel)) in samples.iter_mut().zip(pixels).enumerate() {
        *sample = depth.expand(filters[x % 2].of(pixel));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXEL: Rgb = Rgb::new(b'R', b'G', b'B');

    #[test]
    fn a_name_spells_its_first_two_lines() {
        for order in BayerOrder::ALL {
            let mut drawn = [0; 4];
            mosaic_line(&[PIXEL; 2], &mut drawn[..2], order, 0).unwrap();
            mosaic_line(&[PIXEL; 2], &mut drawn[2..], order, 1).unwrap();
            assert_eq!(core::str::from_utf8(&drawn).unwrap().to_lowercase(), order.name());
            assert_eq!(BayerOrder::from_name(order.name()), Some(order));
        }
        assert_eq!(BayerOrder::from_name("rgbg"), None);
    }

    #[test]
    fn the_order_moves_with_the_corner() {
        for order in BayerOrder::ALL {
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1), (2, 3)] {
                let moved = order.shifted(x, y);
                for (u, v) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    assert_eq!(moved.channel(u, v), order.channel(x + u, y + v));
                }
            }
        }
    }

    #[test]
    fn deep_samples_hold_the_shallow_ones_on_top() {
        let mut deep = [0; 3];
        mosaic_line_deep(&[PIXEL; 3], &mut deep, BayerOrder::Gbrg, 1, BitDepth::Bits12).unwrap();
        assert_eq!(deep.map(|sample| (sample >> 4) as u8), *b"RGR");
        assert!(mosaic_line(&[PIXEL; 3], &mut [0; 2], BayerOrder::Rggb, 0).is_err());
    }
}
