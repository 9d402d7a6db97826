//! Median of 3 × 3: takes salt and pepper away and leaves edges where they are.
//!
//! ```text
//! column by column              row by row                 the median of
//! lo mid hi of 3 rows           max of the three lo ─┐
//!                               med of the three mid ├───► these three
//!                               min of the three hi ─┘
//! ```
//!
//! Reference: J. L. Smith, "Implementing Median Filters in XC4000E FPGAs", Xilinx XCELL 23, 1996. Every exchange is a
//! minimum and a maximum of bytes, with no branch, so a vector unit does a register full of pixels at a time. We sort
//! each column anew for each of the three pixels that need it: that beats storing and reloading it.
//!
//! Cost: per pixel 28 minima and maxima, 9 loads. Memory: [`Neighbourhood::memory`].

use super::neighbourhood::{Neighbourhood, RowKernel};
use crate::lines::shifted;

/// The median of 3 × 3 pixels, as a row kernel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Median3;

/// [`Median3`] as a line filter.
pub type Median3Filter<'m> = Neighbourhood<'m, Median3, 3>;

impl RowKernel<3> for Median3 {
    const COLUMNS: usize = 1;

    fn row(&mut self, rows: [&[u8]; 3], made: &mut [u8]) {
        median3_row(rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn median3_row(rows: [&[u8]; 3], made: &mut [u8]) {
    let width = made.len();
    let [Some(a), Some(b), Some(c)]: [Option<[&[u8]; 3]>; 3] = rows.map(|row| shifted(row, width)) else {
        return; // rows are as wide as they must be
    };
    for x in 0..width {
        let [l0, m0, h0] = sort3(a[0][x], b[0][x], c[0][x]);
        let [l1, m1, h1] = sort3(a[1][x], b[1][x], c[1][x]);
        let [l2, m2, h2] = sort3(a[2][x], b[2][x], c[2][x]);
        made[x] = median_of_3(l0.max(l1).max(l2), median_of_3(m0, m1, m2), h0.min(h1).min(h2));
    }
}

#[inline(always)]
fn sort3(a: u8, b: u8, c: u8) -> [u8; 3] {
    let (least, most) = (a.min(b), a.max(b));
    [least.min(c), least.max(most.min(c)), most.max(c)]
}

#[inline(always)]
fn median_of_3(a: u8, b: u8, c: u8) -> u8 {
    a.min(b).max(a.max(b).min(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_has_its_middle() {
        // A comparison network that sorts every input of zeros and ones sorts every input (the 0-1 principle).
        for bits in 0u32..512 {
            let picture: [[u8; 3]; 3] =
                core::array::from_fn(|y| core::array::from_fn(|x| (bits >> (3 * y + x) & 1) as u8));
            let mut made = [9];
            median3_row(picture.each_ref().map(|row| &row[..]), &mut made);
            assert_eq!(u32::from(made[0]), u32::from(bits.count_ones() >= 5), "{bits:09b}");
        }
    }
}
