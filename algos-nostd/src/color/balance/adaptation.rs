//! Chromatic adaptation: the colours of a scene under one light, as they would be under another.
//!
//! ```text
//! linear RGB ─► XYZ ─► responses ─► × (target / white) ─► XYZ ─► linear RGB        all of it ONE 3×3 matrix
//! ```
//!
//! In which space the three gains are applied is what tells the methods apart. Each matrix from CIE XYZ to responses
//! stands at [`Space::responses`]. The errors are mean and largest ΔE*ab over 30 smooth surfaces taken from illuminant A
//! to D65 (45.1 and 55.2 if nothing is done), as `tests/tests/balance.rs` prints them.
//!
//! | space | mean | most | source |
//! |---|---|---|---|
//! | [`Space::Rgb`] | 43.1 | 241.7 | linear RGB itself, with the primaries of IEC 61966-2-1 (sRGB) |
//! | [`Space::Xyz`] | 13.8 | 36.0 | XYZ scaling, "wrong von Kries": CIELAB's own normalisation |
//! | [`Space::Bradford`] | 6.2 | 14.1 | K. M. Lam, thesis, University of Bradford (1985); linear form as in ICC.1:2022 annex E |
//! | [`Space::Cat02`] | 6.7 | 17.6 | N. Moroney et al., "The CIECAM02 color appearance model", CIC 10 (2002); CIE 159:2004 |
//! | [`Space::Cmccat2000`] | 6.8 | 16.9 | C. Li, M. R. Luo, B. Rigg, R. W. G. Hunt, "CMC 2000 chromatic adaptation transform: CMCCAT2000", Color Res. Appl. 27 (2002) |
//! | [`Space::Sharp`] | 5.8 | 15.3 | G. D. Finlayson, S. Süsstrunk, "Performance of a chromatic adaptation transform based on spectral sharpening", CIC 8 (2000) |
//! | [`Space::Romm`] | 10.2 | 26.2 | ROMM RGB primaries: K. E. Spaulding, G. J. Woolfe, E. J. Giorgianni, "Reference input/output medium metric RGB color encodings", PICS (2000); ISO 22028-2 |
//!
//! **Where we deviate.** Full adaptation only (D = 1), and no exponent on blue in Bradford, so that one matrix does.
//! Set-up is in integers of 32 fraction bits ([`Exact3`]); the result is rounded once to Q12.

use super::White;
use super::exact::Exact3;
use super::matrix::Matrix3;
use crate::image::Error;

/// The space whose axes are scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Space {
    /// Linear RGB.
    Rgb,
    /// CIE XYZ.
    Xyz,
    /// Bradford's sharpened cones.
    Bradford,
    /// Those of CIECAM02.
    Cat02,
    /// Those of CMCCAT2000.
    Cmccat2000,
    /// Finlayson's and Süsstrunk's sharp sensors.
    Sharp,
    /// ROMM RGB.
    Romm,
}

/// From linear RGB to XYZ: IEC 61966-2-1:1999 §5.2, in ten-thousandths.
const RGB_TO_XYZ: [[i32; 3]; 3] = [[4_124, 3_576, 1_805], [2_126, 7_152, 722], [193, 1_192, 9_505]];

impl Space {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Rgb, Self::Xyz, Self::Bradford, Self::Cat02, Self::Cmccat2000, Self::Sharp, Self::Romm];

    /// The name in small letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Xyz => "xyz",
            Self::Bradford => "bradford",
            Self::Cat02 => "cat02",
            Self::Cmccat2000 => "cmccat2000",
            Self::Sharp => "sharp",
            Self::Romm => "romm",
        }
    }

    /// The space of that name, in any case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|space| space.name().eq_ignore_ascii_case(name))
    }

    /// The matrix from XYZ to this space's responses.
    ///
    /// # Errors
    /// None with the matrices as they are; the result is that of the checked set-up maths.
    pub fn responses(self) -> Result<Exact3, Error> {
        let rows = match self {
            Self::Rgb => return Exact3::from_ten_thousandths(RGB_TO_XYZ)?.inverse(),
            Self::Xyz => [[10_000, 0, 0], [0, 10_000, 0], [0, 0, 10_000]],
            Self::Bradford => [[8_951, 2_664, -1_614], [-7_502, 17_135, 367], [389, -685, 10_296]],
            Self::Cat02 => [[7_328, 4_296, -1_624], [-7_036, 16_975, 61], [30, 136, 9_834]],
            Self::Cmccat2000 => [[7_982, 3_389, -1_371], [-5_918, 15_512, 406], [8, 239, 9_753]],
            Self::Sharp => [[12_694, -988, -1_706], [-8_364, 18_006, 357], [297, -315, 10_018]],
            Self::Romm => [[13_460, -2_556, -511], [-5_446, 15_082, 205], [0, 0, 12_123]],
        };
        Exact3::from_ten_thousandths(rows)
    }
}

