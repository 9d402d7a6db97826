//! Malvar–He–Cutler demosaic: bilinear, corrected by the gradient of the colour that is there.
//!
//! ```text
//! G at R, B (/8)       R at G of a red line (/8)    B at G of a red line      B at R, R at B (/8)
//!       -1                      ½                   the same, turned               -3/2
//!        2                  -1  .  -1                by 90°                       2   .   2
//!  -1  2 4 2 -1         -1  4  5  4  -1                                     -3/2  .   6   .  -3/2
//!        2                  -1  .  -1                                             2   .   2
//!       -1                      ½                                                  -3/2
//! ```
//!
//! **Reference.** H. S. Malvar, L. He, R. Cutler, "High-quality linear interpolation for demosaicing of Bayer-patterned
//! color images", ICASSP 2004, figure 2. No deviation but the edge, which is mirrored.
//!
//! **Rounding.** Sums are in sixteenths, rounded to the nearest sample, halves up; of deep samples the high 8 bits are
//! given. Saturates at 0 and 255.
//!
//! **Cost and memory.** About 20 additions and no multiplication but by constants a pixel; five lines of samples and one
//! of pixels, lent by the caller.

use super::window::{Both, Sample, Stencil, Wide, Window, window_samples};
use crate::image::{Error, Rgb};
use crate::lines::{LineFilter, LineSink, check_width};
use crate::pixel::BitDepth;
use crate::pixel::bayer::BayerOrder;

/// The filter.
#[derive(Debug)]
pub struct Malvar<'a, S> {
    window: Window<'a, S, 2>,
    out: &'a mut [Rgb],
}

/// Samples of lent window for lines of `width`.
#[must_use]
pub const fn window(width: usize) -> usize {
    window_samples(width, 2)
}

impl<'a, S: Sample> Malvar<'a, S> {
    /// For lines as long as `out`; `samples` holds at least [`window`] of that.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if it does not; [`Error::Parameter`] if lines are shorter than 3, or `depth` is more
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
        let lines = [-2, -1, 0, 1, 2].map(|offset| self.window.line(y, offset));
        self.window.sites(y).fill::<Corrected, S, 5>(lines, self.out, self.window.shift());
        sink.line(self.out);
    }
}

struct Corrected;

impl Stencil<5> for Corrected {
    #[inline(always)]
    fn both<W: Wide>(at: impl Fn(usize, usize) -> W, shift: u32) -> Both {
        let corners = at(1, 1) + at(1, 3) + at(3, 1) + at(3, 3);
        let (along, far_along) = (at(1, 2) + at(3, 2), at(0, 2) + at(4, 2));
        let (across, far_across) = (at(2, 1) + at(2, 3), at(2, 0) + at(2, 4));
        let (center, far) = (at(2, 2), far_along + far_across);
        let times = |factor: i8, sum: W| W::from(factor) * sum;
        let code = |sixteenths: W| ((sixteenths + W::from(8)) >> (4 + shift)).saturate();
        let here = (center >> shift).saturate();
        let green = times(8, center) + times(4, along + across) - times(2, far);
        let opposite = times(12, center) + times(4, corners) - times(3, far);
        let common = times(10, center) - times(2, corners);
        Both {
            own: [here, code(green), code(opposite)],
            green: [
                code(common + times(8, across) - times(2, far_across) + far_along),
                here,
                code(common + times(8, along) - times(2, far_along) + far_across),
            ],
        }
    }
}

impl<S: Sample> LineFilter for Malvar<'_, S> {
    type Input = S;
    type Output = Rgb;

    const LATENCY: usize = 2;

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
    use crate::pixel::bayer::mosaic_line;

    /// Through the mosaic and back, in a given order and size.
    fn there_and_back(picture: &[Rgb], width: usize, order: BayerOrder) -> Vec<Rgb> {
        let height = picture.len() / width;
        let mut mosaic = vec![0u8; picture.len()];
        for (y, (line, samples)) in picture.chunks(width).zip(mosaic.chunks_mut(width)).enumerate() {
            mosaic_line(line, samples, order, y).unwrap();
        }
        let (mut window, mut line) = (vec![0; window(width)], vec![Rgb::default(); width]);
        let mut filter = Malvar::new(order, BitDepth::Bits8, &mut window, &mut line).unwrap();
        let mut out = vec![Rgb::default(); picture.len()];
        let mosaic = Image::new(&mosaic, width, height).unwrap();
        run(&mut filter, mosaic, &mut ImageMut::new(&mut out, width, height).unwrap()).unwrap();
        out
    }

    #[test]
    fn flat_colours_and_gray_slopes_are_exact() {
        for order in BayerOrder::ALL {
            for (width, height) in [(3, 1), (3, 2), (4, 3), (9, 7)] {
                let flat = vec![Rgb::new(200, 90, 10); width * height];
                if height > 1 {
                    assert_eq!(there_and_back(&flat, width, order), flat, "{order:?} {width} × {height}");
                }
            }
            // A slope in all three channels, away from the mirrored edges.
            let slope: Vec<Rgb> = (0..11 * 9u8)
                .map(|at| {
                    let value = 20 + 8 * (at % 11) + 6 * (at / 11);
                    Rgb::new(value, value, value)
                })
                .collect();
            let back = there_and_back(&slope, 11, order);
            for y in 2..7 {
                assert_eq!(back[y * 11 + 2..y * 11 + 9], slope[y * 11 + 2..y * 11 + 9], "{order:?} line {y}");
            }
        }
    }

    #[test]
    fn bad_sizes_are_refused() {
        let (mut window, mut line) = ([0u8; 44], [Rgb::default(); 5]);
        let error = Malvar::new(BayerOrder::Rggb, BitDepth::Bits8, &mut window, &mut line).unwrap_err();
        assert_eq!(error, Error::BufferLength { name: "window", expected: 45, got: 44 });
        assert!(Malvar::new(BayerOrder::Rggb, BitDepth::Bits8, &mut window, &mut line[..2]).is_err());
    }
}
