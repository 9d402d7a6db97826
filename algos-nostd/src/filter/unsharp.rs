//! Unsharp mask: adds back what smoothing took away.
//!
//! ```text
//! value ──┬───────────────────────────────► + ─► result
//!         └─ Gaussian ─► value − smooth ─► × amount, if beyond the threshold
//! ```
//!
//! Reference: R. Gonzalez and R. Woods, "Digital Image Processing", 4th edition, section 3.6, unsharp masking. As in
//! Pillow and GIMP, differences up to the threshold are left alone, which spares noise in flat areas. Exact:
//! `value + (amount · (value − smooth) + 32) >> 6`, halves up, clamped to a byte.
//!
//! Cost: that of the Gaussian and 8 operations a pixel, in the same pass. Memory: [`Neighbourhood::memory`].

use super::gaussian::{Gaussian, gaussian_row};
use super::neighbourhood::{Neighbourhood, RowKernel};
use crate::image::Error;

/// An unsharp mask whose smoothing is `SIZE × SIZE`, as a row kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unsharp<const SIZE: usize> {
    smooth: Gaussian<SIZE>,
    /// In 1/64.
    amount: i16,
    threshold: i16,
}

/// [`Unsharp`] as a line filter.
pub type UnsharpFilter<'m, const SIZE: usize> = Neighbourhood<'m, Unsharp<SIZE>, SIZE>;

impl<const SIZE: usize> Unsharp<SIZE> {
    /// A mask of `amount_percent` of the difference from a Gaussian with a σ (the "radius" of other programs) of
    /// `radius_milli` thousandths of a pixel, where that is more than `threshold` gray levels.
    ///
    /// The amount is rounded to 1/64.
    ///
    /// # Errors
    /// [`Error::Parameter`] as [`Gaussian::new`], and if the amount is over 199 %.
    pub const fn new(amount_percent: u32, radius_milli: u32, threshold: u8) -> Result<Self, Error> {
        // 127/64 is the most by which 255 can be multiplied in 16 bits.
        if amount_percent > 199 {
            return Err(Error::Parameter {
                name: "amount_percent",
                got: amount_percent as i64,
                allowed: "0 to 199",
            });
        }
        match Gaussian::new(radius_milli) {
            Ok(smooth) => {
                let amount = ((amount_percent * 64 + 50) / 100) as i16;
                Ok(Self { smooth, amount, threshold: threshold as i16 })
            }
            Err(error) => Err(error),
        }
    }
}

impl<const SIZE: usize> RowKernel<SIZE> for Unsharp<SIZE> {
    const COLUMNS: usize = SIZE / 2;

    fn row(&mut self, rows: [&[u8]; SIZE], made: &mut [u8]) {
        dispatched(self, rows, made);
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn dispatched<const SIZE: usize>(kernel: &Unsharp<SIZE>, rows: [&[u8]; SIZE], made: &mut [u8]) {
    gaussian_row(kernel.smooth.weights(), rows, made);
    let (amount, threshold) = (kernel.amount, kernel.threshold);
    for (made, &value) in made.iter_mut().zip(&rows[SIZE / 2][SIZE / 2..]) {
        let value = i16::from(value);
        let difference = value - i16::from(*made);
        let step = (difference * amount + 32) >> 6;
        // A mask in place of a branch: all ones beyond the threshold.
        let beyond = -i16::from(difference.abs() > threshold);
        *made = (value + (step & beyond)).clamp(0, 255) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_exaggerated_beyond_the_threshold_only() {
        let row = [100, 100, 100, 104, 104, 104, 104, 160, 160, 160];
        let mut made = [0; 8];
        Unsharp::<3>::new(100, 850, 3).unwrap().row([&row; 3], &mut made);
        assert_eq!(made, [100, 100, 104, 104, 104, 90, 174, 160]);
        Unsharp::<3>::new(0, 850, 0).unwrap().row([&row; 3], &mut made);
        assert_eq!(made, row[1..9], "no amount, no change");
    }

    #[test]
    fn bad_parameters_say_what_is_right() {
        assert!(Unsharp::<3>::new(200, 850, 0).is_err());
        assert!(Unsharp::<4>::new(100, 850, 0).is_err());
        assert!(Unsharp::<3>::new(100, 0, 0).is_err());
    }
}
