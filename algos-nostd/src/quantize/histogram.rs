//! The streaming histogram: lines in, weighted colours out, so that a frame never has to be held.
//!
//! ```text
//! line ─► add ─► bins, 2^BITS a side ─► weighted_colors ─► median cut, Wu, k-means, …
//!                count, Σr, Σg, Σb      mean and count of each occupied bin
//! ```
//!
//! A bin keeps the sum of its pixels besides their number, so a colour that comes out is the mean of the pixels that
//! went in and not the middle of the bin: 3 bits a channel (8 KiB) already give a useful palette of 16 colours.
//!
//! Cost: one pass over the pixels, four additions to one 16-byte bin each. Memory: [`Histogram::bins`] of [`Bin`],
//! that is 8 KiB at 3 bits a channel, 64 KiB at 4, 512 KiB at 5.

use super::palette::{MOST_PIXELS, PIXELS_ALLOWED, WeightedColor};
use crate::image::{Error, Rgb};

/// What a [`Histogram`] keeps of the pixels of one cell of the colour cube.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(16))]
pub struct Bin {
    /// Pixels.
    pub count: u32,
    /// Sum of their red, green and blue.
    pub sum: [u32; 3],
}

impl Bin {
    /// A bin without pixels.
    pub const EMPTY: Self = Self { count: 0, sum: [0; 3] };
}

/// Counts colours, `BITS` (1 to 6) of each channel kept.
#[derive(Debug)]
pub struct Histogram<'a, const BITS: u32> {
    bins: &'a mut [Bin],
    pixels: u32,
}

impl<'a, const BITS: u32> Histogram<'a, BITS> {
    /// Bins needed.
    #[must_use]
    pub const fn bins() -> usize {
        const { assert!(BITS >= 1 && BITS <= 6, "a histogram keeps 1 to 6 bits of a channel") };
        1 << (3 * BITS)
    }

    /// An empty histogram in lent memory, which is cleared.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if `bins` is shorter than [`Histogram::bins`]; longer is allowed.
    pub fn new(bins: &'a mut [Bin]) -> Result<Self, Error> {
        let got = bins.len();
        let Some(bins) = bins.get_mut(..Self::bins()) else {
            return Err(Error::BufferLength { name: "bins", expected: Self::bins(), got });
        };
        bins.fill(Bin::EMPTY);
        Ok(Self { bins, pixels: 0 })
    }

    /// Forgets all pixels.
    pub fn clear(&mut self) {
        self.bins.fill(Bin::EMPTY);
        self.pixels = 0;
    }

    /// Pixels counted since the last [`Histogram::clear`].
    #[must_use]
    pub fn pixels(&self) -> u32 {
        self.pixels
    }

    /// Bins that have pixels: the memory that [`Histogram::weighted_colors`] needs.
    #[must_use]
    pub fn occupied(&self) -> usize {
        self.bins.iter().filter(|bin| bin.count > 0).count()
    }

    /// Counts the pixels of a line.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the histogram would then hold more than [`MOST_PIXELS`]; none of the line
    /// is then counted.
    pub fn add(&mut self, line: &[Rgb]) -> Result<(), Error> {
        self.add_every(line, 1)
    }

    /// Counts every `step`-th pixel of a line, from the first: a subsample costs that much less.
    ///
    /// # Errors
    /// As [`Histogram::add`], and if `step` is zero.
    pub fn add_every(&mut self, line: &[Rgb], step: usize) -> Result<(), Error> {
        if step == 0 {
            return Err(Error::Parameter { name: "step", got: 0, allowed: "at least 1" });
        }
        let added = line.len().div_ceil(step);
        let pixels = added as u64 + u64::from(self.pixels);
        if pixels > u64::from(MOST_PIXELS) {
            return Err(Error::Parameter { name: "pixels", got: pixels as i64, allowed: PIXELS_ALLOWED });
        }
        self.pixels = pixels as u32;
        if step == 1 {
            line.iter().for_each(|&pixel| count(self.bins, cell::<BITS>(pixel), pixel));
        } else {
            line.iter().step_by(step).for_each(|&pixel| count(self.bins, cell::<BITS>(pixel), pixel));
        }
        Ok(())
    }

