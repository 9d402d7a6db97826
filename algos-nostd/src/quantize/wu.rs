//! Wu's palette: cut the colour cube where the variance falls most, found by moments.
//!
//! ```text
//!   ┌───────────┐    ┌─────┬─────┐    ┌─────┬─────┐     each cut is the one that lowers the sum of
//!   │  ·  ::    │    │  ·  │::   │    │  ·  │::   │     squared distances to the boxes' means most,
//!   │       ::: │ ─► │     │ ::: │ ─► │     ├─────┤     over all boxes, axes and places
//!   │ ·:        │    │ ·:  │     │    │ ·:  │:::  │
//!   └───────────┘    └─────┴─────┘    └─────┴─────┘
//! ```
//!
//! Reference: Xiaolin Wu, "Efficient Statistical Computations for Optimal Color Quantization", Graphics Gems II,
//! 1991. Cumulative moments of the histogram give count and sum of any box in eight look-ups.
//!
//! Deviation: Wu next cuts the box with the largest variance; here it is the box whose best cut gains most. That
//! needs no second moments, a third of the memory less, and is never worse for a single step of the greedy search.
//!
//! Cost: one pass over the table, then 3 × 2^BITS box sums a colour. Memory: [`Wu::moments`] of [`Moment`]
//! (16 bytes: 562 KiB at 5 bits a channel, 77 KiB at 4, 11.4 KiB at 3) and a [`Cuboid`] a colour.

use super::palette::{WeightedColor, check_colors, check_palette, lent};
use crate::image::{Error, Rgb};

/// Pixels in the corner of the cube below a grid point: their number and sum of levels.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub struct Moment {
    count: u32,
    sum: [u32; 3],
}

impl Moment {
    /// No pixels.
    pub const EMPTY: Self = Self { count: 0, sum: [0; 3] };

    // Sums over a box are differences of sums over corners; in between they may wrap, at the end they fit.
    fn plus(self, other: Self) -> Self {
        let sum = |axis: usize| self.sum[axis].wrapping_add(other.sum[axis]);
        Self { count: self.count.wrapping_add(other.count), sum: [sum(0), sum(1), sum(2)] }
    }

    fn minus(self, other: Self) -> Self {
        let sum = |axis: usize| self.sum[axis].wrapping_sub(other.sum[axis]);
        Self { count: self.count.wrapping_sub(other.count), sum: [sum(0), sum(1), sum(2)] }
    }

    /// |sum|² / count in 1/256 of a squared level; the more of it, the less variance is left.
    fn energy(self) -> u64 {
        let count = u64::from(self.count.max(1));
        let part = |sum: u32| {
            // A sum of 2^24 levels is at most 255 · 2^24: its square just fits.
            let square = u64::from(sum).pow(2);
            ((square / count) << 8) + ((square % count) << 8) / count
        };
        self.sum.map(part).iter().sum()
    }

    /// The mean, halves upwards.
    fn mean(self) -> Rgb {
        let count = u64::from(self.count.max(1));
        let [r, g, b] = self.sum.map(|sum| ((u64::from(sum) + count / 2) / count) as u8);
        Rgb { r, g, b }
    }
}

/// A box of the grid, from the grid plane `low` to the plane `high` of each axis, and its best cut.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cuboid {
    low: [u8; 3],
    high: [u8; 3],
    gain: u64,
    axis: u8,
    plane: u8,
}

impl Cuboid {
    /// A place to be filled.
    pub const EMPTY: Self = Self { low: [0; 3], high: [0; 3], gain: 0, axis: 0, plane: 0 };
}

/// Makes palettes on a grid of 2^`BITS` (1 to 6) cells a channel.
#[derive(Debug)]
pub struct Wu<'a, const BITS: u32> {
    moments: &'a mut [Moment],
    cuboids: &'a mut [Cuboid],
}

impl<'a, const BITS: u32> Wu<'a, BITS> {
    const SIDE: usize = (1 << BITS) + 1;

    /// Moments needed: the grid points of the cube.
    #[must_use]
    pub const fn moments() -> usize {
        const { assert!(BITS >= 1 && BITS <= 6, "the grid has 1 to 6 bits a channel") };
        Self::SIDE * Self::SIDE * Self::SIDE
    }

    /// Lent memory: [`Wu::moments`] and as many cuboids as palettes will have colours.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if `moments` is too short.
    pub fn new(moments: &'a mut [Moment], cuboids: &'a mut [Cuboid]) -> Result<Self, Error> {
        Ok(Self { moments: lent("moments", moments, Self::moments())?, cuboids })
    }

    /// Writes a palette of up to `palette.len()` colours, and says how many: fewer where the grid tells fewer apart.
    ///
    /// # Errors
    /// If the palette's length is not 1 to 256, there are fewer cuboids than that, or the colours stand for no
    /// pixel or too many.
    pub fn palette(&mut self, colors: &[WeightedColor], palette: &mut [Rgb]) -> Result<usize, Error> {
        check_palette(palette)?;
        check_colors(colors)?;
        lent("cuboids", self.cuboids, palette.len())?;
        self.accumulate(colors);
        let whole = Cuboid { high: [(Self::SIDE - 1) as u8; 3], ..Cuboid::EMPTY };
        let mut made = 0;
        self.place(made, whole);
        made += 1;
        while made < palette.len() {
            // The first of equals, so that the result hangs on nothing but the colours.
            let candidates = self.cuboids.iter().copied().enumerate().take(made);
            let best = candidates.reduce(|best, next| if next.1.gain > best.1.gain { next } else { best });
            let Some((index, cuboid)) = best.filter(|(_, cuboid)| cuboid.gain > 0) else { break };
            let (mut first, mut second) = (cuboid, cuboid);
            first.high[usize::from(cuboid.axis)] = cuboid.plane;
            second.low[usize::from(cuboid.axis)] = cuboid.plane;
            self.place(index, first);
            self.place(made, second);
            made += 1;
        }
        for (color, cuboid) in palette.iter_mut().zip(self.cuboids.iter()).take(made) {
            *color = self.sum(cuboid.low, cuboid.high).mean();
        }
        Ok(made)
    }

