//! Curves: each value is looked up in a table of 256.
//!
//! ```text
//! out │    ▁▃▅▆▇      gamma 1/2.2, sRGB either way, or through points that the user set
//!     │ ▁▅▇
//!     └─────────── in
//! ```
//!
//! **Reference.** sRGB: IEC 61966-2-1:1999 §5.2. Gamma: `255 × (in / 255)^γ`.
//!
//! **Set-up.** Tables are made in integers: logarithm by repeated squaring, power of two by repeated roots, 30 bits each, so that
//! every target has the same table. Entries are rounded to the nearest.
//!
//! **Cost and memory.** A look-up a byte; 256 bytes.

use crate::color::pointwise::PixelMap;
use crate::image::{Error, Rgb};
use crate::pixel::rgb888;

/// A table from 8 bits to 8 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Curve {
    table: [u8; 256],
}

impl Curve {
    /// A table as it is.
    #[must_use]
    pub const fn from_table(table: [u8; 256]) -> Self {
        Self { table }
    }

    /// The table.
    #[must_use]
    pub const fn table(&self) -> &[u8; 256] {
        &self.table
    }

    /// `255 × (in / 255)^γ` with γ in thousandths: 455 brightens as an encoder for displays does, 2,200 undoes it.
    ///
    /// # Errors
    /// [`Error::Parameter`] if γ is not 0.01 to 10.
    pub fn gamma(thousandths: u32) -> Result<Self, Error> {
        if !(10..=10_000).contains(&thousandths) {
            return Err(Error::Parameter {
                name: "gamma",
                got: thousandths.into(),
                allowed: "10 to 10000 thousandths",
            });
        }
        Ok(Self::from_fn(|value| power(u64::from(value), 255, thousandths)))
    }

    /// From sRGB codes to values proportional to light.
    #[must_use]
    pub fn srgb_to_linear() -> Self {
        // v ≤ 0.04045: v / 12.92, else ((v + 0.055) / 1.055)^2.4; v in 1/255, so the offset is 14.025 codes.
        Self::from_fn(|value| match u64::from(value) {
            low @ 0..=10 => (low << FRACTION) * 100 / (255 * 1292),
            high => power(1000 * high + 14_025, 269_025, 2400),
        })
    }

    /// From values proportional to light to sRGB codes.
    #[must_use]
    pub fn linear_to_srgb() -> Self {
        // v ≤ 0.0031308 is the code 0 only; else 1.055 v^(1/2.4) − 0.055.
        Self::from_fn(|value| match value {
            0 => 0,
            _ => {
                // 1/2.4 = 1250/3000, in thirds of thousandths to be exact.
                let root = exp2((log2(value.into()) - log2(255)) * 1250 / 3000);
                (root * 1055).saturating_sub(55 << FRACTION) / 1000
            }
        })
    }

    /// Straight lines through `(in, out)` points in ascending order; before the first and after the last it is level.
    ///
    /// # Errors
    /// [`Error::BufferLength`] without points, [`Error::Parameter`] where `in` does not ascend.
    pub fn through(points: &[(u8, u8)]) -> Result<Self, Error> {
        let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
            return Err(Error::BufferLength { name: "points", expected: 1, got: 0 });
        };
        let mut table = [0; 256];
        table[..usize::from(first.0)].fill(first.1);
        table[usize::from(last.0)..].fill(last.1);
        for pair in points.windows(2) {
            let [(x0, y0), (x1, y1)] = [pair[0], pair[1]].map(|(x, y)| (i32::from(x), i32::from(y)));
            if x1 <= x0 {
                return Err(Error::Parameter {
                    name: "points",
                    got: x1.into(),
                    allowed: "in ascending order of their first number",
                });
            }
            for x in x0..x1 {
                let (run, doubled) = (x1 - x0, 2 * (y1 - y0) * (x - x0));
                table[x as usize] = (y0 + (doubled + run).div_euclid(2 * run)) as u8;
            }
        }
        Ok(Self { table })
    }

    /// The curve whose entries are these fractions of 255, rounded.
    fn from_fn(fraction: impl Fn(u8) -> u64) -> Self {
        let mut table = [0; 256];
        for (value, entry) in (0..=255).zip(&mut table) {
            *entry = ((fraction(value) * 255 + (1 << (FRACTION - 1))) >> FRACTION).min(255) as u8;
        }
        Self { table }
    }

    /// One value through the curve.
    #[inline]
    #[must_use]
    pub const fn apply(&self, value: u8) -> u8 {
        self.table[value as usize]
    }
}