    /// The mean colour and the number of pixels of every occupied bin, written to lent memory: the part of it that
    /// was filled.
    ///
    /// Means are rounded to the nearest quarter of a level. Bins come in order of red, then green, then blue.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if `colors` is shorter than [`Histogram::occupied`]; nothing is then written.
    pub fn weighted_colors<'c>(
        &self,
        colors: &'c mut [WeightedColor],
    ) -> Result<&'c mut [WeightedColor], Error> {
        let (expected, got) = (self.occupied(), colors.len());
        let Some(colors) = colors.get_mut(..expected) else {
            return Err(Error::BufferLength { name: "colors", expected, got });
        };
        let occupied = self.bins.iter().filter(|bin| bin.count > 0);
        for (color, bin) in colors.iter_mut().zip(occupied) {
            let mean =
                |sum: u32| ((u64::from(sum) * 4 + u64::from(bin.count / 2)) / u64::from(bin.count)) as u16;
            *color = WeightedColor::from_quarters(bin.sum.map(mean), bin.count);
        }
        Ok(colors)
    }
}

/// The cell of the colour cube, `BITS` a side, in which a pixel lies; red is the slowest.
pub(super) fn cell<const BITS: u32>(pixel: Rgb) -> usize {
    let top = |level: u8| usize::from(level >> (8 - BITS));
    top(pixel.r) << (2 * BITS) | top(pixel.g) << BITS | top(pixel.b)
}

#[inline(always)]
fn count(bins: &mut [Bin], cell: usize, pixel: Rgb) {
    // Always there: a cell has 3 × BITS bits and `new` checked the length.
    if let Some(bin) = bins.get_mut(cell) {
        bin.count += 1;
        bin.sum[0] += u32::from(pixel.r);
        bin.sum[1] += u32::from(pixel.g);
        bin.sum[2] += u32::from(pixel.b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(level: u8) -> Rgb {
        Rgb { r: level, g: level, b: level }
    }

    #[test]
    fn bins_give_back_the_mean_of_what_went_in() {
        let mut bins = [Bin::EMPTY; Histogram::<1>::bins()];
        let mut histogram = Histogram::<1>::new(&mut bins).unwrap();
        histogram.add(&[gray(10), gray(21), gray(200)]).unwrap();
        histogram.add_every(&[gray(201), gray(0), gray(202)], 2).unwrap();
        let mut colors = [WeightedColor::EMPTY; 3];
        let colors = histogram.weighted_colors(&mut colors).unwrap();
        let expected = [([62; 3], 2), ([804; 3], 3)].map(|(q, count)| WeightedColor::from_quarters(q, count));
        assert_eq!(colors, expected, "15.5 and 201 levels");
        assert_eq!(histogram.pixels(), 5);
        assert_eq!(
            histogram.weighted_colors(&mut [WeightedColor::EMPTY; 1]).unwrap_err(),
            Error::BufferLength { name: "colors", expected: 2, got: 1 }
        );
        histogram.clear();
        assert_eq!((histogram.pixels(), histogram.occupied()), (0, 0));
    }

    #[test]
    fn bad_parameters_are_refused() {
        assert_eq!(
            Histogram::<2>::new(&mut [Bin::EMPTY; 63]).unwrap_err(),
            Error::BufferLength { name: "bins", expected: 64, got: 63 }
        );
        let mut bins = [Bin::EMPTY; 8];
        let mut histogram = Histogram::<1>::new(&mut bins).unwrap();
        assert!(histogram.add_every(&[gray(0)], 0).is_err());
        let line = [gray(255); 1 << 16];
        for _ in 0..256 {
            histogram.add(&line).unwrap();
        }
        assert!(histogram.add(&[gray(255)]).is_err(), "full");
        assert_eq!(histogram.pixels(), MOST_PIXELS);
        let mut colors = [WeightedColor::EMPTY; 1];
        assert_eq!(histogram.weighted_colors(&mut colors).unwrap()[0].rounded(), gray(255));
    }
}
