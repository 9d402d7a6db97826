//! Median of 5 × 5: for noise in blots, at four times the price of 3 × 3.
//!
//! ```text
//! sort each column           then across five columns            leaves, of the 25,
//! rank 0 of x−2 … x+2        its two greatest                     2
//! rank 1                     its three greatest                   3    the median
//! rank 2                     its three middle ones                3    of these 13
//! rank 3                     its three least                      3
//! rank 4                     its two least                        2
//! ```
//!
//! Reference: D. Knuth, "The Art of Computer Programming", volume 3, section 5.3.4 (comparison networks, the 0-1
//! principle), and N. Devillard, "Fast median search: an ANSI C implementation", 1998. In a square whose rows and
//! columns are sorted an element with more than twelve others surely above, or below, it is not the median: twelve of
//! 25 go. The network below was found by pruning, at random, exchanges that no sorted columns need; the test proves it
//! for all of them by the 0-1 principle.
//!
//! Cost: per pixel 18 minima and maxima for a column and 86 across, no branch. Memory: [`Neighbourhood::memory`];
//! [`STRIP`] sorted columns on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel};
use super::strips::{Strips, copy_narrow};

/// Columns sorted at a time.
const STRIP: usize = 160;

/// The median of 5 × 5 pixels, as a row kernel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Median5;

/// [`Median5`] as a line filter.
pub type Median5Filter<'m> = Neighbourhood<'m, Median5, 5>;

impl RowKernel<5> for Median5 {
    const COLUMNS: usize = 2;

