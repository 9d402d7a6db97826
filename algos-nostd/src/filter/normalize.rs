//! From a signed sum of weighted pixels back to a pixel: divide, round, add an offset, clamp.

use super::reciprocal::Reciprocal;
use crate::image::Error;

/// Greatest sum of the magnitudes of all weights: sums of 255 times that leave room in 32 bits.
const WEIGHT_MAX: u64 = 1 << 21;
/// Greatest divisor.
const DIVISOR_MAX: u32 = 1 << 24;

/// `clamp(offset + ⌊sum / divisor + 1/2⌋)`, exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Scale {
    reciprocal: Reciprocal,
    /// Makes every sum positive: a multiple of the divisor, and half the divisor for rounding.
    bias: u32,
    /// What the bias becomes in the quotient, taken off again, and the offset.
    offset: i32,
}

impl Scale {
    /// For sums of pixels times weights whose magnitudes sum to `weight`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the weights are too large for exact sums, or the divisor is not 1 to 2²⁴.
    pub(super) fn new(weight: u64, divisor: u32, offset: i16) -> Result<Self, Error> {
        if weight > WEIGHT_MAX {
            return Err(Error::Parameter {
                name: "weights",
                got: i64::try_from(weight).unwrap_or(i64::MAX),
                allowed: "at most 2097152 in sum of magnitudes",
            });
        }
        if divisor == 0 || divisor > DIVISOR_MAX {
            return Err(Error::Parameter {
                name: "divisor",
                got: i64::from(divisor),
                allowed: "1 to 16777216",
            });
        }
        // At most 255 × 2²¹ + 2²⁴ + 2²³: with the sum itself, below 2³¹.
        let multiple = (255 * weight as u32).div_ceil(divisor);
        Ok(Self {
            reciprocal: Reciprocal::new(divisor),
            bias: multiple * divisor + divisor / 2,
            offset: i32::from(offset) - multiple as i32,
        })
    }

    #[inline(always)]
    pub(super) fn pixel(self, sum: i32) -> u8 {
        let quotient = self.reciprocal.divide(self.bias.wrapping_add_signed(sum)) as i32;
        (quotient + self.offset).clamp(0, 255) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn is_the_rounded_quotient(
            weight in 0u32..=1 << 21, part in -1000i64..=1000, divisor in 1u32..=1 << 24, bits in 0u32..24, offset: i16
        ) {
            let divisor = (divisor >> bits).max(1);
            let sum = 255 * i64::from(weight) * part / 1000;
            let scale = Scale::new(u64::from(weight), divisor, offset).unwrap();
            let twice = 2 * i64::from(divisor);
            let rounded = (2 * sum + i64::from(divisor / 2 * 2)).div_euclid(twice);
            let expected = (rounded + i64::from(offset)).clamp(0, 255) as u8;
            prop_assert_eq!(scale.pixel(sum as i32), expected);
        }
    }

    #[test]
    fn bad_parameters_say_what_is_right() {
        assert!(Scale::new(WEIGHT_MAX + 1, 1, 0).is_err());
        assert!(Scale::new(1, 0, 0).is_err());
        assert!(Scale::new(1, DIVISOR_MAX + 1, 0).is_err());
    }
}
