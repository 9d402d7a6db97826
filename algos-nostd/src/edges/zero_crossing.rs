//! Zero crossings of the Laplacian of a Gaussian: edges where a slope is steepest, as Marr and Hildreth find them.
//!
//! ```text
//!  gray      ▁▁▁▂▅▇▇▇        kernel   1  1 1
//!  Laplacian ──╱╲  ──                 1 -8 1
//!                ╲╱                   1  1 1
//!  edge          ▲  where the sign changes by more than a threshold
//! ```
//!
//! Reference: D. Marr and E. Hildreth, "Theory of edge detection", Proc. Royal Society B 207, 1980. The Laplacian of a
//! Gaussian is the Laplacian of the smoothed picture; smoothing is [`super::smooth`]'s, its fraction kept.
//!
//! Of two pixels side by side or one above the other, whose Laplacians are of opposite sign and differ by more than the
//! threshold, the one nearer to zero is an edge; of two as near, the first. So is a pixel of zero between two such. Beyond
//! the edges the picture is replicated for the smoothing and the Laplacian, and there is nothing to differ from.
//!
//! Memory: [`ZeroCrossings::memory`]. Cost: smoothing, ten operations for the Laplacian and a dozen for the signs.

use core::marker::PhantomData;

use super::bits::{PIXELS_A_WORD, words_a_line};
use super::carve::{carve, words_of};
use super::smooth::Smoothing;
use crate::image::Error;
use crate::lines::{LineFilter, LineSink, Reach, Window, shifted};

/// Marr and Hildreth's edges, a line at a time: gray lines of 8 bits in, words of 32 pixels out.
#[derive(Debug)]
pub struct ZeroCrossings<'m, S> {
    threshold: u32,
    source: Window<'m, u8>,
    smooth: Window<'m, u16>,
    /// The Laplacians of the last three lines, a zero at either end.
    laplacians: [&'m mut [i32]; 3],
    /// Laplacians of this frame, none, one or more.
    made: usize,
    line: &'m mut [u32],
    smoothing: PhantomData<S>,
}

impl<'m, S: Smoothing> ZeroCrossings<'m, S> {
    const SOURCE: Reach = Reach::square(S::RADIUS);
    const SMOOTH: Reach = Reach { columns: 1, lines: 1 };

    /// Words of memory that the filter takes for lines of `width` pixels.
    #[must_use]
    pub const fn memory(width: usize) -> usize {
        words_of(Window::<u8>::memory(width, Self::SOURCE), 1)
            .saturating_add(words_of(Window::<u16>::memory(width, Self::SMOOTH), 2))
            .saturating_add(width.saturating_mul(3))
            .saturating_add(words_a_line(width))
    }

    /// A filter for lines of `width` pixels. `threshold` is in gray levels of the eight neighbours' sum less eight times
    /// the pixel: 0 gives every crossing. `memory` may be longer than [`ZeroCrossings::memory`].
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if `width` is zero, [`Error::BufferLength`] if `memory` is too short.
    pub fn new(width: usize, threshold: u16, memory: &'m mut [u32]) -> Result<Self, Error> {
        if width == 0 {
            return Err(Error::ZeroSize { width, height: 1 });
        }
        let short = Error::BufferLength { name: "memory", expected: Self::memory(width), got: memory.len() };
        let mut rest = memory;
        let source = carve(&mut rest, Window::<u8>::memory(width, Self::SOURCE)).ok_or(short)?;
        let smooth = carve(&mut rest, Window::<u16>::memory(width, Self::SMOOTH)).ok_or(short)?;
        let mut row = || carve(&mut rest, width).ok_or(short);
        let laplacians = [row()?, row()?, row()?];
        let line = carve(&mut rest, words_a_line(width)).ok_or(short)?;
        // A difference is a whole number on the smoothing's scale: it exceeds the threshold if it exceeds its whole part.
        let (numerator, denominator) = S::SCALE;
        let threshold = u32::from(threshold) * numerator / denominator;
        Ok(Self {
            threshold,
            source: Window::new(width, Self::SOURCE, source)?,
            smooth: Window::new(width, Self::SMOOTH, smooth)?,
            laplacians,
            made: 0,
            line,
            smoothing: PhantomData,
        })
    }

    fn smooth_line(&mut self, sink: &mut impl LineSink<u32>) {
        let source = &self.source;
        if self.smooth.push_with(|row| S::smooth(|i| source.row(i), row)) {
            self.differentiate_line(sink);
        }
    }

    fn differentiate_line(&mut self, sink: &mut impl LineSink<u32>) {
        self.laplacians.rotate_left(1);
        laplacian(self.smooth.rows(), self.laplacians[2]);
        if self.made == 0 {
            let [_, above, first] = &mut self.laplacians;
            above.copy_from_slice(first); // no crossing with the line above the first
        } else {
            self.cross_line(sink);
        }
        self.made = 1;
    }

    /// The line before the newest has both its neighbours.
    fn cross_line(&mut self, sink: &mut impl LineSink<u32>) {
        let [above, here, below] = self.laplacians.each_ref().map(|row| &**row);
        cross([above, here, below], self.threshold, self.line);
        sink.line(self.line);
    }
}

