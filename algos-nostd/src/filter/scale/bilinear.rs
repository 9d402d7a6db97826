//! Bilinear scaling: a pixel becomes a weighing of the four input pixels nearest to it.
//!
//! ```text
//! a ─┬─── b        centers map to centers: x_in = (x + ½) × in / out − ½
//! │  │    │        value = mix(mix(a, b, fx), mix(c, d, fx), fy)
//! ├──•────┤        beyond the outermost centers: the outermost value
//! c ─┴─── d
//! ```
//!
//! **Reference.** W. K. Pratt, "Digital Image Processing", ch. 13, first-order; the alignment is that of the usual libraries. Making a picture less
//! than half as large skips pixels: see [`super::box_area`].
//!
//! **Rounding.** Fractions are rounded to 1/256; the value is then rounded once, to the nearest, halves up.
//!
//! **Cost and memory.** Three mixes an output byte. Two lines of 16-bit values and one of pixels, all as wide as the output,
//! lent by the caller.

use super::{Bytes, Sizes, check_at_least};
use crate::image::Error;
use crate::lines::{LineFilter, LineSink, check_width};
use rgb::bytemuck::{cast_slice, cast_slice_mut};

/// The filter.
#[derive(Debug)]
pub struct BilinearScale<'a, P> {
    sizes: Sizes,
    /// The line before the last, scaled across, in 1/256.
    above: &'a mut [u16],
    /// The last line, scaled across, in 1/256.
    below: &'a mut [u16],
    out: &'a mut [P],
    /// Input lines taken.
    taken: usize,
    /// Output lines made.
    made: usize,
}

/// Values to lend for an output of `width` pixels of `channels` bytes.
#[must_use]
pub const fn values(width: usize, channels: usize) -> usize {
    2 * width * channels
}

/// The input position of an output pixel's center: the pixel before it, and 1/256 of the way to the next.
fn position(at: usize, from: usize, to: usize) -> (usize, u32) {
    // In units of 1/(2 out).
    let numerator = ((2 * at + 1) * from).saturating_sub(to);
    let (whole, rest) = (numerator / (2 * to), numerator % (2 * to));
    let fraction = (rest * 256 + to) / (2 * to);
    if whole + 1 < from { (whole, fraction as u32) } else { (from - 1, 0) }
}

impl<'a, P: Bytes> BilinearScale<'a, P> {
    /// `work` holds at least [`values`], and `out` a line of the output.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] for an empty size, [`Error::Parameter`] for a side above [`Sizes::LIMIT`],
    /// [`Error::BufferLength`] if a buffer is too short.
    pub fn new(sizes: Sizes, work: &'a mut [u16], out: &'a mut [P]) -> Result<Self, Error> {
        sizes.check()?;
        let (width, bytes) = (sizes.to.0, sizes.to.0 * P::CHANNELS);
        check_at_least("work", 2 * bytes, work.len())?;
        check_at_least("out", width, out.len())?;
        let (above, rest) = work.split_at_mut(bytes);
        let (below, _) = rest.split_at_mut(bytes);
        Ok(Self { sizes, above, below, out: &mut out[..width], taken: 0, made: 0 })
    }

    /// Makes every output line that the last two lines are enough for.
    fn emit(&mut self, sink: &mut impl LineSink<P>) {
        let (in_height, out_height) = (self.sizes.from.1, self.sizes.to.1);
        while self.made < out_height {
            let (line, fraction) = position(self.made, in_height, out_height);
            // The line itself, and the next one where it has a part.
            let needed = line + 1 + usize::from(fraction > 0);
            if needed > self.taken {
                break;
            }
            // `below` is line `taken − 1`; a line of which it alone is needed is either of the two.
            let (upper, lower) = if line + 1 == self.taken {
                (&*self.below, &*self.below)
            } else {
                (&*self.above, &*self.below)
            };
            let bytes = cast_slice_mut::<P, u8>(self.out);
            for ((byte, &upper), &lower) in bytes.iter_mut().zip(upper).zip(lower) {
                let mixed = u32::from(upper) * (256 - fraction) + u32::from(lower) * fraction;
                *byte = ((mixed + (1 << 15)) >> 16) as u8;
            }
            sink.line(self.out);
            self.made += 1;
        }
    }
}

