//! The line part of Canny: smooth, differentiate, suppress and classify, in one pass with a handful of rows.
//!
//! ```text
//!  line y ─► bytes ──► smooth ──► gradient ──► crests ─► Marks of line y − LATENCY
//!            2r + 1     3 rows     2 rows, and           32 pixels a word:
//!            rows                  magnitudes 3          candidates and strong
//! ```
//!
//! Reference: J. Canny, IEEE PAMI 8(6), 1986; Sobel's operator for the gradient, as is usual. The picture is replicated
//! beyond its edges for smoothing and gradient. What follows, hysteresis, can't be bounded to a window of lines:
//! [`super::grow`] does it on whole maps of bits, and [`super::canny`] joins the two.
//!
//! Where we deviate from the usual: smoothed rows keep their fraction (see [`super::smooth`]); L2 magnitudes are compared
//! as squares, thresholds squared once, so there is no root and no rounding.
//!
//! Memory: [`CannyLines::memory`], at 640 pixels 20 KB with the 5 × 5 kernel. Nothing is kept of the frame.

use core::marker::PhantomData;

use super::bits::{PIXELS_A_WORD, words_a_line};
use super::carve::{carve, words_of};
use super::smooth::Smoothing;
use super::suppress::{Crest, Marks, suppress};
use crate::image::Error;
use crate::lines::pairs::{SIGN, both, join, middle, signed, split};
use crate::lines::{LineFilter, LineSink, Reach, Window, shifted};

/// How a gradient's two components make one magnitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    /// `|gx| + |gy|`
    L1,
    /// `√(gx² + gy²)`
    L2,
}

/// What makes an edge: thresholds on the magnitude of Sobel's gradient (a step of one gray level counts 4), and how
/// the magnitude is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Thresholds {
    /// A candidate's magnitude exceeds this.
    pub low: u16,
    /// A strong pixel's magnitude exceeds this.
    pub high: u16,
    /// How the magnitude is taken.
    pub norm: Norm,
}

impl Thresholds {
    /// # Errors
    /// If `low` is above `high`.
    pub(super) fn check(self) -> Result<(), Error> {
        if self.low > self.high {
            return Err(Error::Parameter { name: "low", got: self.low.into(), allowed: "at most `high`" });
        }
        Ok(())
    }

    /// A threshold on the scale of the magnitudes kept: the whole part, for magnitudes are whole numbers.
    fn scaled(self, threshold: u16, (numerator, denominator): (u32, u32)) -> u32 {
        let (threshold, numerator, denominator) =
            (u64::from(threshold), u64::from(numerator), u64::from(denominator));
        let scaled = match self.norm {
            Norm::L1 => threshold * numerator / denominator,
            Norm::L2 => (threshold * numerator).pow(2) / denominator.pow(2),
        };
        u32::try_from(scaled).unwrap_or(u32::MAX)
    }
}

/// Canny without hysteresis, a line at a time: gray lines of 8 bits in, [`Marks`] out, `width / 32` rounded up a line.
#[derive(Debug)]
pub struct CannyLines<'m, S> {
    width: usize,
    norm: Norm,
    low: u32,
    high: u32,
    source: Window<'m, u8>,
    smooth: Window<'m, u16>,
    ridge: Ridge<'m>,
    marks: &'m mut [Marks],
    smoothing: PhantomData<S>,
}

