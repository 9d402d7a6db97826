//! 3×3 matrices on pixels, in fixed point.
//!
//! ```text
//! ┌ r' ┐   ┌ m00 m01 m02 ┐ ┌ r ┐
//! │ g' │ = │ m10 m11 m12 │ │ g │     colour correction, balance, saturation, sepia…
//! └ b' ┘   └ m20 m21 m22 ┘ └ b ┘
//! ```
//!
//! **Fixed point.** Coefficients are Q12 in 16 bits, −8 to 7.9998. The sum of the three products is exact; it is rounded
//! once, to the nearest with halves up, and saturates at 0 and 255: `clamp((m · p + 2048) >> 12, 0, 255)`.
//!
//! **Cost.** One pass in place, nine multiplications a pixel. With the feature `std`, pixels go in blocks through planes of
//! red, green and blue, since that is what vector units need. Where no partial sum can leave 16 bits (in every row the
//! positive coefficients sum to less than 1.95 and the negative ones to more than −2, so almost every matrix of a
//! camera) a coefficient is split into `64 × high + low`, and
//!
//! ```text
//! (64 Σ high·p + Σ low·p + 2048) >> 12  =  (Σ high·p + ((Σ low·p + 2048) >> 6)) >> 6
//! ```
//!
//! is computed in 16-bit lanes, twice as many as 32-bit ones; the result is the same number. 768 bytes of stack.

use super::exact::Exact3;
use crate::color::pointwise::PixelMap;
use crate::image::{Error, Rgb};

/// A 3×3 matrix in Q12.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Matrix3 {
    rows: [[i16; 3]; 3],
}

impl Matrix3 {
    /// A coefficient of one.
    pub const ONE: i16 = 1 << 12;

    /// Leaves every pixel as it is.
    pub const IDENTITY: Self = Self { rows: [[Self::ONE, 0, 0], [0, Self::ONE, 0], [0, 0, Self::ONE]] };

    /// A matrix of Q12 coefficients, row by row.
    #[must_use]
    pub const fn from_q12(rows: [[i16; 3]; 3]) -> Self {
        Self { rows }
    }

    /// The coefficients in Q12, row by row.
    #[must_use]
    pub const fn to_q12(self) -> [[i16; 3]; 3] {
        self.rows
    }

    /// A matrix of coefficients in ten-thousandths, each rounded to the nearest in Q12.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a coefficient is not within −8 to 7.9998.
    pub fn from_ten_thousandths(rows: [[i32; 3]; 3]) -> Result<Self, Error> {
        Self::from_exact(&Exact3::from_ten_thousandths(rows)?)
    }

    /// The nearest matrix in Q12.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a coefficient is not within −8 to 7.9998.
    pub fn from_exact(exact: &Exact3) -> Result<Self, Error> {
        let mut rows = [[0; 3]; 3];
        for (place, &coefficient) in rows.iter_mut().flatten().zip(exact.rows().iter().flatten()) {
            let rounded = (coefficient + (1 << 19)) >> 20;
            *place = i16::try_from(rounded).map_err(|_| Error::Parameter {
                name: "coefficient",
                got: rounded,
                allowed: "-32768 to 32767 in Q12, that is -8 to 7.9998",
            })?;
        }
        Ok(Self { rows })
    }

    /// One pixel through the matrix.
    #[inline]
    #[must_use]
    pub fn apply(&self, pixel: Rgb) -> Rgb {
        let [r, g, b] = self.rows.map(|row| wide(row, pixel.r, pixel.g, pixel.b));
        Rgb { r, g, b }
    }
}

impl PixelMap<Rgb> for Matrix3 {
    #[cfg(feature = "std")]
    fn apply_line(&self, line: &mut [Rgb]) {
        blocks::apply(self.rows, line);
    }

    #[cfg(not(feature = "std"))]
    fn apply_line(&self, line: &mut [Rgb]) {
        line.iter_mut().for_each(|pixel| *pixel = self.apply(*pixel));
    }
}

/// A row times a pixel, in 32 bits.
#[inline(always)]
fn wide(row: [i16; 3], r: u8, g: u8, b: u8) -> u8 {
    let [by_r, by_g, by_b] = row.map(i32::from);
    let sum = by_r * i32::from(r) + by_g * i32::from(g) + by_b * i32::from(b) + (1 << 11);
    (sum >> 12).clamp(0, 255) as u8
}

/// Many pixels at a time, for vector units.
#[cfg(feature = "std")]
mod blocks {
    use super::{Rgb, wide};
    use crate::pixel::rgb888;

    /// Pixels a block: enough that planes are read well after they were written.
    const PIXELS: usize = 128;
    type Planes = [[u8; PIXELS]; 3];

    /// A row whose sums stay within 16 bits, as `64 × high + low`.
    #[derive(Clone, Copy)]
    struct Narrow {
        high: [i16; 3],
        low: [u16; 3],
    }

    impl Narrow {
        fn of(row: [i16; 3]) -> Option<Self> {
            let high = row.map(|coefficient| coefficient >> 6);
            let sum_if = |wanted: fn(i16) -> bool| {
                high.iter().filter(|&&part| wanted(part)).map(|&part| i32::from(part)).sum::<i32>()
            };
            // 255 × 125 and at most 785 from the low parts, or 255 × −128: within −32,768 to 32,767.
            let fits = sum_if(|part| part > 0) <= 125 && sum_if(|part| part < 0) >= -128;
            fits.then_some(Self { high, low: row.map(|coefficient| (coefficient & 63) as u16) })
        }

