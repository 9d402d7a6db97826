//! Gaussian smoothing by the 5 × 5 integer kernel for σ = 1.4: the one that textbooks put before Canny.
//!
//! ```text
//!        2  4  5  4  2        A = row 0 + row 4         outer = 2 A +  4 B +  5 C
//!        4  9 12  9  4        B = row 1 + row 3         inner = 4 A +  9 B + 12 C
//! 1/159  5 12 15 12  5        C = row 2                 middle = 5 A + 12 B + 15 C
//!        4  9 12  9  4
//!        2  4  5  4  2        sum[x] = outer[x ± 2] + inner[x ± 1] + middle[x]
//! ```
//!
//! Reference: J. Canny, "A Computational Approach to Edge Detection", PAMI 8 (6), 1986, for the smoothing; the integer
//! kernel is the one found in lecture notes and in most descriptions of the detector.
//!
//! The kernel is not separable (its rank is three), but it is symmetric, so three different row kernels on folded rows
//! give the exact sum. It is at most 159 × 255 = 40,545 and stays in 16-bit lanes throughout; the division by 159 is a
//! multiply-high that the compiler makes of `(sum + 79) / 159`: 52,759 / 2²³ is exact for every such sum, as the test
//! shows. Rounds to nearest (there are no halves: 159 is odd).
//!
//! Cost: per pixel 5 loads of bytes, 20 additions and shifts, 3 sums stored and 5 loaded, the multiply-high. Memory:
//! [`Neighbourhood::memory`]; scratch of [`STRIP`] columns on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel};
use super::strips::{Strips, copy_narrow};

/// Columns worked on at a time: their folded sums stay in the first-level cache, and on the stack.
const STRIP: usize = 160;

/// The 5 × 5 Gaussian kernel 1/159 for σ = 1.4, as a row kernel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gaussian5;

/// [`Gaussian5`] as a line filter.
pub type Gaussian5Filter<'m> = Neighbourhood<'m, Gaussian5, 5>;

impl RowKernel<5> for Gaussian5 {
    const COLUMNS: usize = 2;

    fn row(&mut self, rows: [&[u8]; 5], made: &mut [u8]) {
        dispatched(rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2")))]
fn dispatched(rows: [&[u8]; 5], made: &mut [u8]) {
    gaussian5_row(rows, made);
}

/// Five rows to one, in line with the caller's code (and its choice of vector unit).
///
/// Pixel `x` of `made` is centred on pixel `x + 2` of `rows[2]`.
///
/// # Panics
/// If a row is shorter than `made.len() + 4`.
#[inline(always)]
pub fn gaussian5_row(rows: [&[u8]; 5], made: &mut [u8]) {
    let mut sums = [[0; STRIP + 4]; 3];
    fold(rows.map(|row| row.first_chunk::<4>().unwrap_or(&[0; 4])), &mut sums, 0);
    let mut strips = Strips::<5, STRIP>::new(rows.map(|row| &row[4..]));
    let mut last = [0; STRIP];
    for made in made.chunks_mut(STRIP) {
        fold(strips.next(), &mut sums, 4);
        across(&sums, made.first_chunk_mut().unwrap_or(&mut last));
        copy_narrow(&last, made);
        // This strip's last four columns are the next one's first.
        for sums in &mut sums {
            sums.copy_within(STRIP.., 0);
        }
    }
}

/// The outer, inner and middle row sums of each column, written from column `start` on.
#[inline(always)]
fn fold<const COLUMNS: usize>(
    [r0, r1, r2, r3, r4]: [&[u8; COLUMNS]; 5],
    [outer, inner, middle]: &mut [[u16; STRIP + 4]; 3],
    start: usize,
) {
    for x in 0..COLUMNS {
        let a = u16::from(r0[x]) + u16::from(r4[x]);
        let b = u16::from(r1[x]) + u16::from(r3[x]);
        let c = u16::from(r2[x]);
        // Each sum from the one before, in additions: 2 A + 4 B + 5 C, 4 A + 9 B + 12 C, 5 A + 12 B + 15 C.
        let (s, c2) = (a + 2 * b, c + c);
        outer[start + x] = 2 * s + 2 * c2 + c;
        inner[start + x] = 2 * outer[start + x] + c2 + b;
        middle[start + x] = inner[start + x] + s + b + c2 + c;
    }
}

/// The smoothed pixels of a strip.
#[inline(always)]
fn across([outer, inner, middle]: &[[u16; STRIP + 4]; 3], made: &mut [u8; STRIP]) {
    for x in 0..STRIP {
        let sum = outer[x] + outer[x + 4] + inner[x + 1] + inner[x + 3] + middle[x + 2];
        made[x] = ((sum + 79) / 159) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_multiplication_is_the_division_for_every_sum() {
        for sum in 0u64..=159 * 255 + 79 {
            assert_eq!((sum * 52_759) >> 23, sum / 159, "{sum}");
        }
    }

    #[test]
    fn a_dot_becomes_the_kernel() {
        let mut picture = [[0u8; 9]; 5];
        picture[2][4] = 159;
        let mut made = [0; 5];
        Gaussian5.row(picture.each_ref().map(|row| &row[..]), &mut made);
        assert_eq!(made, [5, 12, 15, 12, 5]);
    }
}
