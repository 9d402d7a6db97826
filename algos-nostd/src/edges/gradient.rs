//! Gradients: how fast, and which way, a picture brightens.
//!
//! ```text
//!           central     Prewitt     Sobel       Scharr        Roberts
//!           · · ·      -1 · 1      -1 · 1      -3 ·  3       -1 ·    · -1
//!      x   -1 · 1      -1 · 1      -2 · 2     -10 · 10        · 1    1  ·
//!           · · ·      -1 · 1      -1 · 1      -3 ·  3        (x)    (y)
//! ```
//!
//! and `y` the same, turned downwards. Reference: R. Gonzalez and R. Woods, "Digital Image Processing", 10.2; the weights
//! 3 10 3 are Scharr's, of the least error in direction (H. Scharr, dissertation, Heidelberg 2000).
//!
//! [`GradientFilter`] runs an [`Operator`] over the lines and gives what a [`super::Measure`] makes of the two components:
//! the pair itself, a magnitude, a direction. The components are exact, not divided by the kernel's weight
//! ([`Operator::SLOPE`]). Beyond its edges the picture is replicated.
//!
//! Memory: three lines, and one of results. Cost: one pass; each pixel of the result is made in registers.

use core::marker::PhantomData;

use super::measure::Measure;
use crate::image::Error;
use crate::lines::{LineFilter, LineSink, Reach, Window, shifted};

/// A gradient: `x` to the right, `y` downwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gradient {
    /// Rise from left to right.
    pub x: i16,
    /// Rise from top to bottom.
    pub y: i16,
}

/// A pair of kernels of at most 3 × 3 pixels.
pub trait Operator {
    /// What a slope of one gray level a pixel gives.
    const SLOPE: i16;

    /// The gradient in the middle of three rows of three pixels.
    fn gradient(rows: [[i16; 3]; 3]) -> Gradient;
}

/// The neighbour after less the neighbour before.
#[derive(Clone, Copy, Debug)]
pub struct CentralDifference;

/// Roberts' cross, of 2 × 2 pixels: `x` is the rise to the lower right neighbour, `y` from the right neighbour to the lower
/// one. Its axes are the diagonals: directions are turned by 45°.
#[derive(Clone, Copy, Debug)]
pub struct Roberts;

/// Differences averaged over three lines.
#[derive(Clone, Copy, Debug)]
pub struct Prewitt;

/// Differences averaged 1 2 1.
#[derive(Clone, Copy, Debug)]
pub struct Sobel;

/// Differences averaged 3 10 3, for the best direction.
#[derive(Clone, Copy, Debug)]
pub struct Scharr;

impl Operator for CentralDifference {
    const SLOPE: i16 = 2;

    #[inline(always)]
    fn gradient([[_, b, _], [d, _, f], [_, h, _]]: [[i16; 3]; 3]) -> Gradient {
        Gradient { x: f - d, y: h - b }
    }
}

impl Operator for Roberts {
    const SLOPE: i16 = 1;

    #[inline(always)]
    fn gradient([_, [_, e, f], [_, h, i]]: [[i16; 3]; 3]) -> Gradient {
        Gradient { x: i - e, y: h - f }
    }
}

impl Operator for Prewitt {
    const SLOPE: i16 = 6;

    #[inline(always)]
    fn gradient(rows: [[i16; 3]; 3]) -> Gradient {
        weighted(rows, 1, 1)
    }
}

impl Operator for Sobel {
    const SLOPE: i16 = 8;

    #[inline(always)]
    fn gradient(rows: [[i16; 3]; 3]) -> Gradient {
        weighted(rows, 1, 2)
    }
}

impl Operator for Scharr {
    const SLOPE: i16 = 32;

    #[inline(always)]
    fn gradient(rows: [[i16; 3]; 3]) -> Gradient {
        weighted(rows, 3, 10)
    }
}

/// Differences across, weighted `side centre side` along. The two diagonals are shared by both components.
#[inline(always)]
fn weighted([[a, b, c], [d, _, f], [g, h, i]]: [[i16; 3]; 3], side: i16, centre: i16) -> Gradient {
    let (falling, rising) = (i - a, c - g);
    Gradient {
        x: side * (falling + rising) + centre * (f - d),
        y: side * (falling - rising) + centre * (h - b),
    }
}

/// The gradient of a gray picture, line by line, as a [`Measure`] tells it.
#[derive(Debug)]
pub struct GradientFilter<'m, O, M: Measure> {
    window: Window<'m, u8>,
    line: &'m mut [M::Output],
    operator: PhantomData<O>,
}

impl<'m, O: Operator, M: Measure> GradientFilter<'m, O, M> {
    const REACH: Reach = Reach::square(1);

    /// Bytes of memory that the filter takes for lines of `width` pixels, beside a line of its results.
    #[must_use]
    pub const fn memory(width: usize) -> usize {
        Window::<u8>::memory(width, Self::REACH)
    }

