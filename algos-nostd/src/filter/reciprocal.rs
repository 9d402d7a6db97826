//! Division by a number known at set-up, as a multiplication: many pixels, one divisor.

/// Divides by a fixed divisor: exact for every dividend below 2³¹.
///
/// Reference: T. Granlund and P. Montgomery, "Division by Invariant Integers using Multiplication", PLDI 1994: with
/// `m = ⌈2^(31 + l) / d⌉` and `2^l ≥ d`, `⌊n m / 2^(31 + l)⌋ = ⌊n / d⌋` for `n < 2³¹`, and `m` fits 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reciprocal {
    multiplier: u32,
    shift: u32,
}

impl Reciprocal {
    /// For a divisor of 1 to 2³⁰; others are taken for the nearest of these.
    pub(super) const fn new(divisor: u32) -> Self {
        let divisor = if divisor == 0 {
            1
        } else if divisor > 1 << 30 {
            1 << 30
        } else {
            divisor
        };
        let shift = 31 + divisor.next_power_of_two().trailing_zeros();
        Self { multiplier: (1u64 << shift).div_ceil(divisor as u64) as u32, shift }
    }

    /// The quotient, rounded down.
    #[inline(always)]
    pub(super) const fn divide(self, dividend: u32) -> u32 {
        ((dividend as u64 * self.multiplier as u64) >> self.shift) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn is_the_division(dividend in 0u32..1 << 31, divisor in 1u32..=1 << 30, bits in 0u32..30) {
            let divisor = (divisor >> bits).max(1);
            let reciprocal = Reciprocal::new(divisor);
            prop_assert_eq!(reciprocal.divide(dividend), dividend / divisor);
            // Where it would break first: just below a multiple.
            let edge = (dividend / divisor * divisor).saturating_sub(1);
            prop_assert_eq!(reciprocal.divide(edge), edge / divisor);
            prop_assert_eq!(reciprocal.divide(i32::MAX as u32), i32::MAX as u32 / divisor);
        }
    }
}