impl PixelMap<u8> for Curve {
    fn apply_line(&self, line: &mut [u8]) {
        line.iter_mut().for_each(|value| *value = self.apply(*value));
    }
}

impl PixelMap<Rgb> for Curve {
    fn apply_line(&self, line: &mut [Rgb]) {
        PixelMap::<u8>::apply_line(self, rgb888::as_bytes_mut(line));
    }
}

/// Bits behind the point.
const FRACTION: u32 = 40;
/// Bits behind the point of factors between 1 and 2.
const FACTOR: u32 = 62;

/// `(numerator / denominator)^(thousandths / 1000)` for a ratio of at most one, in Q40.
fn power(numerator: u64, denominator: u64, thousandths: u32) -> u64 {
    if numerator == 0 {
        return 0;
    }
    exp2((log2(numerator) - log2(denominator)) * i64::from(thousandths) / 1000)
}

/// The logarithm to base 2 of a number of 1 or more, in Q40, rounded down.
fn log2(number: u64) -> i64 {
    let whole = number.ilog2();
    let mut factor = u128::from(number) << (FACTOR - whole);
    let mut bits = u64::from(whole);
    for _ in 0..FRACTION {
        factor = (factor * factor) >> FACTOR;
        let bit = (factor >> (FACTOR + 1)) as u64;
        factor >>= bit;
        bits = bits << 1 | bit;
    }
    bits as i64
}

/// Two to a power of at most zero, both in Q40, rounded down.
fn exp2(power: i64) -> u64 {
    let (whole, fraction) = (-(power >> FRACTION), power & ((1 << FRACTION) - 1));
    let (mut root, mut factor) = (2u128 << FACTOR, 1u128 << FACTOR);
    for bit in (0..FRACTION).rev() {
        root = (root << FACTOR).isqrt();
        if fraction >> bit & 1 == 1 {
            factor = (factor * root) >> FACTOR;
        }
    }
    let shift = u32::try_from(whole).unwrap_or(u32::MAX).saturating_add(FACTOR - FRACTION);
    factor.checked_shr(shift).unwrap_or(0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gamma_of_one_is_the_identity() {
        let identity: [u8; 256] = core::array::from_fn(|i| i as u8);
        assert_eq!(Curve::gamma(1000).unwrap().table(), &identity);
        assert_eq!(Curve::through(&[(0, 0), (255, 255)]).unwrap().table(), &identity);
        assert!(Curve::gamma(9).is_err());
    }

    #[test]
    fn logarithms_and_powers_of_two_are_exact() {
        assert_eq!((log2(1), log2(1024), exp2(0)), (0, 10 << FRACTION, 1 << FRACTION));
        assert_eq!(exp2(-3 << FRACTION), 1 << (FRACTION - 3));
        assert_eq!(exp2(i64::MIN), 0);
    }

    #[test]
    fn points_are_met_and_joined() {
        let curve = Curve::through(&[(10, 20), (20, 0), (200, 255)]).unwrap();
        let seen = [0, 10, 15, 20, 110, 200, 255].map(|value| curve.apply(value));
        assert_eq!(seen, [20, 20, 10, 0, 128, 255, 255]);
        assert!(Curve::through(&[]).is_err());
        assert!(Curve::through(&[(5, 0), (5, 1)]).is_err());
    }

    #[test]
    fn pixels_are_looked_up_channel_by_channel() {
        let mut line = [Rgb::new(0, 1, 255)];
        Curve::from_table(core::array::from_fn(|i| 255 - i as u8)).apply_line(&mut line);
        assert_eq!(line, [Rgb::new(255, 254, 0)]);
    }
}