    /// A filter for lines of `width` pixels. `memory` and `line` may be longer than [`GradientFilter::memory`] and
    /// `width`; the rest is not used.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if `width` is zero, [`Error::BufferLength`] if `memory` or `line` is too short.
    pub fn new(width: usize, memory: &'m mut [u8], line: &'m mut [M::Output]) -> Result<Self, Error> {
        let window = Window::new(width, Self::REACH, memory)?;
        let got = line.len();
        let line = line.get_mut(..width).ok_or(Error::BufferLength { name: "line", expected: width, got })?;
        Ok(Self { window, line, operator: PhantomData })
    }

    fn make(&mut self, sink: &mut impl LineSink<M::Output>) {
        differentiate::<O, M>(self.window.rows(), self.line);
        sink.line(self.line);
    }
}

impl<O: Operator, M: Measure> LineFilter for GradientFilter<'_, O, M> {
    type Input = u8;
    type Output = M::Output;

    const LATENCY: usize = 1;

    fn push(&mut self, line: &[u8], sink: &mut impl LineSink<M::Output>) -> Result<(), Error> {
        if self.window.push(line)? {
            self.make(sink);
        }
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<M::Output>) {
        while self.window.drain() {
            self.make(sink);
        }
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn differentiate<O: Operator, M: Measure>(rows: [&[u8]; 3], line: &mut [M::Output]) {
    let width = line.len();
    let [above, centre, below] = rows;
    let (Some([a, b, c]), Some([d, e, f]), Some([g, h, i])) =
        (shifted::<u8, 3>(above, width), shifted::<u8, 3>(centre, width), shifted::<u8, 3>(below, width))
    else {
        return; // rows are as wide as they must be
    };
    for (x, result) in line.iter_mut().enumerate() {
        let gradient = O::gradient([
            [i16::from(a[x]), i16::from(b[x]), i16::from(c[x])],
            [i16::from(d[x]), i16::from(e[x]), i16::from(f[x])],
            [i16::from(g[x]), i16::from(h[x]), i16::from(i[x])],
        ]);
        *result = M::measure(gradient);
    }
}

#[cfg(test)]
mod tests {
    use super::super::measure::{Components, L1};
    use super::*;

    fn gradients<O: Operator>(picture: &[[u8; 3]]) -> Vec<[(i16, i16); 3]> {
        let mut memory = [0; GradientFilter::<Sobel, Components>::memory(3)];
        let mut line = [Gradient::default(); 3];
        let mut filter = GradientFilter::<O, Components>::new(3, &mut memory, &mut line).unwrap();
        let mut made = Vec::new();
        let mut sink = |line: &[Gradient]| made.push(core::array::from_fn(|x| (line[x].x, line[x].y)));
        for row in picture {
            filter.push(row, &mut sink).unwrap();
        }
        filter.finish(&mut sink);
        made
    }

    fn slope<O: Operator>() {
        // Two a column, three a line.
        let made = gradients::<O>(&[[0, 2, 4], [3, 5, 7], [6, 8, 10]]);
        assert_eq!(made[1][1], (2 * O::SLOPE, 3 * O::SLOPE));
        assert_eq!(made[0][0], (O::SLOPE, 3 * O::SLOPE / 2), "half of it sees the replicated edge");
    }

    #[test]
    fn a_slope_counts_as_it_says() {
        slope::<CentralDifference>();
        slope::<Prewitt>();
        slope::<Sobel>();
        slope::<Scharr>();
        let made = gradients::<Roberts>(&[[0, 2, 4], [3, 5, 7], [6, 8, 10]]);
        assert_eq!(made[1][1], (5, 1), "along the diagonals");
    }

    #[test]
    fn the_steepest_step_fits() {
        let made = gradients::<Scharr>(&[[0, 0, 255], [0, 0, 255], [0, 0, 255]]);
        assert_eq!(made, [[(0, 0), (4080, 0), (4080, 0)]; 3]);
        assert_eq!(gradients::<Sobel>(&[[255, 0, 0]]), [[(-1020, 0), (-1020, 0), (0, 0)]]);
    }

    #[test]
    fn short_memory_is_refused() {
        let refused = |width, memory: &mut [u8], line: &mut [u16]| {
            GradientFilter::<Sobel, L1>::new(width, memory, line).unwrap_err()
        };
        let length = |name, expected, got| Error::BufferLength { name, expected, got };
        assert_eq!(refused(2, &mut [0; 11], &mut [0; 2]), length("memory", 24, 11));
        assert_eq!(refused(2, &mut [0; 24], &mut [0; 1]), length("line", 2, 1));
        assert!(matches!(refused(0, &mut [], &mut []), Error::ZeroSize { .. }));
    }
}
