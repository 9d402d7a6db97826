//! What all palette makers share: weighted colours go in, a palette comes out.
//!
//! Every maker reads [`WeightedColor`]s, from a [`super::Histogram`] or from anywhere else, writes up to
//! `palette.len()` colours and says how many. The checks of their arguments are here.

use crate::image::{Error, Rgb};

/// Colours a palette may have at most: an index is a byte.
pub const MOST_COLORS: usize = 256;

/// Pixels that one histogram or list of colours may stand for: a sum of their levels just fits 32 bits.
pub const MOST_PIXELS: u32 = 1 << 24;

pub(super) const PIXELS_ALLOWED: &str = "1 to 16777216 in all";

/// A colour and how many pixels have it (or nearly).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WeightedColor {
    quarters: [u16; 3],
    count: u32,
}

impl WeightedColor {
    /// A place to be filled.
    pub const EMPTY: Self = Self { quarters: [0; 3], count: 0 };

    /// `count` pixels of one colour.
    #[must_use]
    pub fn new(color: Rgb, count: u32) -> Self {
        Self { quarters: quarters(color), count }
    }

    /// `count` pixels of red, green and blue in quarters of a level; above 1020 (255 levels) counts as that.
    #[must_use]
    pub fn from_quarters(quarters: [u16; 3], count: u32) -> Self {
        Self { quarters: quarters.map(|level| level.min(1020)), count }
    }

    /// Red, green and blue in quarters of a level, 0 to 1020.
    #[must_use]
    pub fn quarters(self) -> [u16; 3] {
        self.quarters
    }

    /// Pixels.
    #[must_use]
    pub fn count(self) -> u32 {
        self.count
    }

    /// The colour in whole levels, halves upwards.
    #[must_use]
    pub fn rounded(self) -> Rgb {
        rounded(self.quarters)
    }
}

/// A colour in quarters of a level.
pub(super) fn quarters(color: Rgb) -> [u16; 3] {
    [color.r, color.g, color.b].map(|level| u16::from(level) * 4)
}

/// Quarters of a level (at most 1020) to whole levels, halves upwards.
pub(super) fn rounded(quarters: [u16; 3]) -> Rgb {
    let [r, g, b] = quarters.map(|level| ((level + 2) / 4) as u8);
    Rgb { r, g, b }
}

/// Count and sums of quarters of some weighted colours.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Total {
    pub(super) count: u64,
    pub(super) sum: [u64; 3],
}

impl Total {
    pub(super) fn add(&mut self, color: WeightedColor) {
        let count = u64::from(color.count);
        self.count += count;
        for (sum, level) in self.sum.iter_mut().zip(color.quarters) {
            *sum += count * u64::from(level);
        }
    }

    pub(super) fn of(colors: &[WeightedColor]) -> Self {
        let mut total = Self::default();
        colors.iter().for_each(|&color| total.add(color));
        total
    }

    /// The mean in quarters of a level, halves upwards; nothing of nothing.
    pub(super) fn mean(self) -> Option<[u16; 3]> {
        let mean = |sum: u64| (sum + self.count / 2).checked_div(self.count);
        let [Some(r), Some(g), Some(b)] = self.sum.map(mean) else { return None };
        Some([r as u16, g as u16, b as u16])
    }
}

/// Squared Euclidean distance of two colours in levels: at most 195 075.
pub(super) fn squared_distance(a: Rgb, b: Rgb) -> u32 {
    let square = |a: u8, b: u8| u32::from(a.abs_diff(b)).pow(2);
    square(a.r, b.r) + square(a.g, b.g) + square(a.b, b.b)
}

/// Checks a palette's length.
pub(super) fn check_palette(palette: &[Rgb]) -> Result<(), Error> {
    if (1..=MOST_COLORS).contains(&palette.len()) {
        Ok(())
    } else {
        Err(Error::Parameter { name: "palette", got: palette.len() as i64, allowed: "1 to 256 colours long" })
    }
}

/// Checks that the colours stand for at least one pixel and not too many; says for how many.
pub(super) fn check_colors(colors: &[WeightedColor]) -> Result<u32, Error> {
    // A sum of 32-bit counts wraps 64 bits only beyond 2^32 colours.
    let pixels: u64 = colors.iter().map(|color| u64::from(color.count)).sum();
    if (1..=u64::from(MOST_PIXELS)).contains(&pixels) {
        Ok(pixels as u32)
    } else {
        Err(Error::Parameter { name: "pixels", got: pixels as i64, allowed: PIXELS_ALLOWED })
    }
}

/// The first `expected` elements of a lent buffer.
pub(super) fn lent<'a, T>(
    name: &'static str,
    buffer: &'a mut [T],
    expected: usize,
) -> Result<&'a mut [T], Error> {
    let got = buffer.len();
    buffer.get_mut(..expected).ok_or(Error::BufferLength { name, expected, got })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_round_to_levels_and_back() {
        for level in 0..=255 {
            let color = Rgb { r: level, g: 0, b: 255 };
            assert_eq!(WeightedColor::new(color, 1).rounded(), color);
        }
        assert_eq!(WeightedColor::from_quarters([5, 6, 9999], 1).rounded(), Rgb { r: 1, g: 2, b: 255 });
    }

    #[test]
    fn lengths_and_counts_are_checked() {
        assert!(check_palette(&[]).is_err());
        assert!(check_palette(&[Rgb::default(); 256]).is_ok());
        assert!(check_palette(&[Rgb::default(); 257]).is_err());
        let color = |count| WeightedColor::new(Rgb::default(), count);
        assert!(check_colors(&[]).is_err());
        assert!(check_colors(&[color(0)]).is_err());
        assert_eq!(check_colors(&[color(3), color(4)]), Ok(7));
        assert!(check_colors(&[color(u32::MAX); 3]).is_err());
    }
}