    fn row(&mut self, rows: [&[u8]; 5], made: &mut [u8]) {
        median5_row(rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn median5_row(rows: [&[u8]; 5], made: &mut [u8]) {
    let mut ranks = [[0; STRIP + 4]; 5];
    sort_columns(rows.map(|row| row.first_chunk::<4>().unwrap_or(&[0; 4])), &mut ranks, 0);
    let mut strips = Strips::<5, STRIP>::new(rows.map(|row| &row[4..]));
    let mut last = [0; STRIP];
    for made in made.chunks_mut(STRIP) {
        sort_columns(strips.next(), &mut ranks, 4);
        across(&ranks, made.first_chunk_mut().unwrap_or(&mut last));
        copy_narrow(&last, made);
        // This strip's last four columns are the next one's first.
        for rank in &mut ranks {
            rank.copy_within(STRIP.., 0);
        }
    }
}

/// Sorts each column of five pixels, the least to rank 0, written from column `start` on.
#[inline(always)]
fn sort_columns<const COLUMNS: usize>(
    [r0, r1, r2, r3, r4]: [&[u8; COLUMNS]; 5],
    [s0, s1, s2, s3, s4]: &mut [[u8; STRIP + 4]; 5],
    start: usize,
) {
    for x in 0..COLUMNS {
        let mut w = [r0[x], r1[x], r2[x], r3[x], r4[x]];
        exchange(&mut w, 0, 3);
        exchange(&mut w, 1, 4);
        exchange(&mut w, 0, 2);
        exchange(&mut w, 1, 3);
        exchange(&mut w, 0, 1);
        exchange(&mut w, 2, 4);
        exchange(&mut w, 1, 2);
        exchange(&mut w, 3, 4);
        exchange(&mut w, 2, 3);
        let at = start + x;
        [s0[at], s1[at], s2[at], s3[at], s4[at]] = w;
    }
}

/// The medians of a strip of sorted columns.
#[inline(always)]
fn across([r0, r1, r2, r3, r4]: &[[u8; STRIP + 4]; 5], made: &mut [u8; STRIP]) {
    for x in 0..STRIP {
        made[x] = median_of_sorted_columns([
            [r0[x], r0[x + 1], r0[x + 2], r0[x + 3], r0[x + 4]],
            [r1[x], r1[x + 1], r1[x + 2], r1[x + 3], r1[x + 4]],
            [r2[x], r2[x + 1], r2[x + 2], r2[x + 3], r2[x + 4]],
            [r3[x], r3[x + 1], r3[x + 2], r3[x + 3], r3[x + 4]],
            [r4[x], r4[x + 1], r4[x + 2], r4[x + 3], r4[x + 4]],
        ]);
    }
}

/// Puts the lesser of two elements first.
#[inline(always)]
fn exchange<const N: usize>(w: &mut [u8; N], a: usize, b: usize) {
    (w[a], w[b]) = (w[a].min(w[b]), w[a].max(w[b]));
}

/// The median of 25, given as five ranks of five sorted columns.
#[inline(always)]
fn median_of_sorted_columns(ranks: [[u8; 5]; 5]) -> u8 {
    let [mut r0, mut r1, mut r2, mut r3, mut r4] = ranks;
    // Rank 0: the two greatest of the least.
    exchange(&mut r0, 0, 4);
    exchange(&mut r0, 1, 3);
    exchange(&mut r0, 0, 2);
    exchange(&mut r0, 2, 4);
    exchange(&mut r0, 2, 3);
    exchange(&mut r0, 1, 4);
    exchange(&mut r0, 3, 4);
    // Rank 1: the three greatest.
    exchange(&mut r1, 0, 3);
    exchange(&mut r1, 0, 2);
    exchange(&mut r1, 1, 3);
    exchange(&mut r1, 0, 1);
    exchange(&mut r1, 2, 4);
    exchange(&mut r1, 1, 2);
    exchange(&mut r1, 3, 4);
    exchange(&mut r1, 2, 3);
    // Rank 2: the three middle ones.
    exchange(&mut r2, 0, 4);
    exchange(&mut r2, 1, 3);
    exchange(&mut r2, 0, 2);
    exchange(&mut r2, 2, 4);
    exchange(&mut r2, 0, 1);
    exchange(&mut r2, 2, 3);
    exchange(&mut r2, 1, 2);
    exchange(&mut r2, 3, 4);
    // Rank 3: the three least.
    exchange(&mut r3, 0, 3);
    exchange(&mut r3, 1, 4);
    exchange(&mut r3, 0, 2);
    exchange(&mut r3, 1, 3);
    exchange(&mut r3, 0, 1);
    exchange(&mut r3, 2, 4);
    exchange(&mut r3, 1, 2);
    exchange(&mut r3, 2, 3);
    // Rank 4: the two least of the greatest.
    exchange(&mut r4, 0, 1);
    exchange(&mut r4, 3, 4);
    exchange(&mut r4, 2, 4);
    exchange(&mut r4, 2, 3);
    exchange(&mut r4, 0, 3);
    exchange(&mut r4, 1, 2);
    // Their median.
    let mut w = [r0[3], r0[4], r1[2], r1[3], r1[4], r2[1], r2[2], r2[3], r3[0], r3[1], r3[2], r4[0], r4[1]];
    exchange(&mut w, 2, 9);
    exchange(&mut w, 1, 5);
    exchange(&mut w, 5, 9);
    exchange(&mut w, 4, 9);
    exchange(&mut w, 8, 3);
    exchange(&mut w, 7, 6);
    exchange(&mut w, 5, 3);
    exchange(&mut w, 6, 3);
    exchange(&mut w, 7, 12);
    exchange(&mut w, 7, 5);
    exchange(&mut w, 4, 12);
    exchange(&mut w, 6, 10);
    exchange(&mut w, 5, 0);
    exchange(&mut w, 4, 6);
    exchange(&mut w, 6, 0);
    exchange(&mut w, 4, 11);
    exchange(&mut w, 4, 6);
    exchange(&mut w, 6, 11);
    w[6]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_has_its_middle() {
        // By the 0-1 principle it is enough to try zeros and ones, and columns come sorted: 6⁵ cases.
        for case in 0..6usize.pow(5) {
            let ones: [usize; 5] = core::array::from_fn(|x| case / 6usize.pow(x as u32) % 6);
            let ranks = core::array::from_fn(|rank| ones.map(|ones| u8::from(rank + ones >= 5)));
            let expected = u8::from(ones.iter().sum::<usize>() >= 13);
            assert_eq!(median_of_sorted_columns(ranks), expected, "{ones:?}");
        }
    }

    #[test]
    fn columns_come_out_sorted() {
        for case in 0..32u8 {
            let column: [[u8; 1]; 5] = core::array::from_fn(|y| [case >> y & 1]);
            let mut ranks = [[0; STRIP + 4]; 5];
            sort_columns(column.each_ref(), &mut ranks, 7);
            let sorted = ranks.map(|rank| rank[7]);
            assert!(sorted.is_sorted(), "{case:05b}");
            assert_eq!(sorted.iter().sum::<u8>(), case.count_ones() as u8);
        }
    }
}
