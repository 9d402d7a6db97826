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
//! Cost: the columns are weighted first (as the kernels are symmetric, a column has two or three different sums), then
//! added across. Memory: [`Smoothing::COLUMN_SUMS`] rows of `width + 2 × RADIUS` sums.

use crate::lines::shifted;

/// How a picture is smoothed before it is differentiated: [`NoSmoothing`], [`Gaussian3`] or [`Gaussian5`].
pub trait Smoothing: sealed::Rows {
    /// Lines and columns that the kernel looks to either side.
    const RADIUS: usize;
    /// What a gray level counts in the smoothed row: numerator and denominator.
    const SCALE: (u32, u32);
    /// Rows of `width + 2 × RADIUS` intermediate sums.
    const COLUMN_SUMS: usize;
}

pub(super) mod sealed {
    /// What the smoothings do, for this crate only.
    pub trait Rows {
        /// Smooths the centre of a window: `row(i)` is its line `i` from the top, of as many pixels as `smooth` has;
        /// `columns` has the length that the smoothing asks for.
        #[doc(hidden)]
        fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], columns: &mut [u16], smooth: &mut [u16]);
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
    const COLUMN_SUMS: usize = 0;
}

impl sealed::Rows for NoSmoothing {
    #[inline]
    fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], _: &mut [u16], smooth: &mut [u16]) {
        for (smooth, &pixel) in smooth.iter_mut().zip(row(0)) {
            *smooth = u16::from(pixel);
        }
    }
}

impl Smoothing for Gaussian3 {
    const RADIUS: usize = 1;
    const SCALE: (u32, u32) = (16, 1);
    const COLUMN_SUMS: usize = 1;
}

impl sealed::Rows for Gaussian3 {
    #[inline]
    fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], columns: &mut [u16], smooth: &mut [u16]) {
        gaussian3([row(0), row(1), row(2)], columns, smooth);
    }
}

impl Smoothing for Gaussian5 {
    const RADIUS: usize = 2;
    const SCALE: (u32, u32) = (159, 8);
    const COLUMN_SUMS: usize = 3;
}

impl sealed::Rows for Gaussian5 {
    #[inline]
    fn smooth<'w>(row: impl Fn(usize) -> &'w [u8], columns: &mut [u16], smooth: &mut [u16]) {
        gaussian5([row(0), row(1), row(2), row(3), row(4)], columns, smooth);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2")))]
fn gaussian3(rows: [&[u8]; 3], columns: &mut [u16], smooth: &mut [u16]) {
    let width = smooth.len();
    let columns = &mut columns[..width + 2];
    let [above, centre, below] = rows.map(|row| &row[..width]);
    for (x, sum) in columns[1..=width].iter_mut().enumerate() {
        *sum = u16::from(above[x]) + 2 * u16::from(centre[x]) + u16::from(below[x]);
    }
    replicate(columns, 1);
    let [left, middle, right] = shifted(columns, width);
    for (x, smooth) in smooth.iter_mut().enumerate() {
        *smooth = left[x] + 2 * middle[x] + right[x];
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2")))]
fn gaussian5(rows: [&[u8]; 5], columns: &mut [u16], smooth: &mut [u16]) {
    let width = smooth.len();
    let rows = rows.map(|row| &row[..width]);
    let (outer, rest) = columns.split_at_mut(width + 4);
    let (inner, rest) = rest.split_at_mut(width + 4);
    let centre = &mut rest[..width + 4];
    {
        let (outer, inner, centre) =
            (&mut outer[2..][..width], &mut inner[2..][..width], &mut centre[2..][..width]);
        let [first, second, third, fourth, fifth] = rows;
        for x in 0..width {
            let far = u16::from(first[x]) + u16::from(fifth[x]);
            let near = u16::from(second[x]) + u16::from(fourth[x]);
            let here = u16::from(third[x]);
            // 2 4 5; 4 9 12 is twice that and 0 1 2; 5 12 15 three times that less 1 0 0.
            let sum = 2 * far + 4 * near + 5 * here;
            outer[x] = sum;
            inner[x] = 2 * sum + near + 2 * here;
            centre[x] = 3 * sum - far;
        }
    }
    for sums in [&mut *outer, &mut *inner, &mut *centre] {
        replicate(sums, 2);
    }
    let ([o0, _, _, _, o4], [_, i1, _, i3, _], [_, _, c2, _, _]) =
        (shifted::<_, 5>(outer, width), shifted::<_, 5>(inner, width), shifted::<_, 5>(centre, width));
    for (x, smooth) in smooth.iter_mut().enumerate() {
        *smooth = (o0[x] + o4[x] + i1[x] + i3[x] + c2[x]) >> 3;
    }
}

/// Repeats the first and the last element into the padding.
#[inline(always)]
fn replicate(row: &mut [u16], padding: usize) {
    let end = row.len() - padding;
    let (first, last) = (row[padding], row[end - 1]);
    row[..padding].fill(first);
    row[end..].fill(last);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition: the kernel over the picture with its edges replicated, here a single line of three pixels.
    fn smoothed<S: Smoothing>(line: [u8; 3]) -> [u16; 3] {
        let mut columns = vec![0; S::COLUMN_SUMS * (3 + 2 * S::RADIUS)];
        let mut smooth = [0; 3];
        S::smooth(|_| &line, &mut columns, &mut smooth);
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