    /// Fills the table with cumulative moments.
    fn accumulate(&mut self, colors: &[WeightedColor]) {
        let side = Self::SIDE;
        self.moments.fill(Moment::EMPTY);
        for color in colors {
            let [r, g, b] = color.quarters().map(|level| (usize::from(level) >> (10 - BITS)) + 1);
            let moment = &mut self.moments[(r * side + g) * side + b];
            moment.count += color.count();
            for (sum, level) in moment.sum.iter_mut().zip(color.quarters()) {
                *sum += ((u64::from(color.count()) * u64::from(level) + 2) / 4) as u32;
            }
        }
        for plane in 1..side {
            for row in 1..side {
                let start = (plane * side + row) * side;
                let (before, line) = self.moments.split_at_mut(start);
                let mut sum = Moment::EMPTY;
                for (moment, above) in line[..side].iter_mut().zip(&before[start - side..]) {
                    sum = sum.plus(*moment);
                    *moment = sum.plus(*above);
                }
            }
            let start = plane * side * side;
            let (before, slice) = self.moments.split_at_mut(start);
            for (moment, behind) in slice[..side * side].iter_mut().zip(&before[start - side * side..]) {
                *moment = moment.plus(*behind);
            }
        }
    }

    fn at(&self, r: u8, g: u8, b: u8) -> Moment {
        self.moments[(usize::from(r) * Self::SIDE + usize::from(g)) * Self::SIDE + usize::from(b)]
    }

    /// Pixels between two grid points, by inclusion and exclusion of corners.
    fn sum(&self, low: [u8; 3], high: [u8; 3]) -> Moment {
        let face = |r: u8| {
            let outer = self.at(r, high[1], high[2]).plus(self.at(r, low[1], low[2]));
            outer.minus(self.at(r, high[1], low[2])).minus(self.at(r, low[1], high[2]))
        };
        face(high[0]).minus(face(low[0]))
    }

    /// Finds the best cut of a cuboid and stores it.
    fn place(&mut self, index: usize, mut cuboid: Cuboid) {
        let whole = self.sum(cuboid.low, cuboid.high);
        let energy = whole.energy();
        cuboid.gain = 0;
        for axis in 0..3 {
            for plane in cuboid.low[axis] + 1..cuboid.high[axis] {
                let mut high = cuboid.high;
                high[axis] = plane;
                let first = self.sum(cuboid.low, high);
                let second = whole.minus(first);
                if first.count == 0 {
                    continue;
                }
                if second.count == 0 {
                    break;
                }
                let gain = (first.energy() + second.energy()).saturating_sub(energy);
                if gain > cuboid.gain {
                    (cuboid.gain, cuboid.axis, cuboid.plane) = (gain, axis as u8, plane);
                }
            }
        }
        if let Some(place) = self.cuboids.get_mut(index) {
            *place = cuboid;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(level: u8, count: u32) -> WeightedColor {
        WeightedColor::new(Rgb { r: level, g: level, b: level }, count)
    }

    #[test]
    fn the_first_cut_parts_the_two_heaps() {
        let mut moments = [Moment::EMPTY; Wu::<3>::moments()];
        let mut cuboids = [Cuboid::EMPTY; 4];
        let mut wu = Wu::<3>::new(&mut moments, &mut cuboids).unwrap();
        let colors = [gray(0, 10), gray(40, 10), gray(200, 1), gray(250, 1)];
        let mut palette = [Rgb::default(); 4];
        assert_eq!(wu.palette(&colors, &mut palette[..2]), Ok(2));
        assert_eq!(palette[..2], [20, 225].map(|level| gray(level, 0).rounded()));
        assert_eq!(wu.palette(&colors, &mut palette), Ok(4));
        assert_eq!(wu.palette(&colors[..1], &mut palette), Ok(1), "no more colours than there are");
    }

    #[test]
    fn full_tables_do_not_overflow() {
        let mut moments = [Moment::EMPTY; Wu::<2>::moments()];
        let mut cuboids = [Cuboid::EMPTY; 2];
        let mut wu = Wu::<2>::new(&mut moments, &mut cuboids).unwrap();
        let mut palette = [Rgb::default(); 2];
        let colors = [gray(255, (1 << 24) - 1), gray(0, 1)];
        assert_eq!(wu.palette(&colors, &mut palette), Ok(2));
        assert_eq!(palette, [gray(0, 0).rounded(), gray(255, 0).rounded()]);
    }

    #[test]
    fn bad_parameters_are_refused() {
        let mut cuboids = [Cuboid::EMPTY; 1];
        assert!(Wu::<2>::new(&mut [Moment::EMPTY; 124], &mut cuboids).is_err());
        let mut moments = [Moment::EMPTY; Wu::<2>::moments()];
        let mut wu = Wu::<2>::new(&mut moments, &mut cuboids).unwrap();
        let color = [gray(1, 1)];
        assert!(wu.palette(&color, &mut []).is_err());
        assert!(wu.palette(&[], &mut [Rgb::default()]).is_err());
        assert_eq!(
            wu.palette(&color, &mut [Rgb::default(); 2]),
            Err(Error::BufferLength { name: "cuboids", expected: 2, got: 1 })
        );
    }
}