fn scale_across<const CHANNELS: usize>(line: &[u8], values: &mut [u16], sizes: Sizes) {
    let (pixels, _) = line.as_chunks::<CHANNELS>();
    let (values, _) = values.as_chunks_mut::<CHANNELS>();
    for (at, value) in values.iter_mut().enumerate() {
        let (x, fraction) = position(at, sizes.from.0, sizes.to.0);
        let (left, right) = (&pixels[x], &pixels[(x + 1).min(pixels.len() - 1)]);
        for ((value, &left), &right) in value.iter_mut().zip(left).zip(right) {
            *value = (u32::from(left) * (256 - fraction) + u32::from(right) * fraction) as u16;
        }
    }
}

impl<P: Bytes> LineFilter for BilinearScale<'_, P> {
    type Input = P;
    type Output = P;

    const LATENCY: usize = 1;

    fn push(&mut self, line: &[P], sink: &mut impl LineSink<P>) -> Result<(), Error> {
        check_width(self.sizes.from.0, line.len())?;
        if self.taken == self.sizes.from.1 {
            return Ok(());
        }
        core::mem::swap(&mut self.above, &mut self.below);
        match P::CHANNELS {
            1 => scale_across::<1>(cast_slice(line), self.below, self.sizes),
            _ => scale_across::<3>(cast_slice(line), self.below, self.sizes),
        }
        self.taken += 1;
        self.emit(sink);
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<P>) {
        while (1..self.sizes.from.1).contains(&self.taken) {
            self.above.copy_from_slice(self.below);
            self.taken += 1;
            self.emit(sink);
        }
        (self.taken, self.made) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, ImageMut, Rgb};
    use crate::lines::run;

    fn scaled(from: &[u8], sizes: Sizes) -> Vec<u8> {
        let (mut work, mut line) = (vec![0; values(sizes.to.0, 1)], vec![0u8; sizes.to.0]);
        let mut filter = BilinearScale::new(sizes, &mut work, &mut line).unwrap();
        let mut out = vec![0; sizes.to.0 * sizes.to.1];
        for _ in 0..2 {
            run(
                &mut filter,
                Image::new(from, sizes.from.0, sizes.from.1).unwrap(),
                &mut ImageMut::new(&mut out, sizes.to.0, sizes.to.1).unwrap(),
            )
            .unwrap();
        }
        out
    }

    #[test]
    fn centers_map_to_centers() {
        assert_eq!(scaled(&[0, 100], Sizes { from: (2, 1), to: (4, 1) }), [0, 25, 75, 100]);
        assert_eq!(scaled(&[0, 100], Sizes { from: (1, 2), to: (1, 4) }), [0, 25, 75, 100]);
        assert_eq!(scaled(&[0, 10, 20, 30], Sizes { from: (4, 1), to: (2, 1) }), [5, 25]);
        assert_eq!(scaled(&[7, 9, 200, 1], Sizes { from: (2, 2), to: (2, 2) }), [7, 9, 200, 1]);
    }

    #[test]
    fn a_short_frame_is_filled_with_its_last_line() {
        let sizes = Sizes { from: (1, 9), to: (1, 3) };
        let (mut work, mut line) = ([0; 6], [Rgb::default(); 1]);
        let mut filter = BilinearScale::new(sizes, &mut work, &mut line).unwrap();
        let mut seen = Vec::new();
        let mut sink = |line: &[Rgb]| seen.push(line[0]);
        filter.push(&[Rgb::new(1, 2, 3)], &mut sink).unwrap();
        filter.push(&[Rgb::new(4, 5, 6)], &mut sink).unwrap();
        filter.finish(&mut sink);
        assert_eq!(seen, [Rgb::new(4, 5, 6); 3]);
    }
}
