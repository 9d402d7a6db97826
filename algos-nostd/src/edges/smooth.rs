//! Smoothing before a derivative, with the fraction kept.
//!
//! ```text
//!            1 2 1                 2  4  5  4 2
//!  3 × 3:    2 4 2  / 16           4  9 12  9 4
//!            1 2 1         5 × 5:  5 12 15 12 5  / 159
//!                                  4  9 12  9 4
//!                                  2  4  5  4 2
//! ```
//!
//! The 5 × 5 kernel is the one of σ = 1.4 that came with Canny's method into the textbooks.
//!
//! A smoothed picture rounded to whole gray levels has plateaus and steps where the smooth one has a slope, and the
//! non-maximum suppression that follows stumbles over them: on photographs one edge pixel in ten moves. So these rows
//! are not divided. They stay on the kernel's own scale ([`Smoothing::SCALE`]), which leaves the ridge where it was,
//! and thresholds are brought to that scale once, when a filter is made.
//! The filters that make pictures to look at are in [`crate::filter`].
//!
//! Cost and memory: those of the filters, which these kernels share up to the last step.

use crate::filter::{Finish, gaussian3_sums, gaussian5_sums};
use crate::lines::pairs::{both, in_a_row};

/// How a picture is smoothed before it is differentiated: [`NoSmoothing`], [`Gaussian3`] or [`Gaussian5`].
pub trait Smoothing: sealed::Rows {
    /// Lines and columns that the kernel looks to either side.
    const RADIUS: usize;
    /// What a gray level counts in the smoothed row: numerator and denominator.
    const SCALE: (u32, u32);
}

pub(super) mod sealed {
    /// What the smoothings do, for this crate only.
    pub trait Rows {
        /// Smooths the centre of a window: `row(i)` is its line `i` from the top, padded by the radius at either end.
        #[doc(hidden)]
        fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], smooth: &mut [u16]);
    }
}

/// The picture as it is. A gray level counts 1.
#[derive(Clone, Copy, Debug)]
pub struct NoSmoothing;

/// Gaussian of 3 × 3 pixels. A gray level counts 16.
#[derive(Clone, Copy, Debug)]
pub struct Gaussian3;

/// Gaussian of 5 × 5 pixels, σ = 1.4. A gray level counts 159 / 8: the sum fits 16 bits, and an eighth of it leaves room
/// for the derivative's sign and weights.
#[derive(Clone, Copy, Debug)]
pub struct Gaussian5;

impl Smoothing for NoSmoothing {
    const RADIUS: usize = 0;
    const SCALE: (u32, u32) = (1, 1);
}

impl sealed::Rows for NoSmoothing {
    #[inline]
    fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], smooth: &mut [u16]) {
        for (smooth, &pixel) in smooth.iter_mut().zip(row(0)) {
            *smooth = u16::from(pixel);
        }
    }
}

impl Smoothing for Gaussian3 {
    const RADIUS: usize = 1;
    const SCALE: (u32, u32) = (16, 1);
}

impl sealed::Rows for Gaussian3 {
    #[inline]
    fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], smooth: &mut [u16]) {
        gaussian3([row(0), row(1), row(2)], smooth);
    }
}

impl Smoothing for Gaussian5 {
    const RADIUS: usize = 2;
    const SCALE: (u32, u32) = (159, 8);
}

impl sealed::Rows for Gaussian5 {
    #[inline]
    fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], smooth: &mut [u16]) {
        gaussian5([row(0), row(1), row(2), row(3), row(4)], smooth);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn gaussian3(rows: [&[u8]; 3], smooth: &mut [u16]) {
    gaussian3_sums::<Gaussian3>(rows, smooth);
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn gaussian5(rows: [&[u8]; 5], smooth: &mut [u16]) {
    gaussian5_sums::<Gaussian5>(rows, smooth);
}

impl Finish for Gaussian3 {
    type Output = u16;

    #[inline(always)]
    fn one(sum: u16) -> u16 {
        sum
    }

    #[inline(always)]
    fn four(sums: [u32; 2]) -> [u16; 4] {
        in_a_row(sums)
    }
}

impl Finish for Gaussian5 {
    type Output = u16;

    #[inline(always)]
    fn one(sum: u16) -> u16 {
        sum >> 3
    }

    #[inline(always)]
    fn four(sums: [u32; 2]) -> [u16; 4] {
        in_a_row(sums.map(|sums| sums >> 3 & both(u16::MAX >> 3)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition: the kernel over the picture with its edges replicated, here a single line of three pixels.
    fn smoothed<S: Smoothing>(line: [u8; 3]) -> [u16; 3] {
        let padded: Vec<u8> =
            (0..3 + 2 * S::RADIUS).map(|x| line[x.saturating_sub(S::RADIUS).min(2)]).collect();
        let mut smooth = [0; 3];
        S::smooth(|_| &padded, &mut smooth);
        smooth
    }

    #[test]
    fn a_flat_picture_is_its_level_on_the_scale() {
        assert_eq!(smoothed::<NoSmoothing>([255; 3]), [255; 3]);
        assert_eq!(smoothed::<Gaussian3>([255; 3]), [255 * 16; 3]);
        assert_eq!(smoothed::<Gaussian5>([255; 3]), [(255 * 159) >> 3; 3], "and the sum does not overflow");
    }

    #[test]
    fn a_pixel_spreads_by_the_kernel() {
        // Equal lines: the kernel's columns are added up, 4 8 4 and 17 38 49 38 17.
        assert_eq!(smoothed::<Gaussian3>([0, 1, 0]), [4, 8, 4]);
        assert_eq!(smoothed::<Gaussian5>([0, 8, 0]), [38, 49, 38]);
        assert_eq!(smoothed::<Gaussian5>([8, 0, 0]), [17 + 38 + 49, 17 + 38, 17]);
    }
}
