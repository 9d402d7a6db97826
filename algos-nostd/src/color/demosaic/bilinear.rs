//! Bilinear demosaic: what is missing is the mean of its nearest neighbours.
//!
//! ```text
//! at R (B alike)              at G of a red line
//!   b g b    G = (g+g+g+g)/4     g b g    R = (r + r)/2
//!   g R g    B = (b+b+b+b)/4     r G r    B = (b + b)/2
//!   b g b                        g b g
//! ```
//!
//! **Reference.** The baseline of every comparison: J. E. Adams, "Interactions between color plane interpolation and
//! other image processing functions in electronic photography", SPIE 2416 (1995).
//!
//! **Rounding.** A mean is rounded to the nearest sample, halves up; of deep samples the high 8 bits are given.
//!
//! **Cost and memory.** Eight additions a pixel; three lines of samples and one of pixels, lent by the caller.

use super::window::{Both, Sample, Stencil, Wide, Window, window_samples};
use crate::image::{Error, Rgb};
use crate::lines::{LineFilter, LineSink, check_width};
use crate::pixel::BitDepth;
use crate::pixel::bayer::BayerOrder;

/// The filter.
#[derive(Debug)]
pub struct Bilinear<'a, S> {
    window: Window<'a, S, 1>,
    out: &'a mut [Rgb],
}

/// Samples of lent window for lines of `width`.
#[must_use]
pub const fn window(width: usize) -> usize {
    window_samples(width, 1)
}

impl<'a, S: Sample> Bilinear<'a, S> {
    /// For lines as long as `out`; `samples` holds at least [`window`] of that.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if it does not; [`Error::Parameter`] if lines are shorter than 2, or `depth` is more
    /// than the sample's type can hold.
    pub fn new(
        order: BayerOrder,
        depth: BitDepth,
        samples: &'a mut [S],
        out: &'a mut [Rgb],
    ) -> Result<Self, Error> {
        Ok(Self { window: Window::new(order, depth, out.len(), samples)?, out })
    }

    fn emit(&mut self, y: usize, sink: &mut impl LineSink<Rgb>) {
        let lines = [-1, 0, 1].map(|offset| self.window.line(y, offset));
        self.window.sites(y).fill::<Means, S, 3>(lines, self.out, self.window.shift());
        sink.line(self.out);
    }
}

struct Means;

impl Stencil<3> for Means {
    #[inline(always)]
    fn both<W: Wide>(at: impl Fn(usize, usize) -> W, shift: u32) -> Both {
        let (across, along) = (at(1, 0) + at(1, 2), at(0, 1) + at(2, 1));
        let corners = at(0, 0) + at(0, 2) + at(2, 0) + at(2, 2);
        let here = (at(1, 1) >> shift).saturate();
        let half = |sum: W| ((sum + W::from(1)) >> (1 + shift)).saturate();
        let quarter = |sum: W| ((sum + W::from(2)) >> (2 + shift)).saturate();
        Both {
            own: [here, quarter(across + along), quarter(corners)],
            green: [half(across), here, half(along)],
        }
    }
}

impl<S: Sample> LineFilter for Bilinear<'_, S> {
    type Input = S;
    type Output = Rgb;

    const LATENCY: usize = 1;

    fn push(&mut self, line: &[S], sink: &mut impl LineSink<Rgb>) -> Result<(), Error> {
        check_width(self.out.len(), line.len())?;
        if let Some(y) = self.window.push(line)? {
            self.emit(y, sink);
        }
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<Rgb>) {
        for y in self.window.rest() {
            self.emit(y, sink);
        }
        self.window.reset();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, ImageMut};
    use crate::lines::run;

    #[test]
    fn means_are_of_the_right_neighbours() {
        // R at (0, 0): 10 above 40, greens 100 and 120, 140 and 160, blue 200.
        #[rustfmt::skip]
        let mosaic = [
            10, 100,  20,
           120, 200, 140,
            40, 160,  80,
        ];
        let (mut window, mut line) = ([0u8; window(3)], [Rgb::default(); 3]);
        let mut filter = Bilinear::new(BayerOrder::Rggb, BitDepth::Bits8, &mut window, &mut line).unwrap();
        let mut out = [Rgb::default(); 9];
        for _ in 0..2 {
            run(&mut filter, Image::new(&mosaic, 3, 3).unwrap(), &mut ImageMut::new(&mut out, 3, 3).unwrap())
                .unwrap();
            assert_eq!(out[4], Rgb::new(38, 130, 200), "blue site: 37.5 rounds up");
            assert_eq!(out[1], Rgb::new(15, 100, 200), "green site, mirrored above");
            assert_eq!(out[0], Rgb::new(10, 110, 200), "red site, mirrored above and to the left");
        }
    }

    #[test]
    fn a_flat_colour_comes_back_at_every_depth_and_size() {
        use crate::pixel::bayer::mosaic_line_deep;
        let color = Rgb::new(255, 128, 3);
        for order in BayerOrder::ALL {
            for depth in [BitDepth::Bits8, BitDepth::Bits10, BitDepth::Bits12, BitDepth::Bits14] {
                for (width, height) in [(2, 2), (3, 2), (5, 4)] {
                    let (mut window, mut line) = (vec![0u16; window(width)], vec![Rgb::default(); width]);
                    let mut filter = Bilinear::new(order, depth, &mut window, &mut line).unwrap();
                    let mut count = 0;
                    let mut sink = |line: &[Rgb]| {
                        count += 1;
                        assert!(line.iter().all(|&pixel| pixel == color), "{line:?}");
                    };
                    for y in 0..height {
                        let mut samples = vec![0; width];
                        mosaic_line_deep(&vec![color; width], &mut samples, order, y, depth).unwrap();
                        filter.push(&samples, &mut sink).unwrap();
                    }
                    filter.finish(&mut sink);
                    assert_eq!(count, height);
                }
            }
        }
    }

    #[test]
    fn bad_sizes_are_refused() {
        let (mut window, mut line) = ([0u8; 20], [Rgb::default(); 5]);
        let new = |depth, window: &mut [u8], line: &mut [Rgb]| {
            Bilinear::new(BayerOrder::Rggb, depth, window, line).map(|_| ()).unwrap_err()
        };
        assert_eq!(
            new(BitDepth::Bits8, &mut window, &mut line),
            Error::BufferLength { name: "window", expected: 21, got: 20 }
        );
        assert!(matches!(
            new(BitDepth::Bits8, &mut window, &mut line[..1]),
            Error::Parameter { name: "width", .. }
        ));
        assert!(matches!(
            new(BitDepth::Bits10, &mut window, &mut line[..4]),
            Error::Parameter { name: "depth", .. }
        ));
    }
}
