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
//! Cost: per pixel 5 loads of bytes, 20 additions and shifts, 3 sums stored and 5 loaded, the multiply-high; without
//! vector units four pixels take five loads of a word, and additions serve two pixels at once. Memory:
//! [`Neighbourhood::memory`]; scratch of [`STRIP`] columns on the stack.

use core::ops::Add;

use super::neighbourhood::{Neighbourhood, RowKernel};
use super::strips::{Strips, copy_narrow};
use super::sums::Finish;
use crate::lines::pairs::{apart, bytes_in_a_row, even_odd, join, middle};

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

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn dispatched(rows: [&[u8]; 5], made: &mut [u8]) {
    gaussian5_sums::<Level>(rows, made);
}

/// Five rows to one, in line with the caller's code (and its choice of vector unit).
///
/// Pixel `x` of `made` is centred on pixel `x + 2` of `rows[2]`.
///
/// # Panics
/// If a row is shorter than `made.len() + 4`.
#[inline(always)]
pub fn gaussian5_row(rows: [&[u8]; 5], made: &mut [u8]) {
    gaussian5_sums::<Level>(rows, made);
}

/// What the picture's filter makes of a sum: a gray level.
struct Level;

impl Finish for Level {
    type Output = u8;

    #[inline(always)]
    fn one(sum: u16) -> u8 {
        ((sum + 79) / 159) as u8
    }

    #[inline(always)]
    fn four(sums: [u32; 2]) -> [u8; 4] {
        bytes_in_a_row(sums.map(|sums| join(apart(sums).map(|sum| u16::from(Self::one(sum))))))
    }
}

/// The kernel's sum over each pixel of a row, made into whatever is asked for; rows as for [`gaussian5_row`].
#[inline(always)]
pub(crate) fn gaussian5_sums<F: Finish>(rows: [&[u8]; 5], made: &mut [F::Output]) {
    if cfg!(feature = "std") { by_strips::<F>(rows, made) } else { by_pairs::<F>(rows, made) }
}

/// For vector units: column sums of a strip, then the strip.
#[inline(always)]
fn by_strips<F: Finish>(rows: [&[u8]; 5], made: &mut [F::Output]) {
    let mut sums = [[0; STRIP + 4]; 3];
    fold(rows.map(|row| row.first_chunk::<4>().unwrap_or(&[0; 4])), &mut sums, 0);
    let mut strips = Strips::<5, STRIP>::new(rows.map(|row| &row[4..]));
    let mut last = [F::Output::default(); STRIP];
    for made in made.chunks_mut(STRIP) {
        fold(strips.next(), &mut sums, 4);
        across::<F>(&sums, made.first_chunk_mut().unwrap_or(&mut last));
        copy_narrow(&last, made);
        // This strip's last four columns are the next one's first.
        for sums in &mut sums {
            sums.copy_within(STRIP.., 0);
        }
    }
}

/// For processors without: four pixels at a time, two in a word (see [`crate::lines::pairs`]). Each four columns are
/// folded once; what the next four add is carried over.
#[inline(always)]
fn by_pairs<F: Finish>(rows: [&[u8]; 5], made: &mut [F::Output]) {
    let fours = rows.map(|row| row.as_chunks::<4>().0);
    let mut columns = fours[0].iter().zip(fours[1]).zip(fours[2]).zip(fours[3]).zip(fours[4]).map(
        |((((&r0, &r1), &r2), &r3), &r4)| {
            let rows = [r0, r1, r2, r3, r4].map(even_odd);
            [0, 1].map(|half| folded(rows.map(|row| row[half])))
        },
    );
    let mut done = 0;
    if let Some([mut even, mut odd]) = columns.next() {
        for (made, [next_even, next_odd]) in made.as_chunks_mut::<4>().0.iter_mut().zip(columns) {
            *made = F::four([
                even[0] + next_even[0] + odd[1] + middle(odd[1], next_odd[1]) + middle(even[2], next_even[2]),
                odd[0]
                    + next_odd[0]
                    + middle(even[1], next_even[1])
                    + next_even[1]
                    + middle(odd[2], next_odd[2]),
            ]);
            (even, odd) = (next_even, next_odd);
            done += 4;
        }
    }
    let [r0, r1, r2, r3, r4] = rows.map(|row| row.array_windows::<5>().skip(done));
    let windows = r0.zip(r1).zip(r2).zip(r3).zip(r4);
    for (made, ((((r0, r1), r2), r3), r4)) in made.iter_mut().skip(done).zip(windows) {
        let [c0, c1, c2, c3, c4] =
            [0, 1, 2, 3, 4].map(|column| folded([r0, r1, r2, r3, r4].map(|row| u16::from(row[column]))));
        *made = F::one(c0[0] + c4[0] + c1[1] + c3[1] + c2[2]);
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
        let rows = [r0[x], r1[x], r2[x], r3[x], r4[x]].map(u16::from);
        [outer[start + x], inner[start + x], middle[start + x]] = folded(rows);
    }
}

/// The outer, inner and middle sum of a column, or of a pair of columns.
#[inline(always)]
fn folded<T: Copy + Add<Output = T>>([r0, r1, r2, r3, r4]: [T; 5]) -> [T; 3] {
    let (a, b, c) = (r0 + r4, r1 + r3, r2);
    // Each sum from the one before, in additions: 2 A + 4 B + 5 C, 4 A + 9 B + 12 C, 5 A + 12 B + 15 C.
    let (s, c2) = (a + b + b, c + c);
    let outer = s + s + c2 + c2 + c;
    let inner = outer + outer + c2 + b;
    [outer, inner, inner + s + b + c2 + c]
}

/// The smoothed pixels of a strip.
#[inline(always)]
fn across<F: Finish>([outer, inner, middle]: &[[u16; STRIP + 4]; 3], made: &mut [F::Output; STRIP]) {
    for x in 0..STRIP {
        made[x] = F::one(outer[x] + outer[x + 4] + inner[x + 1] + inner[x + 3] + middle[x + 2]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_ways_agree(levels in prop::collection::vec(any::<u8>(), 25..250)) {
            let padded = levels.len() / 5;
            let rows: [&[u8]; 5] = core::array::from_fn(|row| &levels[row * padded..][..padded]);
            let [mut one, mut other] = [vec![0; padded - 4], vec![0; padded - 4]];
            by_strips::<Level>(rows, &mut one);
            by_pairs::<Level>(rows, &mut other);
            prop_assert_eq!(one, other);
        }
    }

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
