//! Mean over a box of any odd size: the cheapest smoothing, the same cost whatever the size.
//!
//! ```text
//! column sums:  + row that comes in            box sum:  + column that comes in
//!               − row that has gone out                  − column that has gone out
//! ```
//!
//! Reference: M. McDonnell, "Box-Filtering Techniques", Computer Graphics and Image Processing 17, 1981. Exact:
//! `(sum + n / 2) / n` rounded down, that is to nearest (n is odd).
//!
//! Cost: per pixel 4 additions and a multiplication. Memory: [`Neighbourhood::memory`], and a 16-bit sum for each
//! column, padding included ([`Mean::columns`]).

use super::neighbourhood::{Neighbourhood, RowKernel, check_odd};
use super::reciprocal::Reciprocal;
use crate::image::Error;

/// Longest side of a box: its column sums fit in 16 bits.
const SIZE_MAX: usize = 257;

/// The mean of `SIZE × SIZE` pixels, as a row kernel.
#[derive(Debug)]
pub struct Mean<'m, const SIZE: usize> {
    columns: &'m mut [u16],
    reciprocal: Reciprocal,
    first: bool,
}

/// [`Mean`] as a line filter.
pub type MeanFilter<'m, const SIZE: usize> = Neighbourhood<'m, Mean<'m, SIZE>, SIZE>;

impl<'m, const SIZE: usize> Mean<'m, SIZE> {
    /// Column sums that the kernel needs over lines of `width` pixels.
    #[must_use]
    pub const fn columns(width: usize) -> usize {
        width.saturating_add(SIZE.saturating_sub(1))
    }

    /// A box filter over lines of `width` pixels; `columns` may be longer than [`Mean::columns`] says.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `SIZE` is even or over 257, [`Error::BufferLength`] if `columns` is too short.
    pub fn new(width: usize, columns: &'m mut [u16]) -> Result<Self, Error> {
        check_odd("SIZE", SIZE)?;
        if SIZE > SIZE_MAX {
            return Err(Error::Parameter { name: "SIZE", got: SIZE as i64, allowed: "odd and at most 257" });
        }
        let (expected, got) = (Self::columns(width), columns.len());
        let columns =
            columns.get_mut(..expected).ok_or(Error::BufferLength { name: "columns", expected, got })?;
        Ok(Self { columns, reciprocal: Reciprocal::new((SIZE * SIZE) as u32), first: true })
    }
}

impl<const SIZE: usize> RowKernel<SIZE> for Mean<'_, SIZE> {
    const COLUMNS: usize = SIZE / 2;

    fn check(&self, width: usize) -> Result<(), Error> {
        if Self::columns(width) == self.columns.len() {
            Ok(())
        } else {
            // The kernel was made for lines of another width.
            Err(Error::BufferLength {
                name: "columns",
                expected: Self::columns(width),
                got: self.columns.len(),
            })
        }
    }

    fn begin(&mut self) {
        self.first = true;
    }

    fn row(&mut self, rows: [&[u8]; SIZE], made: &mut [u8]) {
        let newest = if self.first { &rows[..] } else { &rows[SIZE - 1..] };
        if self.first {
            self.columns.fill(0);
            self.first = false;
        }
        for row in newest {
            add(self.columns, row);
        }
        mean_row::<SIZE>(self.columns, self.reciprocal, made);
        // The next window is without its oldest row.
        subtract(self.columns, rows[0]);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn add(columns: &mut [u16], row: &[u8]) {
    for (sum, &pixel) in columns.iter_mut().zip(row) {
        *sum += u16::from(pixel);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn subtract(columns: &mut [u16], row: &[u8]) {
    for (sum, &pixel) in columns.iter_mut().zip(row) {
        *sum -= u16::from(pixel);
    }
}

fn mean_row<const SIZE: usize>(columns: &[u16], reciprocal: Reciprocal, made: &mut [u8]) {
    let half = (SIZE * SIZE / 2) as u32;
    let (head, entering) = columns.split_at(SIZE - 1);
    let mut sum = half + head.iter().map(|&column| u32::from(column)).sum::<u32>();
    for ((pixel, &enters), &leaves) in made.iter_mut().zip(entering).zip(columns) {
        sum += u32::from(enters);
        *pixel = reciprocal.divide(sum) as u8;
        sum -= u32::from(leaves);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::LineFilter;

    #[test]
    fn a_dot_becomes_a_box() {
        let mut columns = [0; Mean::<3>::columns(5)];
        let mut memory = [0; MeanFilter::<3>::memory(5)];
        let mut filter =
            Neighbourhood::new(Mean::<3>::new(5, &mut columns).unwrap(), 5, &mut memory).unwrap();
        for _ in 0..2 {
            let mut seen = Vec::new();
            for y in 0..4 {
                filter
                    .push(&[0, 0, 9 * u8::from(y == 2), 0, 0], &mut |line: &[u8]| seen.push(line.to_vec()))
                    .unwrap();
            }
            filter.finish(&mut |line: &[u8]| seen.push(line.to_vec()));
            assert_eq!(seen, [[0; 5], [0, 1, 1, 1, 0], [0, 1, 1, 1, 0], [0, 1, 1, 1, 0]]);
        }
    }

    #[test]
    fn bad_parameters_say_what_is_right() {
        let mut columns = [0; 300];
        assert!(Mean::<4>::new(3, &mut columns).is_err());
        assert!(Mean::<259>::new(3, &mut columns).is_err());
        assert_eq!(
            Mean::<3>::new(300, &mut columns).unwrap_err(),
            Error::BufferLength { name: "columns", expected: 302, got: 300 }
        );
        let kernel = Mean::<3>::new(4, &mut columns).unwrap();
        let mut memory = [0; MeanFilter::<3>::memory(5)];
        assert!(Neighbourhood::new(kernel, 5, &mut memory).is_err(), "made for another width");
    }
}
