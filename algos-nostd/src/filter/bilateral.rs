//! Bilateral smoothing: a Gaussian that counts a neighbour the less, the more its value differs; edges stay.
//!
//! ```text
//!     ·           weight = e^(−distance² / 2 σ_space²) · e^(−difference² / 2 σ_range²)
//!   · · ·
//! · · ► · ·       result = Σ weight · value / Σ weight, over the disc of diameter SIZE
//!   · · ·
//!     ·
//! ```
//!
//! Reference: C. Tomasi and R. Manduchi, "Bilateral Filtering for Gray and Color Images", ICCV 1998. The disc is that
//! of OpenCV's `bilateralFilter`. Weights are rounded to 2⁻¹⁶; sums are exact; the quotient is rounded to nearest.
//!
//! A table, made at set-up, holds for each distance and each signed difference the weight in its upper half and weight
//! times difference in its lower half: one look-up and one addition carry both sums. The table is entered at
//! `255 − centre`, so the neighbour's value alone is the index: no subtraction, no sign, no bounds check.
//!
//! Cost: per pixel and neighbour 2 loads and an addition; per pixel one 32-bit division, done in vectors on a host. Memory:
//! [`Neighbourhood::memory`], and the table: [`Bilateral::table`] entries of 8 bytes (for 5 × 5: 12 KB); a strip of
//! [`STRIP`] columns on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel};
use super::weights::{exp_negative, gaussian_exponent};
use crate::image::Error;

/// Greatest diameter: sums of more neighbours would not fit in 32 bits.
const SIZE_MAX: usize = 11;
/// Distances in a disc of that diameter, without zero.
const PARTS_MAX: usize = 13;
/// Signed differences of two bytes.
const DIFFERENCES: usize = 511;

/// Columns worked on at a time.
const STRIP: usize = 64;

/// Bilateral smoothing over a disc of diameter `SIZE`, as a row kernel.
#[derive(Debug)]
pub struct Bilateral<'m, const SIZE: usize> {
    table: &'m [[u64; DIFFERENCES]],
}

/// [`Bilateral`] as a line filter.
pub type BilateralFilter<'m, const SIZE: usize> = Neighbourhood<'m, Bilateral<'m, SIZE>, SIZE>;

impl<'m, const SIZE: usize> Bilateral<'m, SIZE> {
    /// For each place of the disc's square, which part of the table it uses; `usize::MAX` for the centre and outside
    /// the disc.
    const PARTS: [[usize; SIZE]; SIZE] = parts().0;
    /// Parts of the table: distances in the disc.
    const PARTS_COUNT: usize = parts::<SIZE>().1;

    /// Entries of the table.
    #[must_use]
    pub const fn table() -> usize {
        Self::PARTS_COUNT * DIFFERENCES
    }

    /// Fills the table for `σ_space` in thousandths of a pixel and `σ_range` in thousandths of a gray level.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `SIZE` is even, 1 or over 11, or a σ is not 1 to 1,000,000;
    /// [`Error::BufferLength`] if `table` is shorter than [`Bilateral::table`].
    pub fn new(sigma_space_milli: u32, sigma_range_milli: u32, table: &'m mut [u64]) -> Result<Self, Error> {
        check_size::<SIZE>()?;
        check_sigma("sigma_space_milli", sigma_space_milli)?;
        check_sigma("sigma_range_milli", sigma_range_milli)?;
        let (expected, got) = (Self::table(), table.len());
        let table = table.get_mut(..expected).ok_or(Error::BufferLength { name: "table", expected, got })?;
        let (table, _) = table.as_chunks_mut::<DIFFERENCES>();
        for (y, places) in Self::PARTS.iter().enumerate() {
            for (x, &part) in places.iter().enumerate() {
                let Some(part) = table.get_mut(part) else { continue };
                let distance = gaussian_exponent(distance_squared::<SIZE>(x, y), sigma_space_milli);
                for (index, entry) in part.iter_mut().enumerate() {
                    let difference = index as i64 - 255;
                    let range = gaussian_exponent((difference * difference) as u32, sigma_range_milli);
                    let weight = (exp_negative(distance.saturating_add(range)) + (1 << 15)) >> 16;
                    *entry = (weight << 32).wrapping_add_signed(weight as i64 * difference);
                }
            }
        }
        Ok(Self { table })
    }
}