/// Rows of gradients and magnitudes, which rotate: the newest takes the place of the oldest.
#[derive(Debug)]
struct Ridge<'m> {
    magnitudes: [&'m mut [u32]; 3],
    x: [&'m mut [i16]; 2],
    y: [&'m mut [i16]; 2],
    /// Whether the newest row belongs to this frame.
    started: bool,
}

impl<'m, S: Smoothing> CannyLines<'m, S> {
    const SOURCE: Reach = Reach::square(S::RADIUS);
    const SMOOTH: Reach = Reach { columns: 1, lines: 1 };

    /// Words of memory that the filter takes for lines of `width` pixels.
    #[must_use]
    pub const fn memory(width: usize) -> usize {
        let words = words_a_line(width);
        let pixels = words.saturating_mul(PIXELS_A_WORD);
        let parts = [
            words_of(Window::<u8>::memory(width, Self::SOURCE), 1),
            words_of(Window::<u16>::memory(width, Self::SMOOTH), 2),
            pixels.saturating_add(2).saturating_mul(3),
            words_of(pixels, 2).saturating_mul(4),
            words.saturating_mul(2),
        ];
        let (mut sum, mut part) = (0usize, 0);
        while part < parts.len() {
            sum = sum.saturating_add(parts[part]);
            part += 1;
        }
        sum
    }

    /// A filter for lines of `width` pixels; `memory` may be longer than [`CannyLines::memory`], the rest is not used.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if `width` is zero, [`Error::Parameter`] if `low` is above `high`, [`Error::BufferLength`] if
    /// `memory` is too short.
    pub fn new(width: usize, thresholds: Thresholds, memory: &'m mut [u32]) -> Result<Self, Error> {
        thresholds.check()?;
        if width == 0 {
            return Err(Error::ZeroSize { width, height: 1 });
        }
        let (expected, got) = (Self::memory(width), memory.len());
        let short = Error::BufferLength { name: "memory", expected, got };
        if got < expected {
            return Err(short);
        }
        let mut rest = memory;
        let pixels = words_a_line(width) * PIXELS_A_WORD;
        let source = carve(&mut rest, Window::<u8>::memory(width, Self::SOURCE)).ok_or(short)?;
        let smooth = carve(&mut rest, Window::<u16>::memory(width, Self::SMOOTH)).ok_or(short)?;
        let mut magnitudes = || carve(&mut rest, pixels + 2).ok_or(short);
        let magnitudes = [magnitudes()?, magnitudes()?, magnitudes()?];
        let mut gradients = || carve(&mut rest, pixels).ok_or(short);
        let (x, y) = ([gradients()?, gradients()?], [gradients()?, gradients()?]);
        let marks = carve(&mut rest, words_a_line(width)).ok_or(short)?;
        let mut ridge = Ridge { magnitudes, x, y, started: false };
        ridge.clear();
        Ok(Self {
            width,
            norm: thresholds.norm,
            low: thresholds.scaled(thresholds.low, S::SCALE),
            high: thresholds.scaled(thresholds.high, S::SCALE),
            source: Window::new(width, Self::SOURCE, source)?,
            smooth: Window::new(width, Self::SMOOTH, smooth)?,
            ridge,
            marks,
            smoothing: PhantomData,
        })
    }

    /// A line has been smoothed as far as its window allows: the window's centre moves down.
    fn smooth_line(&mut self, sink: &mut impl LineSink<Marks>) {
        let source = &self.source;
        if self.smooth.push_with(|row| S::smooth(|i| source.row(i), row)) {
            self.differentiate_line(sink);
        }
    }

    fn differentiate_line(&mut self, sink: &mut impl LineSink<Marks>) {
        let started = self.ridge.started;
        let (x, y, magnitudes) = self.ridge.next_row();
        let magnitudes = magnitudes.get_mut(1..=self.width).unwrap_or_default();
        let gradient = Gradients { x, y, magnitudes };
        match self.norm {
            Norm::L1 => sobel_l1(self.smooth.rows(), gradient),
            Norm::L2 => sobel_l2(self.smooth.rows(), gradient),
        }
        if started {
            self.suppress_line(sink);
        }
    }

    /// The row of the ridge before the newest has both its neighbours.
    fn suppress_line(&mut self, sink: &mut impl LineSink<Marks>) {
        let [above, here, below] = self.ridge.magnitudes.each_ref();
        let (x, y) = (&self.ridge.x[0], &self.ridge.y[0]);
        suppress(&Crest { above, here, below, x, y, low: self.low, high: self.high }, self.marks);
        sink.line(self.marks);
    }
}

impl Ridge<'_> {
    fn clear(&mut self) {
        self.magnitudes.iter_mut().for_each(|row| row.fill(0));
        self.started = false;
    }

    /// Makes room for the next row: its gradients, and its magnitudes with their padding.
    fn next_row(&mut self) -> (&mut [i16], &mut [i16], &mut [u32]) {
        self.magnitudes.rotate_left(1);
        self.x.swap(0, 1);
        self.y.swap(0, 1);
        self.started = true;
        (self.x[1], self.y[1], self.magnitudes[2])
    }
}

impl<S: Smoothing> LineFilter for CannyLines<'_, S> {
    type Input = u8;
    type Output = Marks;

    const LATENCY: usize = S::RADIUS + 2;

    fn push(&mut self, line: &[u8], sink: &mut impl LineSink<Marks>) -> Result<(), Error> {
        if self.source.push(line)? {
            self.smooth_line(sink);
        }
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<Marks>) {
        while self.source.drain() {
            self.smooth_line(sink);
        }
        while self.smooth.drain() {
            self.differentiate_line(sink);
        }
        if self.ridge.started {
            self.ridge.next_row().2.fill(0);
            self.suppress_line(sink);
            self.ridge.clear();
        }
    }
}

