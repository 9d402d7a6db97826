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
//! Cost: per pixel 3 loads, 4 additions, 2 shifts and a rounding; a column's sum serves three pixels. Without vector units
//! four pixels take three loads of a word, and additions serve two pixels at once.
//! Memory: [`Neighbourhood::memory`]; [`STRIP`] column sums on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel};
use super::strips::{Strips, copy_narrow};
use super::sums::Finish;
use crate::lines::pairs::{both, bytes_in_a_row, even_odd, middle};

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

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn dispatched(rows: [&[u8]; 3], made: &mut [u8]) {
    gaussian3_sums::<Level>(rows, made);
}

/// Three rows to one, in line with the caller's code (and its choice of vector unit).
///
/// Pixel `x` of `made` is centred on pixel `x + 1` of `rows[1]`.
///
/// # Panics
/// If a row is shorter than `made.len() + 2`.
#[inline(always)]
pub fn gaussian3_row(rows: [&[u8]; 3], made: &mut [u8]) {
    gaussian3_sums::<Level>(rows, made);
}

/// What the picture's filter makes of a sum: a gray level.
struct Level;

impl Finish for Level {
    type Output = u8;

    #[inline(always)]
    fn one(sum: u16) -> u8 {
        ((sum + 8) >> 4) as u8
    }

    #[inline(always)]
    fn four(sums: [u32; 2]) -> [u8; 4] {
        bytes_in_a_row(sums.map(|sum| (sum + both(8)) >> 4 & both(0xFF)))
    }
}

/// The kernel's sum over each pixel of a row, made into whatever is asked for; rows as for [`gaussian3_row`].
#[inline(always)]
pub(crate) fn gaussian3_sums<F: Finish>(rows: [&[u8]; 3], made: &mut [F::Output]) {
    if cfg!(feature = "std") { by_strips::<F>(rows, made) } else { by_pairs::<F>(rows, made) }
}

/// For vector units: column sums of a strip, then the strip.
#[inline(always)]
fn by_strips<F: Finish>(rows: [&[u8]; 3], made: &mut [F::Output]) {
    let mut columns = [0; STRIP + 2];
    fold_columns(rows.map(|row| row.first_chunk::<2>().unwrap_or(&[0; 2])), &mut columns, 0);
    let mut strips = Strips::<3, STRIP>::new(rows.map(|row| &row[2..]));
    let mut last = [F::Output::default(); STRIP];
    for made in made.chunks_mut(STRIP) {
        fold_columns(strips.next(), &mut columns, 2);
        let strip: &mut [F::Output; STRIP] = made.first_chunk_mut().unwrap_or(&mut last);
        for x in 0..STRIP {
            strip[x] = F::one(columns[x] + 2 * columns[x + 1] + columns[x + 2]);
        }
        copy_narrow(&last, made);
        // This strip's last two columns are the next one's first.
        columns.copy_within(STRIP.., 0);
    }
}

/// For processors without: four pixels at a time, two in a word (see [`crate::lines::pairs`]). Each four columns are
/// weighted once; what the next four add is carried over in registers.
#[inline(always)]
fn by_pairs<F: Finish>(rows: [&[u8]; 3], made: &mut [F::Output]) {
    let fours = rows.map(|row| row.as_chunks::<4>().0);
    let mut columns = fours[0].iter().zip(fours[1]).zip(fours[2]).map(|((&above, &centre), &below)| {
        let (above, centre, below) = (even_odd(above), even_odd(centre), even_odd(below));
        [0, 1].map(|half| fold([above, centre, below].map(|row| row[half])))
    });
    let mut done = 0;
    if let Some([mut even, mut odd]) = columns.next() {
        for (made, [next_even, next_odd]) in made.as_chunks_mut::<4>().0.iter_mut().zip(columns) {
            let (second, third) = (middle(even, next_even), middle(odd, next_odd));
            *made = F::four([fold([even, odd, second]), fold([odd, second, third])]);
            (even, odd) = (next_even, next_odd);
            done += 4;
        }
    }
    let [above, centre, below] = rows.map(|row| row.array_windows::<3>().skip(done));
    for (((made, above), centre), below) in made.iter_mut().skip(done).zip(above).zip(centre).zip(below) {
        let columns = [0, 1, 2].map(|column| fold([above, centre, below].map(|row| u32::from(row[column]))));
        *made = F::one(fold(columns) as u16);
    }
}

/// 1 2 1, of values or of pairs.
#[inline(always)]
fn fold([first, centre, last]: [u32; 3]) -> u32 {
    first + 2 * centre + last
}

/// The weighted sum of each column, written from column `start` on.
#[inline(always)]
fn fold_columns<const COLUMNS: usize>(
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
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_ways_agree(levels in prop::collection::vec(any::<u8>(), 9..150)) {
            let padded = levels.len() / 3;
            let rows: [&[u8]; 3] = core::array::from_fn(|row| &levels[row * padded..][..padded]);
            let [mut one, mut other] = [vec![0; padded - 2], vec![0; padded - 2]];
            by_strips::<Level>(rows, &mut one);
            by_pairs::<Level>(rows, &mut other);
            prop_assert_eq!(one, other);
        }
    }

    #[test]
    fn a_dot_becomes_the_kernel() {
        let mut picture = [[0u8; 5]; 3];
        picture[1][2] = 16;
        let mut made = [0; 3];
        Gaussian3.row(picture.each_ref().map(|row| &row[..]), &mut made);
        assert_eq!(made, [2, 4, 2]);
    }
}
