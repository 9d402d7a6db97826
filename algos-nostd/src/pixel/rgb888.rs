//! RGB888: three bytes a pixel, red first.
//!
//! ```text
//! byte   0   1   2   3   4   5
//!        R0  G0  B0  R1  G1  B1
//! ```
//!
//! [`Rgb`] has the same layout in memory, so [`as_bytes`] and [`as_pixels`] cost nothing; the line functions copy.

use super::layout::check_length;
use crate::image::{Error, Rgb};
use rgb::bytemuck::{cast_slice, cast_slice_mut};

/// Bytes of a line of `width` pixels.
#[must_use]
pub const fn line_bytes(width: usize) -> usize {
    3 * width
}

/// The pixels' bytes, red first, without a copy.
#[must_use]
pub fn as_bytes(pixels: &[Rgb]) -> &[u8] {
    cast_slice(pixels)
}

/// The pixels' bytes, red first, to be written to.
#[must_use]
pub fn as_bytes_mut(pixels: &mut [Rgb]) -> &mut [u8] {
    cast_slice_mut(pixels)
}

/// Bytes, red first, as pixels, without a copy. A rest of one or two bytes at the end is left out.
#[must_use]
pub fn as_pixels(bytes: &[u8]) -> &[Rgb] {
    cast_slice(&bytes[..bytes.len() / 3 * 3])
}

/// Writes a line of pixels as bytes.
///
/// # Errors
/// [`Error::BufferLength`] if `bytes` does not hold [`line_bytes`] of the pixels; nothing is then written.
pub fn encode_line(pixels: &[Rgb], bytes: &mut [u8]) -> Result<(), Error> {
    check_length("bytes", line_bytes(pixels.len()), bytes.len())?;
    bytes.copy_from_slice(as_bytes(pixels));
    Ok(())
}

/// Reads a line of pixels from bytes.
///
/// # Errors
/// [`Error::BufferLength`] if `bytes` does not hold [`line_bytes`] of the pixels; nothing is then written.
pub fn decode_line(bytes: &[u8], pixels: &mut [Rgb]) -> Result<(), Error> {
    check_length("bytes", line_bytes(pixels.len()), bytes.len())?;
    as_bytes_mut(pixels).copy_from_slice(bytes);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_comes_first() {
        let pixels = [Rgb::new(1, 2, 3), Rgb::new(4, 5, 6)];
        let mut bytes = [0; 6];
        encode_line(&pixels, &mut bytes).unwrap();
        assert_eq!(bytes, [1, 2, 3, 4, 5, 6]);
        let mut back = [Rgb::default(); 2];
        decode_line(&bytes, &mut back).unwrap();
        assert_eq!(back, pixels);
        assert_eq!(as_pixels(&bytes[..5]), &pixels[..1]);
        assert_eq!(
            decode_line(&bytes[..5], &mut back),
            Err(Error::BufferLength { name: "bytes", expected: 6, got: 5 })
        );
    }
}
