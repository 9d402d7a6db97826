//! Convolution with any kernel, and with any separable one.
//!
//! ```text
//!            w₈ w₇ w₆       the kernel is turned by half a turn: a single
//! result =   w₅ w₄ w₃       bright pixel becomes a picture of the kernel
//!            w₂ w₁ w₀
//! ```
//!
//! Reference: R. Gonzalez and R. Woods, "Digital Image Processing", 4th edition, section 3.4. Correlation (what many
//! libraries call convolution) does not turn the kernel: [`Convolution::correlation`].
//!
//! Sums are exact in 32 bits, which the constructors make sure of; the result is
//! `offset + ⌊sum / divisor + 1/2⌋`, clamped to a byte.
//!
//! Cost: a multiplication and an addition per pixel and weight that is not zero; separable, per row and column.
//! Memory: [`Neighbourhood::memory`]; [`STRIP`] sums on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel, check_odd};
use super::normalize::Scale;
use crate::image::Error;

/// Columns worked on at a time.
const STRIP: usize = 128;
/// Greatest width of a kernel.
const COLUMNS_MAX: usize = 63;

/// A kernel of `COLUMNS × LINES` weights, as a row kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Convolution<const COLUMNS: usize, const LINES: usize> {
    /// As they lie over the picture.
    weights: [[i16; COLUMNS]; LINES],
    scale: Scale,
}

/// [`Convolution`] as a line filter.
pub type ConvolutionFilter<'m, const COLUMNS: usize, const LINES: usize> =
    Neighbourhood<'m, Convolution<COLUMNS, LINES>, LINES>;

impl<const COLUMNS: usize, const LINES: usize> Convolution<COLUMNS, LINES> {
    /// Convolution with `weights`, row by row from the top left; the sum is divided by `divisor`, and `offset` is added.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a side is even, the kernel is wider than 63, the magnitudes of its weights sum to more
    /// than 2²¹, or the divisor is not 1 to 2²⁴.
    pub fn new(mut weights: [[i16; COLUMNS]; LINES], divisor: u32, offset: i16) -> Result<Self, Error> {
        weights.as_flattened_mut().reverse();
        Self::correlation(weights, divisor, offset)
    }

    /// Correlation with `weights`: as [`Convolution::new`], but the kernel is laid on the picture as it is.
    ///
    /// # Errors
    /// As [`Convolution::new`].
    pub fn correlation(weights: [[i16; COLUMNS]; LINES], divisor: u32, offset: i16) -> Result<Self, Error> {
        check_sides::<COLUMNS, LINES>()?;
        Ok(Self { scale: Scale::new(magnitude(weights.as_flattened()), divisor, offset)?, weights })
    }
}

impl<const COLUMNS: usize, const LINES: usize> RowKernel<LINES> for Convolution<COLUMNS, LINES> {
    const COLUMNS: usize = COLUMNS / 2;

