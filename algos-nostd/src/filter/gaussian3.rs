//! Gaussian smoothing by the 3 × 3 binomial kernel: the cheapest that deserves the name (σ ≈ 0.85).
//!
//! ```text
//!       1 2 1        column = above + 2 centre + below
//! 1/16  2 4 2
//!       1 2 1        (column[x − 1] + 2 column[x] + column[x + 1] + 8) >> 4
//! ```
//!
//! Reference: B. Jähne, "Digital Image Processing", 6th edition, section 11.4, binomial filters. Exact; rounds to
//! nearest, halves up.
//!
//! Cost: per pixel 3 loads, 4 additions, 2 shifts and a rounding; a column's sum serves three pixels.
//! Memory: [`Neighbourhood::memory`]; [`STRIP`] column sums on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel};
use super::strips::{Strips, copy_narrow};

/// Columns worked on at a time.
const STRIP: usize = 160;

/// The 3 × 3 Gaussian kernel `[1 2 1]ᵀ [1 2 1] / 16`, as a row kernel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gaussian3;

/// [`Gaussian3`] as a line filter.
pub type Gaussian3Filter<'m> = Neighbourhood<'m, Gaussian3, 3>;

impl RowKernel<3> for Gaussian3 {
    const COLUMNS: usize = 1;

    fn row(&mut self, rows: [&[u8]; 3], made: &mut [u8]) {
        dispatched(rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2")))]
fn dispatched(rows: [&[u8]; 3], made: &mut [u8]) {
    gaussian3_row(rows, made);
}

/// Three rows to one, in line with the caller's code (and its choice of vector unit).
///
/// Pixel `x` of `made` is centred on pixel `x + 1` of `rows[1]`.
///
/// # Panics
/// If a row is shorter than `made.len() + 2`.
#[inline(always)]
pub fn gaussian3_row(rows: [&[u8]; 3], made: &mut [u8]) {
    let mut columns = [0; STRIP + 2];
    fold(rows.map(|row| row.first_chunk::<2>().unwrap_or(&[0; 2])), &mut columns, 0);
    let mut strips = Strips::<3, STRIP>::new(rows.map(|row| &row[2..]));
    let mut last = [0; STRIP];
    for made in made.chunks_mut(STRIP) {
        fold(strips.next(), &mut columns, 2);
        let strip: &mut [u8; STRIP] = made.first_chunk_mut().unwrap_or(&mut last);
        for x in 0..STRIP {
            strip[x] = ((columns[x] + 2 * columns[x + 1] + columns[x + 2] + 8) >> 4) as u8;
        }
        copy_narrow(&last, made);
        // This strip's last two columns are the next one's first.
        columns.copy_within(STRIP.., 0);
    }
}

/// The weighted sum of each column, written from column `start` on.
#[inline(always)]
fn fold<const COLUMNS: usize>(
    [above, centre, below]: [&[u8; COLUMNS]; 3],
    columns: &mut [u16; STRIP + 2],
    start: usize,
) {
    for x in 0..COLUMNS {
        columns[start + x] = u16::from(above[x]) + 2 * u16::from(centre[x]) + u16::from(below[x]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dot_becomes_the_kernel() {
        let mut picture = [[0u8; 5]; 3];
        picture[1][2] = 16;
        let mut made = [0; 3];
        Gaussian3.row(picture.each_ref().map(|row| &row[..]), &mut made);
        assert_eq!(made, [2, 4, 2]);
    }
}