/// The matrix in XYZ that makes `white` the colour `target`; both are XYZ in Q32.
///
/// # Errors
/// [`Error::Parameter`] if a response to `white` is not above a 256th of that to `target`, or one is not positive.
pub fn in_xyz(space: Space, white: [i64; 3], target: [i64; 3]) -> Result<Exact3, Error> {
    let responses = space.responses()?;
    let (from, to) = (responses.times_vector(white)?, responses.times_vector(target)?);
    let mut gains = [0; 3];
    for ((gain, from), to) in gains.iter_mut().zip(from).zip(to) {
        if from <= 0 || to <= 0 {
            return Err(Error::Parameter {
                name: "white",
                got: from.min(to),
                allowed: "a colour to which every response is positive",
            });
        }
        let ratio = ((i128::from(to) << 32) + i128::from(from / 2)) / i128::from(from);
        *gain = i64::try_from(ratio).unwrap_or(i64::MAX);
    }
    responses.inverse()?.after(&Exact3::diagonal(gains)?)?.after(&responses)
}

/// The matrix for linear RGB (primaries of sRGB) that makes `white` the colour `target`.
///
/// With [`White::gray`] as target the light becomes neutral.
///
/// # Errors
/// As [`in_xyz`], and if a coefficient leaves the range of [`Matrix3`]: such a light cannot be balanced.
pub fn in_rgb(space: Space, white: White, target: White) -> Result<Matrix3, Error> {
    let to_xyz = Exact3::from_ten_thousandths(RGB_TO_XYZ)?;
    // 65,536 ≙ 256 codes is one.
    let xyz = |light: White| to_xyz.times_vector(light.channels().map(|channel| i64::from(channel) << 16));
    let adapted = in_xyz(space, xyz(white)?, xyz(target)?)?;
    Matrix3::from_exact(&to_xyz.inverse()?.after(&adapted)?.after(&to_xyz)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::balance::Gains;
    use crate::image::Rgb;

    #[test]
    fn every_space_makes_the_light_neutral() {
        let light = Rgb::new(230, 180, 110);
        let white = White::of(light);
        for space in Space::ALL {
            let matrix = in_rgb(space, white, white.gray()).unwrap();
            let gray = matrix.apply(light);
            assert_eq!([gray.r, gray.g, gray.b], [173; 3], "{}", space.name());
            assert_eq!(in_rgb(space, white, white).unwrap(), Matrix3::IDENTITY);
            assert_eq!(Space::from_name(&space.name().to_uppercase()), Some(space));
        }
    }

    #[test]
    fn scaling_rgb_is_a_diagonal_of_gains() {
        let white = White { r: 50_000, g: 40_000, b: 23_000 };
        let gains = Gains::neutralizing(white).unwrap().to_q12();
        let rows = in_rgb(Space::Rgb, white, white.gray()).unwrap().to_q12();
        for (row, coefficients) in rows.iter().enumerate() {
            for (column, &coefficient) in coefficients.iter().enumerate() {
                let expected = if row == column { gains[row] as i16 } else { 0 };
                assert_eq!(coefficient, expected);
            }
        }
    }

    #[test]
    fn a_light_without_a_colour_is_refused() {
        let black = White { r: 0, g: 0, b: 0 };
        for space in Space::ALL {
            assert!(in_rgb(space, black, black).is_err());
        }
        let red = White::of(Rgb::new(255, 0, 0));
        assert!(in_rgb(Space::Rgb, red, red.gray()).is_err());
        // In XYZ, red light has all three, but gray out of it is beyond the coefficients' range.
        assert!(
            in_rgb(Space::Xyz, White::of(Rgb::new(9, 0, 0)), White::of(Rgb::new(255, 255, 255))).is_err()
        );
    }
}