impl<S: Smoothing> LineFilter for ZeroCrossings<'_, S> {
    type Input = u8;
    type Output = u32;

    const LATENCY: usize = S::RADIUS + 2;

    fn push(&mut self, line: &[u8], sink: &mut impl LineSink<u32>) -> Result<(), Error> {
        if self.source.push(line)? {
            self.smooth_line(sink);
        }
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<u32>) {
        while self.source.drain() {
            self.smooth_line(sink);
        }
        while self.smooth.drain() {
            self.differentiate_line(sink);
        }
        if self.made > 0 {
            self.laplacians.rotate_left(1);
            let [_, here, below] = &mut self.laplacians;
            below.copy_from_slice(here); // no crossing with the line below the last
            self.cross_line(sink);
            self.made = 0;
        }
    }
}

/// The eight neighbours less eight times the pixel.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn laplacian(rows: [&[u16]; 3], laplacians: &mut [i32]) {
    let width = laplacians.len();
    let [above, centre, below] = rows;
    let (Some([a, b, c]), Some([d, e, f]), Some([g, h, i])) =
        (shifted::<u16, 3>(above, width), shifted::<u16, 3>(centre, width), shifted::<u16, 3>(below, width))
    else {
        return; // rows are as wide as they must be
    };
    for (x, laplacian) in laplacians.iter_mut().enumerate() {
        // Smoothed levels are at most 5,068: eight of them fit 16 bits.
        let around = a[x] + b[x] + c[x] + d[x] + f[x] + g[x] + h[x] + i[x];
        *laplacian = i32::from(around) - 8 * i32::from(e[x]);
    }
}

/// Marks the pixels of the middle line that are edges.
fn cross([above, here, below]: [&[i32]; 3], threshold: u32, line: &mut [u32]) {
    let width = here.len();
    // No product: two Laplacians of 16 bits and more would not fit.
    let opposite = |one: i32, other: i32| (one > 0 && other < 0) || (one < 0 && other > 0);
    let differ = |one: i32, other: i32| opposite(one, other) && one.abs_diff(other) > threshold;
    for (word, bits) in line.iter_mut().enumerate() {
        *bits = 0;
        for x in word * PIXELS_A_WORD..width.min((word + 1) * PIXELS_A_WORD) {
            let pixel = here[x];
            let (left, right) = (here[x.saturating_sub(1)], here[(x + 1).min(width - 1)]);
            let edge = [(left, right), (above[x], below[x])].iter().any(|&(before, after)| {
                // As near to zero as the pixel before, that one is the edge; as near as the one after, this one is.
                (differ(pixel, before) && pixel.abs() < before.abs())
                    || (differ(pixel, after) && pixel.abs() <= after.abs())
                    || (pixel == 0 && differ(before, after))
            });
            *bits |= u32::from(edge) << (x % PIXELS_A_WORD);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bits::BitMap;
    use super::super::bits::tests::show;
    use super::super::smooth::{Gaussian3, NoSmoothing};
    use super::*;

    fn edges<S: Smoothing>(picture: &[&[u8]], threshold: u16) -> Vec<String> {
        let width = picture[0].len();
        let mut memory = vec![u32::MAX; ZeroCrossings::<S>::memory(width)];
        let mut filter = ZeroCrossings::<S>::new(width, threshold, &mut memory).unwrap();
        let mut words = Vec::new();
        for _ in 0..2 {
            words.clear();
            let mut sink = |line: &[u32]| words.extend_from_slice(line);
            for row in picture {
                filter.push(row, &mut sink).unwrap();
            }
            filter.finish(&mut sink);
        }
        show(BitMap::new(&words, width, picture.len()).unwrap())
    }

    #[test]
    fn a_step_is_one_line() {
        let step: &[u8] = &[10, 10, 10, 90, 90, 90];
        assert_eq!(edges::<Gaussian3>(&[step; 4], 10), ["..#..."; 4]);
        assert_eq!(edges::<NoSmoothing>(&[step; 1], 0), ["..#..."]);
        assert_eq!(
            edges::<NoSmoothing>(&[step; 2], 480),
            ["......"; 2],
            "3 × 80 either way do not exceed 480"
        );
        assert_eq!(edges::<NoSmoothing>(&[step; 2], 479), ["..#..."; 2]);
    }

    #[test]
    fn a_spot_is_ringed_or_marked() {
        let made = edges::<NoSmoothing>(&[&[0; 5], &[0; 5], &[0, 0, 9, 0, 0], &[0; 5], &[0; 5]], 0);
        assert_eq!(made, [".....", "..#..", ".#.#.", "..#..", "....."]);
    }

    #[test]
    fn a_pixel_has_no_edge() {
        assert_eq!(edges::<Gaussian3>(&[&[200]], 0), ["."]);
    }

    #[test]
    fn short_memory_is_refused() {
        let expected = ZeroCrossings::<Gaussian3>::memory(7);
        let mut memory = vec![0; expected - 1];
        let error = ZeroCrossings::<Gaussian3>::new(7, 0, &mut memory).unwrap_err();
        assert_eq!(error, Error::BufferLength { name: "memory", expected, got: expected - 1 });
    }
}
