//! Box scaling: a pixel becomes the mean of the area that it covers.
//!
//! ```text
//! in    │ a │ b │ c │ d │ e │       5 to 2 pixels: each out pixel covers 2½
//! out   │    A    ·    B    │       A = (2a + 2b + c) / 5,  B = (c + 2d + 2e) / 5
//! ```
//!
//! **Reference.** W. K. Pratt, "Digital Image Processing", ch. 13, zero-order; "area averaging" elsewhere. Weights are whole numbers: in units of
//! 1/(out width), an input pixel is `out width` wide and an output pixel `in width`, so nothing is lost.
//!
//! **Rounding.** Once, to the nearest, halves up.
//!
//! **Cost and memory.** Two multiplications an input byte and line of overlap, one division an output byte. Two lines of
//! sums and one of pixels, all as wide as the output, lent by the caller.

use super::{Bytes, Sizes, check_at_least};
use crate::image::Error;
use crate::lines::{LineFilter, LineSink, check_width};
use rgb::bytemuck::{cast_slice, cast_slice_mut};

/// The filter.
#[derive(Debug)]
pub struct BoxScale<'a, P> {
    sizes: Sizes,
    /// The last line, scaled across.
    across: &'a mut [u32],
    /// The output line so far.
    sums: &'a mut [u32],
    out: &'a mut [P],
    /// Input lines taken.
    taken: usize,
    /// Where the output line in the making begins, in units of 1/(out height).
    made: usize,
}

/// Sums to lend for an output of `width` pixels of `channels` bytes.
#[must_use]
pub const fn sums(width: usize, channels: usize) -> usize {
    2 * width * channels
}

impl<'a, P: Bytes> BoxScale<'a, P> {
    /// `work` holds at least [`sums`], and `out` a line of the output.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] for an empty size, [`Error::Parameter`] for a side above [`Sizes::LIMIT`],
    /// [`Error::BufferLength`] if a buffer is too short.
    pub fn new(sizes: Sizes, work: &'a mut [u32], out: &'a mut [P]) -> Result<Self, Error> {
        sizes.check()?;
        let (width, bytes) = (sizes.to.0, sizes.to.0 * P::CHANNELS);
        check_at_least("work", 2 * bytes, work.len())?;
        check_at_least("out", width, out.len())?;
        let (across, rest) = work.split_at_mut(bytes);
        let (sums, _) = rest.split_at_mut(bytes);
        sums.fill(0);
        Ok(Self { sizes, across, sums, out: &mut out[..width], taken: 0, made: 0 })
    }

    /// Adds the line in `across` wherever it overlaps output lines, and hands on those that it completes.
    fn take_line(&mut self, sink: &mut impl LineSink<P>) {
        let (in_height, out_height) = (self.sizes.from.1, self.sizes.to.1);
        let (mut top, bottom) = (self.taken * out_height, (self.taken + 1) * out_height);
        self.taken += 1;
        while top < bottom {
            let end = self.made + in_height;
            // At most 4,096 of either.
            let weight = (bottom.min(end) - top) as u32;
            self.sums.iter_mut().zip(self.across.iter()).for_each(|(sum, &across)| *sum += weight * across);
            top = bottom.min(end);
            if top == end {
                let area = (self.sizes.from.0 * in_height) as u32;
                for (byte, sum) in cast_slice_mut::<P, u8>(self.out).iter_mut().zip(self.sums.iter_mut()) {
                    // 255 × 4,096² + 2²³ is below 2³².
                    *byte = ((*sum + area / 2) / area) as u8;
                    *sum = 0;
                }
                sink.line(self.out);
                self.made = end;
            }
        }
    }
}

/// Sums each output pixel's overlap with the line's pixels, in units of 1/(out width).
fn scale_across<const CHANNELS: usize>(line: &[u8], sums: &mut [u32], in_width: usize, out_width: usize) {
    let (pixels, _) = line.as_chunks::<CHANNELS>();
    let (sums, _) = sums.as_chunks_mut::<CHANNELS>();
    let (mut x, mut left) = (0, out_width);
    for sum in sums {
        *sum = [0; CHANNELS];
        let mut wanted = in_width;
        while wanted > 0 && x < pixels.len() {
            let weight = wanted.min(left);
            for (sum, &byte) in sum.iter_mut().zip(&pixels[x]) {
                *sum += weight as u32 * u32::from(byte);
            }
            wanted -= weight;
            left -= weight;
            if left == 0 {
                (x, left) = (x + 1, out_width);
            }
        }
    }
}

impl<P: Bytes> LineFilter for BoxScale<'_, P> {
    type Input = P;
    type Output = P;

    const LATENCY: usize = 0;

    fn push(&mut self, line: &[P], sink: &mut impl LineSink<P>) -> Result<(), Error> {
        check_width(self.sizes.from.0, line.len())?;
        if self.taken == self.sizes.from.1 {
            return Ok(());
        }
        let (from, to) = (self.sizes.from.0, self.sizes.to.0);
        match P::CHANNELS {
            1 => scale_across::<1>(cast_slice(line), self.across, from, to),
            _ => scale_across::<3>(cast_slice(line), self.across, from, to),
        }
        self.take_line(sink);
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<P>) {
        while (1..self.sizes.from.1).contains(&self.taken) {
            self.take_line(sink);
        }
        (self.taken, self.made) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, ImageMut, Rgb};
    use crate::lines::run;

    #[test]
    fn areas_are_shared_where_they_overlap() {
        let sizes = Sizes { from: (5, 1), to: (2, 1) };
        let (mut work, mut line) = ([0; sums(2, 1)], [0u8; 2]);
        let mut filter = BoxScale::new(sizes, &mut work, &mut line).unwrap();
        let mut out = [0; 2];
        run(
            &mut filter,
            Image::new(&[10, 20, 30, 40, 51], 5, 1).unwrap(),
            &mut ImageMut::new(&mut out, 2, 1).unwrap(),
        )
        .unwrap();
        assert_eq!(out, [18, 42], "(20 + 40 + 30) / 5 and (30 + 80 + 102) / 5");
    }

    #[test]
    fn the_brightest_picture_does_not_overflow() {
        let sizes = Sizes { from: (4096, 4096), to: (1, 1) };
        let (mut work, mut line) = ([0; 6], [Rgb::default(); 1]);
        let mut filter = BoxScale::new(sizes, &mut work, &mut line).unwrap();
        let white = vec![Rgb::new(255, 255, 255); 4096];
        let mut seen = Vec::new();
        filter.push(&white, &mut |line: &[Rgb]| seen.push(line[0])).unwrap();
        // The frame ends early: its only line stands for all.
        filter.finish(&mut |line: &[Rgb]| seen.push(line[0]));
        assert_eq!(seen, [Rgb::new(255, 255, 255)]);
    }

    #[test]
    fn bad_sizes_are_refused() {
        let (mut work, mut line) = ([0; 4], [0u8; 2]);
        let mut new = |from, to| BoxScale::new(Sizes { from, to }, &mut work, &mut line).map(|_| ());
        assert_eq!(new((0, 1), (1, 1)), Err(Error::ZeroSize { width: 0, height: 1 }));
        assert_eq!(new((9, 9), (3, 1)), Err(Error::BufferLength { name: "work", expected: 6, got: 4 }));
        assert!(matches!(new((4097, 1), (1, 1)), Err(Error::Parameter { got: 4097, .. })));
    }
}