    fn row(&mut self, rows: [&[u8]; LINES], made: &mut [u8]) {
        convolve(self, rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn convolve<const COLUMNS: usize, const LINES: usize>(
    kernel: &Convolution<COLUMNS, LINES>,
    rows: [&[u8]; LINES],
    made: &mut [u8],
) {
    let mut sums = [0; STRIP];
    for (index, made) in made.chunks_mut(STRIP).enumerate() {
        let sums = &mut sums[..made.len()];
        sums.fill(0);
        for (weights, row) in kernel.weights.iter().zip(rows) {
            let row = &row[index * STRIP..];
            for (x, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0) {
                for (sum, &pixel) in sums.iter_mut().zip(&row[x..]) {
                    *sum += i32::from(weight) * i32::from(pixel);
                }
            }
        }
        for (made, &sum) in made.iter_mut().zip(&*sums) {
            *made = kernel.scale.pixel(sum);
        }
    }
}

/// A kernel that is the product of a column of `LINES` weights and a row of `COLUMNS` weights, as a row kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Separable<const COLUMNS: usize, const LINES: usize> {
    across: [i16; COLUMNS],
    down: [i16; LINES],
    scale: Scale,
}

/// [`Separable`] as a line filter.
pub type SeparableFilter<'m, const COLUMNS: usize, const LINES: usize> =
    Neighbourhood<'m, Separable<COLUMNS, LINES>, LINES>;

impl<const COLUMNS: usize, const LINES: usize> Separable<COLUMNS, LINES> {
    /// Convolution with the kernel `down · across`; the sum is divided by `divisor`, and `offset` is added. Nothing is
    /// rounded between the two.
    ///
    /// # Errors
    /// As [`Convolution::new`]; the magnitudes are those of the products.
    pub fn new(
        mut across: [i16; COLUMNS],
        mut down: [i16; LINES],
        divisor: u32,
        offset: i16,
    ) -> Result<Self, Error> {
        check_sides::<COLUMNS, LINES>()?;
        let weight = magnitude(&across).saturating_mul(magnitude(&down));
        across.reverse();
        down.reverse();
        Ok(Self { scale: Scale::new(weight, divisor, offset)?, across, down })
    }
}

impl<const COLUMNS: usize, const LINES: usize> RowKernel<LINES> for Separable<COLUMNS, LINES> {
    const COLUMNS: usize = COLUMNS / 2;

    fn row(&mut self, rows: [&[u8]; LINES], made: &mut [u8]) {
        separate(self, rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn separate<const COLUMNS: usize, const LINES: usize>(
    kernel: &Separable<COLUMNS, LINES>,
    rows: [&[u8]; LINES],
    made: &mut [u8],
) {
    let (mut columns, mut sums) = ([0i32; STRIP + COLUMNS_MAX], [0; STRIP]);
    for (index, made) in made.chunks_mut(STRIP).enumerate() {
        let columns = &mut columns[..made.len() + COLUMNS - 1];
        columns.fill(0);
        for (&weight, row) in kernel.down.iter().zip(rows) {
            for (column, &pixel) in columns.iter_mut().zip(&row[index * STRIP..]) {
                *column += i32::from(weight) * i32::from(pixel);
            }
        }
        let sums = &mut sums[..made.len()];
        sums.fill(0);
        for (x, &weight) in kernel.across.iter().enumerate() {
            for (sum, &column) in sums.iter_mut().zip(&columns[x..]) {
                *sum += i32::from(weight) * column;
            }
        }
        for (made, &sum) in made.iter_mut().zip(&*sums) {
            *made = kernel.scale.pixel(sum);
        }
    }
}

fn check_sides<const COLUMNS: usize, const LINES: usize>() -> Result<(), Error> {
    check_odd("COLUMNS", COLUMNS)?;
    check_odd("LINES", LINES)?;
    if COLUMNS <= COLUMNS_MAX {
        Ok(())
    } else {
        Err(Error::Parameter { name: "COLUMNS", got: COLUMNS as i64, allowed: "at most 63" })
    }
}

fn magnitude(weights: &[i16]) -> u64 {
    weights.iter().map(|weight| u64::from(weight.unsigned_abs())).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOT: [[u8; 5]; 3] = [[0; 5], [0, 0, 10, 0, 0], [0; 5]];

    #[test]
    fn a_dot_becomes_the_kernel() {
        let mut made = [0; 3];
        let rows = DOT.each_ref().map(|row| &row[..]);
        let weights = [[0; 3], [1, 2, 3], [0; 3]];
        Convolution::new(weights, 1, 0).unwrap().row(rows, &mut made);
        assert_eq!(made, [10, 20, 30]);
        Convolution::correlation(weights, 4, 100).unwrap().row(rows, &mut made);
        assert_eq!(made, [108, 105, 103], "30 / 4 and 10 / 4 are halves, and go up");
        Separable::new([-1, 0, 1], [0, 1, 0], 1, 5).unwrap().row(rows, &mut made);
        assert_eq!(made, [0, 5, 15], "−10 + 5 is clamped");
    }

    #[test]
    fn bad_parameters_say_what_is_right() {
        assert!(Convolution::new([[1; 2]; 3], 1, 0).is_err());
        assert!(Convolution::new([[1; 3]; 2], 1, 0).is_err());
        assert!(Convolution::new([[1; 65]; 1], 1, 0).is_err());
        assert!(Convolution::new([[1; 3]; 3], 0, 0).is_err());
        assert!(Convolution::new([[i16::MIN; 9]; 9], 1, 0).is_err());
        assert!(Separable::new([i16::MIN; 3], [i16::MIN; 3], 1, 0).is_err());
    }
}