impl<const SIZE: usize> RowKernel<SIZE> for Bilateral<'_, SIZE> {
    const COLUMNS: usize = SIZE / 2;

    fn check(&self, _: usize) -> Result<(), Error> {
        check_size::<SIZE>()
    }

    fn row(&mut self, rows: [&[u8]; SIZE], made: &mut [u8]) {
        // Sums first and quotients after: the division then is one loop over a strip. The sum's halves are stored apart:
        // a loop that reads 64 bits is given half as many lanes.
        let table = core::array::from_fn(|part| self.table.get(part).unwrap_or(&[0; DIFFERENCES]));
        let mut strip = [[0; STRIP + SIZE_MAX - 1]; SIZE];
        let (mut weights, mut differences) = ([0; STRIP], [0; STRIP]);
        for (index, made) in made.chunks_mut(STRIP).enumerate() {
            // Rows of a fixed length have no bounds to check.
            for (strip, row) in strip.iter_mut().zip(rows) {
                let width = made.len() + SIZE - 1;
                strip[..width].copy_from_slice(&row[index * STRIP..][..width]);
            }
            for (x, (weight, difference)) in
                weights.iter_mut().zip(&mut differences).enumerate().take(made.len())
            {
                let sum = Self::sum(&table, &strip, x);
                (*weight, *difference) = ((sum >> 32) as u32, sum as u32);
            }
            let centres = strip[SIZE / 2][SIZE / 2..].first_chunk().unwrap_or(&[0; STRIP]);
            let mut quotients = [0; STRIP];
            divide(&weights, &differences, centres, &mut quotients);
            made.copy_from_slice(&quotients[..made.len()]);
        }
    }
}

impl<const SIZE: usize> Bilateral<'_, SIZE> {
    /// Both sums for the pixel in column `x` of a strip: of weights, and of weights times differences.
    #[inline(always)]
    fn sum(
        table: &[&[u64; DIFFERENCES]; PARTS_MAX],
        rows: &[[u8; STRIP + SIZE_MAX - 1]; SIZE],
        x: usize,
    ) -> u64 {
        let start = usize::from(255 - rows[SIZE / 2][x + SIZE / 2]);
        // The centre itself, with a weight of one and no difference.
        let mut sum = 1u64 << 48;
        for dy in 0..SIZE {
            for dx in 0..SIZE {
                if let Some(part) = table.get(Self::PARTS[dy][dx]) {
                    sum = sum.wrapping_add(part[start + usize::from(rows[dy][x + dx])]);
                }
            }
        }
        sum
    }
}

/// The centres plus the mean differences, rounded to nearest.
///
/// A vector unit has no integer division, so where there is one the quotient's eight bits are found one by one, by
/// comparison, many pixels at a time; elsewhere the processor's own division is shorter. The quotients are the same.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn divide(weights: &[u32; STRIP], differences: &[u32; STRIP], centres: &[u8; STRIP], made: &mut [u8; STRIP]) {
    for x in 0..STRIP {
        let difference = differences[x];
        // A negative lower half has borrowed one from the upper.
        let weight = weights[x].wrapping_add(difference >> 31);
        // The sum of weights times values, which is not negative and below 2³¹.
        let value = difference.wrapping_add(weight.wrapping_mul(u32::from(centres[x])));
        let value = value.wrapping_add(weight / 2);
        made[x] = if cfg!(feature = "std") {
            divide_by_bits(value, weight.max(1))
        } else {
            (value / weight.max(1)) as u8
        };
    }
}

