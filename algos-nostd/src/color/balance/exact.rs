//! 3×3 matrices of 32 fraction bits, for set-up: products and inverses are made here and only then rounded to the
//! Q12 of the hot loop. Integers throughout, so that every target composes the same matrix.
//!
//! **Fixed point.** Coefficients are Q32 in 64 bits and must stay within ±256. Products are rounded to the nearest.

use crate::image::Error;

/// Bits behind the point.
const FRACTION: u32 = 32;
/// The largest magnitude of a coefficient.
const LIMIT: i64 = 256 << FRACTION;

/// A 3×3 matrix in Q32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exact3 {
    rows: [[i64; 3]; 3],
}

/// `numerator / denominator`, to the nearest; the denominator is positive.
fn divide(numerator: i128, denominator: i128) -> i128 {
    (2 * numerator + denominator).div_euclid(2 * denominator)
}

/// The coefficient, if it is within range.
fn checked(coefficient: i128) -> Result<i64, Error> {
    i64::try_from(coefficient).ok().filter(|value| value.abs() <= LIMIT).ok_or(Error::Parameter {
        name: "coefficient",
        got: i64::try_from(coefficient >> FRACTION).unwrap_or(i64::MAX),
        allowed: "within -256 to 256",
    })
}

impl Exact3 {
    /// One in Q32.
    pub const ONE: i64 = 1 << FRACTION;

    /// A matrix of coefficients in ten-thousandths, as standards print them.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a coefficient is not within ±256.
    pub fn from_ten_thousandths(rows: [[i32; 3]; 3]) -> Result<Self, Error> {
        Self::try_map(|row, column| divide(i128::from(rows[row][column]) << FRACTION, 10_000))
    }

    /// A diagonal of Q32 coefficients.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a coefficient is not within ±256.
    pub fn diagonal(coefficients: [i64; 3]) -> Result<Self, Error> {
        Self::try_map(|row, column| if row == column { coefficients[row].into() } else { 0 })
    }

    fn try_map(coefficient: impl Fn(usize, usize) -> i128) -> Result<Self, Error> {
        let mut rows = [[0; 3]; 3];
        for (row, places) in rows.iter_mut().enumerate() {
            for (column, place) in places.iter_mut().enumerate() {
                *place = checked(coefficient(row, column))?;
            }
        }
        Ok(Self { rows })
    }

    /// The coefficients in Q32, row by row.
    #[must_use]
    pub const fn rows(&self) -> &[[i64; 3]; 3] {
        &self.rows
    }

    /// This matrix times a vector in Q32 whose elements are within ±256.
    ///
    /// # Errors
    /// [`Error::Parameter`] if an element of either is not within ±256.
    pub fn times_vector(&self, vector: [i64; 3]) -> Result<[i64; 3], Error> {
        for element in vector {
            checked(element.into())?;
        }
        let mut product = [0; 3];
        for (place, row) in product.iter_mut().zip(&self.rows) {
            let sum: i128 = row.iter().zip(vector).map(|(&m, v)| i128::from(m) * i128::from(v)).sum();
            *place = checked(divide(sum, 1 << FRACTION))?;
        }
        Ok(product)
    }

    /// This matrix after `first`: the product `self × first`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a coefficient of the product is not within ±256.
    pub fn after(&self, first: &Self) -> Result<Self, Error> {
        Self::try_map(|row, column| {
            let sum: i128 =
                (0..3).map(|at| i128::from(self.rows[row][at]) * i128::from(first.rows[at][column])).sum();
            divide(sum, 1 << FRACTION)
        })
    }

    /// The inverse, by cofactors.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is none, or one of its coefficients is not within ±256.
    pub fn inverse(&self) -> Result<Self, Error> {
        let at = |row: usize, column: usize| i128::from(self.rows[row % 3][column % 3]);
        // Q64, within ±2⁸¹: rows and columns taken in a circle have the sign already.
        let cofactor = |row: usize, column: usize| {
            at(row + 1, column + 1) * at(row + 2, column + 2)
                - at(row + 1, column + 2) * at(row + 2, column + 1)
        };
        // Q96, within ±2¹²³; brought to Q64.
        let determinant = (0..3).map(|column| at(0, column) * cofactor(0, column)).sum::<i128>() >> FRACTION;
        if determinant == 0 {
            return Err(Error::Parameter {
                name: "determinant",
                got: 0,
                allowed: "other than 0 for a matrix to have an inverse",
            });
        }
        Self::try_map(|row, column| {
            divide((cofactor(column, row) << FRACTION) * determinant.signum(), determinant.abs())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_one() {
        let matrices = [
            [[4_124, 3_576, 1_805], [2_126, 7_152, 722], [193, 1_192, 9_505]],
            [[8_951, 2_664, -1_614], [-7_502, 17_135, 367], [389, -685, 10_296]],
            [[0, 0, 10_000], [0, -20_000, 0], [10_000, 0, 0]],
        ];
        for rows in matrices {
            let matrix = Exact3::from_ten_thousandths(rows).unwrap();
            let product = matrix.after(&matrix.inverse().unwrap()).unwrap();
            for (row, coefficients) in product.rows().iter().enumerate() {
                for (column, coefficient) in coefficients.iter().enumerate() {
                    let expected = if row == column { Exact3::ONE } else { 0 };
                    assert!(coefficient.abs_diff(expected) < 1 << 6, "{product:?}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let flat = Exact3::from_ten_thousandths([[10_000; 3]; 3]).unwrap();
        assert!(matches!(flat.inverse(), Err(Error::Parameter { name: "determinant", .. })));
        assert!(Exact3::from_ten_thousandths([[2_560_001, 0, 0], [0; 3], [0; 3]]).is_err());
        assert!(flat.times_vector([i64::MAX, 0, 0]).is_err());
    }
}
