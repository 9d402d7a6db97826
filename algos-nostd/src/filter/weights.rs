//! Gaussian weights in integers: the same numbers on every target, made at set-up or at compile time.

use crate::image::Error;

/// One, in the 32.32 fixed point of this file.
const ONE: u64 = 1 << 32;
/// The natural logarithm of 2 in 32.32.
const LN_2: u64 = 0xB172_17F8;

/// The least σ, in thousandths of a pixel.
const SIGMA_MIN: u32 = 100;
/// The greatest σ, in thousandths of a pixel: beyond it weights of 1/256 are too coarse to look like a bell.
const SIGMA_MAX: u32 = 16_000;

/// e^−t for t in 32.32, in 32.32; within 2⁻²⁸ of the true value.
pub(super) const fn exp_negative(t: u64) -> u64 {
    // t = halvings × ln 2 + rest, so e^−t = e^−rest / 2^halvings.
    let (halvings, rest) = (t / LN_2, t % LN_2);
    if halvings >= 32 {
        return 0;
    }
    // The series in Horner's form, 1 − r (1 − r/2 (1 − r/3 (…))): every bracket is between 0 and 1.
    let mut sum = ONE;
    let mut term = 14;
    while term > 0 {
        sum = ONE - ((rest * sum) >> 32) / term;
        term -= 1;
    }
    sum >> halvings
}

/// `distance² / (2 σ²)` in 32.32, saturated, for a distance given by its square and σ in thousandths.
pub(super) const fn gaussian_exponent(distance_squared: u32, sigma_milli: u32) -> u64 {
    let numerator = (distance_squared as u128 * 1_000_000) << 32;
    let exponent = numerator / (2 * sigma_milli as u128 * sigma_milli as u128);
    if exponent > u64::MAX as u128 { u64::MAX } else { exponent as u64 }
}

/// Checks a σ for smoothing, in thousandths of a pixel.
pub(super) const fn check_sigma(sigma_milli: u32) -> Result<(), Error> {
    if sigma_milli >= SIGMA_MIN && sigma_milli <= SIGMA_MAX {
        Ok(())
    } else {
        Err(Error::Parameter { name: "sigma_milli", got: sigma_milli as i64, allowed: "100 to 16000" })
    }
}

/// A bell of `SIZE` weights that sum to exactly 256.
///
/// Rounded from the tails inwards, each side carrying its rounding error to the next weight, so that no error is
/// larger than one unit, the centre's included.
pub(super) const fn gaussian_weights<const SIZE: usize>(sigma_milli: u32) -> [u16; SIZE] {
    let radius = SIZE / 2;
    let mut total = ONE;
    let mut distance = 1;
    while distance <= radius {
        total += 2 * exp_negative(gaussian_exponent((distance * distance) as u32, sigma_milli));
        distance += 1;
    }
    let mut weights = [0; SIZE];
    let mut centre = 256;
    let mut carried = 0i64;
    let mut distance = radius;
    while distance > 0 {
        let exact =
            exp_negative(gaussian_exponent((distance * distance) as u32, sigma_milli)) as i64 * 256 + carried;
        let rounded = (exact + total as i64 / 2).div_euclid(total as i64);
        carried = exact - rounded * total as i64;
        weights[radius - distance] = rounded as u16;
        weights[radius + distance] = rounded as u16;
        centre -= 2 * rounded as u16;
        distance -= 1;
    }
    weights[radius] = centre;
    weights
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, reason = "the test compares with the true exponential")]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_the_exponential() {
        for step in 0..4000u64 {
            let t = step * 7_654_321 * 3;
            let expected = (-(t as f64) / ONE as f64).exp();
            let got = exp_negative(t) as f64 / ONE as f64;
            assert!((got - expected).abs() < 4e-9, "e^-{} is {expected}, got {got}", t as f64 / ONE as f64);
        }
        assert_eq!(exp_negative(0), ONE);
        assert_eq!(exp_negative(u64::MAX), 0);
    }

    #[test]
    fn bells_sum_to_256_and_are_within_a_unit() {
        fn check<const SIZE: usize>() {
            for sigma_milli in (SIGMA_MIN..=SIGMA_MAX).step_by(37) {
                let weights = gaussian_weights::<SIZE>(sigma_milli);
                assert_eq!(weights.iter().sum::<u16>(), 256, "σ = {sigma_milli}/1000, {weights:?}");
                let sigma = f64::from(sigma_milli) / 1000.0;
                let bell = |x: usize| (-(x.abs_diff(SIZE / 2).pow(2) as f64) / (2.0 * sigma * sigma)).exp();
                let total: f64 = (0..SIZE).map(bell).sum();
                for (x, &weight) in weights.iter().enumerate() {
                    let exact = bell(x) / total * 256.0;
                    assert!((f64::from(weight) - exact).abs() <= 1.001, "σ = {sigma}: {weights:?}");
                }
            }
        }
        check::<1>();
        check::<3>();
        check::<5>();
        check::<7>();
        check::<31>();
        check::<63>();
    }
}