/// `value / weight`, rounded down, for quotients of a byte and weights of 1 to 2²³.
///
/// Long division: the rest moves up, the divisor comes off where it fits, and a one is left in the place that the move
/// made free. The lesser of both rests is the right one: where the divisor does not fit, taking it off wraps round. (It
/// would not if the rest were the divisor less one; but that is odd, and the rest was just doubled.)
#[inline(always)]
fn divide_by_bits(value: u32, weight: u32) -> u8 {
    let less_one = (weight << 8) - 1;
    let mut rest = value;
    for _ in 0..8 {
        rest <<= 1;
        rest = rest.min(rest.wrapping_sub(less_one));
    }
    rest as u8
}

const fn distance_squared<const SIZE: usize>(x: usize, y: usize) -> u32 {
    let (dx, dy) = (x.abs_diff(SIZE / 2), y.abs_diff(SIZE / 2));
    (dx * dx + dy * dy) as u32
}

/// For each place which part of the table, equal distances sharing one; and how many parts there are.
const fn parts<const SIZE: usize>() -> ([[usize; SIZE]; SIZE], usize) {
    let mut places = [[usize::MAX; SIZE]; SIZE];
    let (mut count, mut squared) = (0, 1);
    while squared <= (SIZE / 2) * (SIZE / 2) {
        let mut used = false;
        let mut place = 0;
        while place < SIZE * SIZE {
            let (x, y) = (place % SIZE, place / SIZE);
            if distance_squared::<SIZE>(x, y) as usize == squared {
                places[y][x] = count;
                used = true;
            }
            place += 1;
        }
        count += used as usize;
        squared += 1;
    }
    (places, count)
}

fn check_size<const SIZE: usize>() -> Result<(), Error> {
    if SIZE % 2 == 1 && SIZE > 1 && SIZE <= SIZE_MAX {
        Ok(())
    } else {
        Err(Error::Parameter { name: "SIZE", got: SIZE as i64, allowed: "odd, from 3 to 11" })
    }
}

fn check_sigma(name: &'static str, sigma_milli: u32) -> Result<(), Error> {
    if (1..=1_000_000).contains(&sigma_milli) {
        Ok(())
    } else {
        Err(Error::Parameter { name, got: i64::from(sigma_milli), allowed: "1 to 1000000" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_distances_share_a_part() {
        let out = usize::MAX;
        assert_eq!(
            Bilateral::<5>::PARTS,
            [
                [out, out, 2, out, out],
                [out, 1, 0, 1, out],
                [2, 0, out, 0, 2],
                [out, 1, 0, 1, out],
                [out, out, 2, out, out]
            ]
        );
        assert_eq!(Bilateral::<5>::table(), 3 * 511);
        assert_eq!(Bilateral::<11>::table(), PARTS_MAX * 511);
    }

    #[test]
    fn both_divisions_agree() {
        for weight in (1..82 * 65_536).step_by(7_919) {
            for quotient in [0, 1, 2, 127, 128, 254, 255] {
                for value in
                    [quotient * weight, quotient * weight + weight / 2, quotient * weight + weight - 1]
                {
                    assert_eq!(u32::from(divide_by_bits(value, weight)), value / weight);
                }
            }
        }
    }

    #[test]
    fn an_edge_stays_and_noise_goes() {
        let mut table = vec![0; Bilateral::<5>::table()];
        let mut kernel = Bilateral::<5>::new(2000, 10_000, &mut table).unwrap();
        let row = [50, 52, 50, 52, 50, 52, 200, 202, 200, 202, 200, 202];
        let mut made = [0; 8];
        kernel.row([&row; 5], &mut made);
        assert_eq!(made, [51, 51, 51, 51, 201, 201, 201, 201]);
    }

    #[test]
    fn bad_parameters_say_what_is_right() {
        let mut table = [0; 10_000];
        assert!(Bilateral::<4>::new(1000, 1000, &mut table).is_err());
        assert!(Bilateral::<1>::new(1000, 1000, &mut table).is_err());
        assert!(Bilateral::<13>::new(1000, 1000, &mut table).is_err());
        assert!(Bilateral::<5>::new(0, 1000, &mut table).is_err());
        assert_eq!(
            Bilateral::<5>::new(1000, 1000, &mut table[..9]).unwrap_err(),
            Error::BufferLength { name: "table", expected: 1533, got: 9 }
        );
    }
}