        #[inline(always)]
        fn times(self, r: u8, g: u8, b: u8) -> u8 {
            let [r, g, b] = [r, g, b].map(u16::from);
            let low = r
                .wrapping_mul(self.low[0])
                .wrapping_add(g.wrapping_mul(self.low[1]))
                .wrapping_add(b.wrapping_mul(self.low[2]))
                .wrapping_add(1 << 11);
            let sum = (r as i16)
                .wrapping_mul(self.high[0])
                .wrapping_add((g as i16).wrapping_mul(self.high[1]))
                .wrapping_add((b as i16).wrapping_mul(self.high[2]))
                .wrapping_add((low >> 6) as i16);
            (sum >> 6).clamp(0, 255) as u8
        }
    }

    pub(super) fn apply(rows: [[i16; 3]; 3], line: &mut [Rgb]) {
        let bytes = rgb888::as_bytes_mut(line);
        match rows.map(Narrow::of) {
            [Some(r), Some(g), Some(b)] => apply_narrow([r, g, b], bytes),
            _ => apply_wide(rows, bytes),
        }
    }

    #[multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2"))]
    fn apply_narrow(rows: [Narrow; 3], bytes: &mut [u8]) {
        each_block(bytes, |row, from, to| {
            let [r, g, b] = from;
            for (at, to) in to.iter_mut().enumerate() {
                *to = rows[row].times(r[at], g[at], b[at]);
            }
        });
    }

    #[multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2"))]
    fn apply_wide(rows: [[i16; 3]; 3], bytes: &mut [u8]) {
        each_block(bytes, |row, from, to| {
            let [r, g, b] = from;
            for (at, to) in to.iter_mut().enumerate() {
                *to = wide(rows[row], r[at], g[at], b[at]);
            }
        });
    }

    /// Lays each block out in planes, makes the three planes of the result, and weaves them again.
    #[inline(always)]
    fn each_block(bytes: &mut [u8], make: impl Fn(usize, &Planes, &mut [u8; PIXELS])) {
        let (mut from, mut to): (Planes, Planes) = ([[0; PIXELS]; 3], [[0; PIXELS]; 3]);
        let mut block = |bytes: &mut [u8; 3 * PIXELS]| {
            for at in 0..PIXELS {
                from[0][at] = bytes[3 * at];
                from[1][at] = bytes[3 * at + 1];
                from[2][at] = bytes[3 * at + 2];
            }
            for (row, to) in to.iter_mut().enumerate() {
                make(row, &from, to);
            }
            let [r, g, b] = &to;
            let (pixels, _) = bytes.as_chunks_mut::<3>();
            for (((pixel, &r), &g), &b) in pixels.iter_mut().zip(r).zip(g).zip(b) {
                *pixel = [r, g, b];
            }
        };
        let (whole, rest) = bytes.as_chunks_mut();
        whole.iter_mut().for_each(&mut block);
        if !rest.is_empty() {
            let mut padded = [0; 3 * PIXELS];
            padded[..rest.len()].copy_from_slice(rest);
            block(&mut padded);
            rest.copy_from_slice(&padded[..rest.len()]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the definition, in 64 bits.
    fn exact(matrix: &Matrix3, pixel: Rgb) -> Rgb {
        let [r, g, b] = matrix.rows.map(|row| {
            let sum: i64 = row.iter().zip(pixel.iter()).map(|(&m, p)| i64::from(m) * i64::from(p)).sum();
            (sum + 2048).div_euclid(4096).clamp(0, 255) as u8
        });
        Rgb { r, g, b }
    }

    #[test]
    fn every_path_is_the_definition() {
        let pixels: Vec<Rgb> = (0..3 * 128 + 57u32)
            .map(|i| {
                if i < 8 {
                    [i, i >> 1, i >> 2].map(|bit| 255 * (bit & 1))
                } else {
                    [7, 31, 101].map(|step| i * step)
                }
            })
            .map(|pixel| Rgb::from(pixel.map(|value| value as u8)))
            .collect();
        let matrices = [
            Matrix3::IDENTITY,
            Matrix3::from_ten_thousandths([
                [18_000, -5_000, -3_000],
                [-3_000, 15_000, -2_000],
                [0, -7_000, 17_000],
            ])
            .unwrap(),
            Matrix3::from_q12([[125 * 64 + 63, 63, 63], [-8192; 3], [8191, -8192, -8192]]),
            Matrix3::from_q12([[8000, -8192, -64], [-4096, -4096, 8063], [-1, -1, -1]]),
            Matrix3::from_q12([[i16::MAX; 3], [i16::MIN; 3], [i16::MAX, i16::MIN, 1]]),
            Matrix3::from_q12([[8192, 0, 0], [4000, 4100, 0], [1, 2, 3]]),
        ];
        for matrix in matrices {
            let mut line = pixels.clone();
            matrix.apply_line(&mut line);
            for (&got, &pixel) in line.iter().zip(&pixels) {
                assert_eq!(got, exact(&matrix, pixel), "{matrix:?} × {pixel:?}");
                assert_eq!(got, matrix.apply(pixel));
            }
        }
    }

    #[test]
    fn coefficients_out_of_range_are_refused() {
        assert!(Matrix3::from_ten_thousandths([[80_000, 0, 0], [0; 3], [0; 3]]).is_err());
        assert!(Matrix3::from_ten_thousandths([[-80_000, 0, 0], [0; 3], [0; 3]]).is_ok());
    }
}
