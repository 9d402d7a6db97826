//! Gaussian smoothing of any size and σ, with weights in 1/256.
//!
//! ```text
//! rows ── weights down ──► column sums, 16 bits ── weights across ──► 24 bits ── round to nearest ──► row
//! ```
//!
//! Reference: the separable Gaussian of any textbook, e.g. R. Gonzalez and R. Woods, "Digital Image Processing", 4th
//! edition, section 3.5. Nothing is rounded between the two passes: the result is
//! `(Σ Σ wᵧ wₓ pixel + 2¹⁵) >> 16` exactly.
//!
//! The exact 24-bit sum is had in 16-bit lanes, which hold twice as many pixels a vector: a column sum is at most
//! 256 × 255, so its high and low bytes are summed apart (each at most 256 × 255 again), and
//! `(256 H + L + 2¹⁵) >> 16 = (H + (L >> 8) + 2⁷) >> 8`.
//!
//! Cost: per pixel and pair of weights 1 multiplication down and 2 across. Memory: [`Neighbourhood::memory`];
//! [`STRIP`] columns of three sums on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel, check_odd};
use super::strips::{Strips, copy_narrow};
use super::weights::{check_sigma, gaussian_weights};
use crate::image::Error;

/// Columns worked on at a time.
const STRIP: usize = 160;
/// Longest side of a kernel.
const SIZE_MAX: usize = 63;

/// A separable symmetric kernel of `SIZE × SIZE` weights in 1/256 each way, as a row kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gaussian<const SIZE: usize> {
    weights: [u16; SIZE],
}

/// [`Gaussian`] as a line filter.
pub type GaussianFilter<'m, const SIZE: usize> = Neighbourhood<'m, Gaussian<SIZE>, SIZE>;

impl Gaussian<7> {
    /// The 7 × 7 kernel with `[2 7 14 18 14 7 2] / 64` each way: σ = 1.4 in weights that are cheap to multiply by.
    pub const SEVEN: Self = Self { weights: [8, 28, 56, 72, 56, 28, 8] };
}

impl<const SIZE: usize> Gaussian<SIZE> {
    /// A bell of `sigma_milli` thousandths of a pixel, cut off at `SIZE` pixels and rounded to weights of 1/256 that
    /// sum to one. A `SIZE` of about six σ cuts nothing off.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `SIZE` is even or over 63, or σ is not 100 to 16,000 thousandths.
    pub const fn new(sigma_milli: u32) -> Result<Self, Error> {
        if SIZE > SIZE_MAX || SIZE.is_multiple_of(2) {
            return Err(Error::Parameter { name: "SIZE", got: SIZE as i64, allowed: "odd and at most 63" });
        }
        match check_sigma(sigma_milli) {
            Ok(()) => Ok(Self { weights: gaussian_weights(sigma_milli) }),
            Err(error) => Err(error),
        }
    }

    /// The weights of one direction, in 1/256.
    #[must_use]
    pub const fn weights(&self) -> &[u16; SIZE] {
        &self.weights
    }
}

impl<const SIZE: usize> RowKernel<SIZE> for Gaussian<SIZE> {
    const COLUMNS: usize = SIZE / 2;

    fn check(&self, _: usize) -> Result<(), Error> {
        check_odd("SIZE", SIZE)
    }

    fn row(&mut self, rows: [&[u8]; SIZE], made: &mut [u8]) {
        dispatched(&self.weights, rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn dispatched<const SIZE: usize>(weights: &[u16; SIZE], rows: [&[u8]; SIZE], made: &mut [u8]) {
    gaussian_row(weights, rows, made);
}

/// As many rows as the kernel has weights to one row, in line with the caller's code.
#[inline(always)]
pub(super) fn gaussian_row<const SIZE: usize>(weights: &[u16; SIZE], rows: [&[u8]; SIZE], made: &mut [u8]) {
    let lead = SIZE - 1;
    let mut columns = [0; STRIP + SIZE_MAX - 1];
    weigh_down(weights, rows.map(|row| &row[..lead]), &mut columns[..lead]);
    let mut strips = Strips::<SIZE, STRIP>::new(rows.map(|row| &row[lead..]));
    let mut last = [0; STRIP];
    for made in made.chunks_mut(STRIP) {
        weigh_down(weights, strips.next().map(|row| &row[..]), &mut columns[lead..lead + STRIP]);
        weigh_across(weights, &columns, made.first_chunk_mut().unwrap_or(&mut last));
        copy_narrow(&last, made);
        // This strip's last columns are the next one's first.
        columns.copy_within(STRIP..STRIP + lead, 0);
    }
}

/// The weighted sums of the rows' columns, in 1/256.
#[inline(always)]
fn weigh_down<const SIZE: usize>(weights: &[u16; SIZE], rows: [&[u8]; SIZE], columns: &mut [u16]) {
    let radius = SIZE / 2;
    for (sum, &pixel) in columns.iter_mut().zip(rows[radius]) {
        *sum = weights[radius] * u16::from(pixel);
    }
    for k in 0..radius {
        let weight = weights[k];
        for ((sum, &above), &below) in columns.iter_mut().zip(rows[k]).zip(rows[SIZE - 1 - k]) {
            *sum += weight * (u16::from(above) + u16::from(below));
        }
    }
}

/// The weighted sums along the columns, rounded to pixels.
#[inline(always)]
fn weigh_across<const SIZE: usize>(
    weights: &[u16; SIZE],
    columns: &[u16; STRIP + SIZE_MAX - 1],
    made: &mut [u8; STRIP],
) {
    let radius = SIZE / 2;
    // The high bytes' sum, and the low bytes'.
    let (mut high, mut low) = ([0; STRIP], [0; STRIP]);
    let centre = &columns[radius..radius + STRIP];
    for x in 0..STRIP {
        high[x] = weights[radius] * (centre[x] >> 8);
        low[x] = weights[radius] * (centre[x] & 255);
    }
    for k in 0..radius {
        let (left, right) = (&columns[k..k + STRIP], &columns[SIZE - 1 - k..SIZE - 1 - k + STRIP]);
        for x in 0..STRIP {
            high[x] += weights[k] * ((left[x] >> 8) + (right[x] >> 8));
            low[x] += weights[k] * ((left[x] & 255) + (right[x] & 255));
        }
    }
    for x in 0..STRIP {
        made[x] = ((high[x] + (low[x] >> 8) + 128) >> 8) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_stays_white() {
        let row = [255; 300 + 6];
        let mut made = [0; 300];
        for sigma_milli in [100, 1400, 9000] {
            Gaussian::<7>::new(sigma_milli).unwrap().row([&row; 7], &mut made);
            assert_eq!(made, [255; 300]);
        }
    }

    #[test]
    fn a_dot_becomes_the_bell() {
        let mut picture = [[0u8; 13]; 7];
        picture[3][6] = 255;
        let mut made = [0; 7];
        let mut kernel = Gaussian::SEVEN;
        kernel.row(picture.each_ref().map(|row| &row[..]), &mut made);
        assert_eq!(made, [2, 8, 16, 20, 16, 8, 2], "255 × 18 × [2 7 14 18 …] / 4096");
    }

    #[test]
    fn bad_parameters_say_what_is_right() {
        assert!(Gaussian::<4>::new(1000).is_err());
        assert!(Gaussian::<65>::new(1000).is_err());
        assert!(Gaussian::<5>::new(99).is_err());
        assert_eq!(
            Gaussian::<5>::new(20_000).unwrap_err(),
            Error::Parameter { name: "sigma_milli", got: 20_000, allowed: "100 to 16000" }
        );
    }
}