/// Where a row of gradients goes.
struct Gradients<'a> {
    x: &'a mut [i16],
    y: &'a mut [i16],
    magnitudes: &'a mut [u32],
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn sobel_l1(rows: [&[u16]; 3], gradients: Gradients<'_>) {
    let magnitude = |x: i16, y: i16| u32::from(x.unsigned_abs()) + u32::from(y.unsigned_abs());
    if cfg!(feature = "std") {
        sobel(rows, gradients, magnitude);
    } else {
        sobel_pairs(rows, gradients, magnitude);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn sobel_l2(rows: [&[u16]; 3], gradients: Gradients<'_>) {
    let magnitude = |x: i16, y: i16| {
        let (x, y) = (i32::from(x), i32::from(y));
        (x * x + y * y) as u32
    };
    if cfg!(feature = "std") {
        sobel(rows, gradients, magnitude);
    } else {
        sobel_pairs(rows, gradients, magnitude);
    }
}

/// Sobel's gradient of padded rows, every pixel by itself: for vector units. The smoothed levels are at most 5,068, so four of them fit 16 bits with a sign.
#[inline(always)]
fn sobel(rows: [&[u16]; 3], gradients: Gradients<'_>, magnitude: impl Fn(i16, i16) -> u32) {
    let Gradients { x: x_row, y: y_row, magnitudes } = gradients;
    let width = magnitudes.len();
    let [Some([a, b, c]), Some([d, _, f]), Some([g, h, i])] = rows.map(|row| shifted::<u16, 3>(row, width))
    else {
        return; // rows are as wide as they must be
    };
    let (Some(x_row), Some(y_row)) = (x_row.get_mut(..width), y_row.get_mut(..width)) else { return };
    for column in 0..width {
        let at = |row: &[u16]| row[column] as i16;
        let (left_above, right_above, left_below, right_below) = (at(a), at(c), at(g), at(i));
        // The two diagonals are shared by x and y.
        let (falling, rising) = (right_below - left_above, right_above - left_below);
        let x = falling + rising + 2 * (at(f) - at(d));
        let y = falling - rising + 2 * (at(h) - at(b));
        x_row[column] = x;
        y_row[column] = y;
        magnitudes[column] = magnitude(x, y);
    }
}

/// The same for a processor without vector units, two pixels in a word (see [`crate::lines::pairs`]): each pair of columns is
/// weighted once and used for two pairs of pixels.
///
/// Differences are kept above zero by an offset, so that no lane borrows from the other: [`RISE`] is more than a
/// smoothed level, and four of them and of the highest rise stay below 2¹⁶.
#[inline(always)]
fn sobel_pairs(rows: [&[u16]; 3], gradients: Gradients<'_>, magnitude: impl Fn(i16, i16) -> u32) {
    let Gradients { x: x_row, y: y_row, magnitudes } = gradients;
    let width = magnitudes.len();
    let [above, centre, below] = rows.map(|row| row.as_chunks::<2>().0);
    let mut columns = above.iter().zip(centre).zip(below).map(|((&above, &centre), &below)| {
        let (above, centre, below) = (join(above), join(centre), join(below));
        (above + 2 * centre + below, below + both(RISE) - above)
    });
    let (x_pairs, y_pairs) = (x_row.as_chunks_mut::<2>().0, y_row.as_chunks_mut::<2>().0);
    let (pairs, odd) = magnitudes.as_chunks_mut::<2>();
    if let Some((mut left_sum, mut left_rise)) = columns.next() {
        for (((x_place, y_place), place), (right_sum, right_rise)) in
            x_pairs.iter_mut().zip(y_pairs).zip(pairs).zip(columns)
        {
            let x = split(signed(right_sum + both(SIGN) - left_sum));
            let middle_rise = middle(left_rise, right_rise);
            let y = split(signed(left_rise + 2 * middle_rise + right_rise + both(SIGN - 4 * RISE)));
            (*x_place, *y_place) = (x, y);
            *place = [magnitude(x[0], y[0]), magnitude(x[1], y[1])];
            (left_sum, left_rise) = (right_sum, right_rise);
        }
    }
    if let Some(place) = odd.first_mut() {
        // The last pixel of an odd width, by itself.
        let last = width - 1;
        if let (Some(x), Some(y)) = (x_row.get_mut(last..), y_row.get_mut(last..)) {
            let gradients = Gradients { x, y, magnitudes: core::slice::from_mut(place) };
            sobel(rows.map(|row| row.get(last..).unwrap_or_default()), gradients, magnitude);
        }
    }
}

/// See [`sobel_pairs`].
const RISE: u16 = 5120;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_ways_to_the_gradient_agree(levels in prop::collection::vec(0u16..=5068, 9..120)) {
            let padded = levels.len() / 3;
            let rows: [&[u16]; 3] = core::array::from_fn(|row| &levels[row * padded..][..padded]);
            let made = |pairs: bool| {
                let (mut x, mut y, mut magnitudes) = (vec![0; padded + 5], vec![0; padded + 5], vec![0; padded - 2]);
                let gradients = Gradients { x: &mut x, y: &mut y, magnitudes: &mut magnitudes };
                let magnitude = |x: i16, y: i16| u32::from(x.unsigned_abs()) * 7 + u32::from(y.unsigned_abs());
                if pairs { sobel_pairs(rows, gradients, magnitude) } else { sobel(rows, gradients, magnitude) }
                (x, y, magnitudes)
            };
            prop_assert_eq!(made(true), made(false));
        }
    }

    #[test]
    fn latency_is_what_it_says() {
        use super::super::smooth::{Gaussian5, NoSmoothing};
        fn lines_out<S: Smoothing>(lines: usize) -> usize {
            let thresholds = Thresholds { low: 1, high: 2, norm: Norm::L1 };
            let mut memory = vec![0; CannyLines::<S>::memory(40)];
            let mut filter = CannyLines::<S>::new(40, thresholds, &mut memory).unwrap();
            let mut made = 0;
            for _ in 0..lines {
                filter.push(&[9; 40], &mut |line: &[Marks]| made += line.len() / 2).unwrap();
            }
            made
        }
        assert_eq!(lines_out::<NoSmoothing>(2), 0);
        assert_eq!(lines_out::<NoSmoothing>(CannyLines::<NoSmoothing>::LATENCY + 1), 1);
        assert_eq!(lines_out::<Gaussian5>(4), 0);
        assert_eq!(lines_out::<Gaussian5>(CannyLines::<Gaussian5>::LATENCY + 1), 1);
    }
}
