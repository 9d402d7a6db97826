//! Gray of 8 bits: the luma of ITU-R BT.601, `0.299 R + 0.587 G + 0.114 B`, rounded to the nearest, halves up.
//!
//! The rounding is exact for all 2²⁴ colours: the sum is taken in thousandths, `(299 R + 587 G + 114 B + 500) / 1000`.
//! That is the formula of Poynton's "Y'" with the coefficients of BT.601-7 §2.5.1; approximations in 1/256 or
//! 1/65,536, as OpenCV has them, are off by one here and there.
//!
//! The division is a multiplication: with `n = sum / 8 ≤ 31,937`, `n / 125 = n × 33,555 / 2²²` rounded down, since
//! 33,555 × 125 − 2²² = 71 and 71 × 31,937 < 2²².

use super::layout::check_length;
use crate::image::{Error, Rgb};

/// Bytes of a line of `width` pixels.
#[must_use]
pub const fn line_bytes(width: usize) -> usize {
    width
}

/// The luma of one pixel, 0 to 255.
#[inline]
#[must_use]
pub const fn luma(pixel: Rgb) -> u8 {
    let eighths = (299 * pixel.r as u32 + 587 * pixel.g as u32 + 114 * pixel.b as u32 + 500) >> 3;
    ((eighths * 33_555) >> 22) as u8
}

/// Writes the luma of a line of pixels.
///
/// # Errors
/// [`Error::BufferLength`] if `gray` is not as long as the line; nothing is then written.
pub fn encode_line(pixels: &[Rgb], gray: &mut [u8]) -> Result<(), Error> {
    check_length("gray", pixels.len(), gray.len())?;
    weigh(pixels, gray);
    Ok(())
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn weigh(pixels: &[Rgb], gray: &mut [u8]) {
    gray.iter_mut().zip(pixels).for_each(|(gray, &pixel)| *gray = luma(pixel));
}

/// Writes a line of gray as pixels of equal red, green and blue. [`encode_line`] gives the gray back exactly.
///
/// # Errors
/// [`Error::BufferLength`] if `gray` is not as long as the line; nothing is then written.
pub fn decode_line(gray: &[u8], pixels: &mut [Rgb]) -> Result<(), Error> {
    check_length("gray", pixels.len(), gray.len())?;
    pixels.iter_mut().zip(gray).for_each(|(pixel, &gray)| *pixel = Rgb::new(gray, gray, gray));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_gray_survives() {
        let gray: [u8; 256] = core::array::from_fn(|i| i as u8);
        let (mut pixels, mut back) = ([Rgb::default(); 256], [0; 256]);
        decode_line(&gray, &mut pixels).unwrap();
        encode_line(&pixels, &mut back).unwrap();
        assert_eq!(back, gray);
        assert!(encode_line(&pixels, &mut back[..3]).is_err());
    }

    #[test]
    fn the_division_is_exact() {
        for sum in 0..=255_500u32 {
            assert_eq!(((sum >> 3) * 33_555) >> 22, sum / 1000);
        }
    }
}
