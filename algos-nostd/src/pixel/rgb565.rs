//! RGB565: 5 bits of red, 6 of green, 5 of blue in a 16-bit word.
//!
//! ```text
//! bit   15 … 11   10 … 5   4 … 0
//!         red      green    blue
//! ```
//!
//! Encoding drops the low bits, as sensors do. Decoding repeats a channel's high bits below it, so that black is 0
//! and white 255. A word survives decoding and encoding exactly; a pixel that goes the other way changes by at
//! most 7 in red and blue and 3 in green.

use super::layout::{ByteOrder, check_length};
use crate::image::{Error, Rgb};

/// Bytes of a line of `width` pixels.
#[must_use]
pub const fn line_bytes(width: usize) -> usize {
    2 * width
}

/// One pixel as a word; the low 3, 2 and 3 bits are dropped.
#[inline]
#[must_use]
pub const fn encode(pixel: Rgb) -> u16 {
    ((pixel.r as u16 & 0xF8) << 8) | ((pixel.g as u16 & 0xFC) << 3) | (pixel.b as u16 >> 3)
}

/// One word as a pixel; the high bits are repeated below.
#[inline]
#[must_use]
pub const fn decode(word: u16) -> Rgb {
    let (red, green, blue) = (word >> 11, word >> 5 & 0x3F, word & 0x1F);
    Rgb {
        r: (red << 3 | red >> 2) as u8,
        g: (green << 2 | green >> 4) as u8,
        b: (blue << 3 | blue >> 2) as u8,
    }
}

/// Writes a line of pixels as words in the given byte order.
///
/// # Errors
/// [`Error::BufferLength`] if `bytes` does not hold [`line_bytes`] of the pixels; nothing is then written.
pub fn encode_line(pixels: &[Rgb], bytes: &mut [u8], order: ByteOrder) -> Result<(), Error> {
    check_length("bytes", line_bytes(pixels.len()), bytes.len())?;
    let (words, _) = bytes.as_chunks_mut::<2>();
    match order {
        ByteOrder::LittleEndian => {
            words.iter_mut().zip(pixels).for_each(|(word, &pixel)| *word = encode(pixel).to_le_bytes());
        }
        ByteOrder::BigEndian => {
            words.iter_mut().zip(pixels).for_each(|(word, &pixel)| *word = encode(pixel).to_be_bytes());
        }
    }
    Ok(())
}

/// Reads a line of pixels from words in the given byte order.
///
/// # Errors
/// [`Error::BufferLength`] if `bytes` does not hold [`line_bytes`] of the pixels; nothing is then written.
pub fn decode_line(bytes: &[u8], pixels: &mut [Rgb], order: ByteOrder) -> Result<(), Error> {
    check_length("bytes", line_bytes(pixels.len()), bytes.len())?;
    let (words, _) = bytes.as_chunks::<2>();
    match order {
        ByteOrder::LittleEndian => {
            pixels.iter_mut().zip(words).for_each(|(pixel, &word)| *pixel = decode(u16::from_le_bytes(word)));
        }
        ByteOrder::BigEndian => {
            pixels.iter_mut().zip(words).for_each(|(pixel, &word)| *pixel = decode(u16::from_be_bytes(word)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_survives_in_both_orders() {
        let words: Vec<u16> = (0..=u16::MAX).collect();
        let mut pixels = vec![Rgb::default(); words.len()];
        let mut bytes = vec![0; line_bytes(words.len())];
        for order in [ByteOrder::LittleEndian, ByteOrder::BigEndian] {
            let given: Vec<u8> = words
                .iter()
                .flat_map(|word| match order {
                    ByteOrder::LittleEndian => word.to_le_bytes(),
                    ByteOrder::BigEndian => word.to_be_bytes(),
                })
                .collect();
            decode_line(&given, &mut pixels, order).unwrap();
            encode_line(&pixels, &mut bytes, order).unwrap();
            assert_eq!(bytes, given);
            assert_eq!(pixels[0], Rgb::new(0, 0, 0));
            assert_eq!(pixels[0xFFFF], Rgb::new(255, 255, 255));
            assert_eq!(pixels[0xF800], Rgb::new(255, 0, 0));
            assert_eq!(pixels[0x001F], Rgb::new(0, 0, 255));
        }
    }

    #[test]
    fn a_pixel_changes_by_less_than_a_step() {
        for value in 0..=255u8 {
            let there = decode(encode(Rgb::new(value, value, value)));
            assert!(there.r.abs_diff(value) <= 7 && there.g.abs_diff(value) <= 3 && there.b == there.r);
        }
    }

    #[test]
    fn a_short_buffer_is_refused() {
        let expected = Err(Error::BufferLength { name: "bytes", expected: 4, got: 3 });
        assert_eq!(encode_line(&[Rgb::default(); 2], &mut [0; 3], ByteOrder::BigEndian), expected);
        assert_eq!(decode_line(&[0; 3], &mut [Rgb::default(); 2], ByteOrder::BigEndian), expected);
    }
}
