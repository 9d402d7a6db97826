//! The formats by name: how many bytes a line takes, and how one is made of a line of colour.

use super::bayer::{BayerOrder, mosaic_line};
use super::layout::{BitDepth, ByteOrder, check_length};
use super::yuv422::{self, Coefficients, Matrix, Packing, Range};
use super::{gray8, rgb565, rgb888};
use crate::image::{Error, Rgb};

/// A pixel format as a camera interface leaves it in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// `rgb888`: red, green, blue.
    Rgb888,
    /// `rgb565-le`: low byte first.
    Rgb565Le,
    /// `rgb565-be`: high byte first.
    Rgb565Be,
    /// `gray8`: luma.
    Gray8,
    /// `yuyv`: Y0 Cb Y1 Cr.
    Yuyv,
    /// `uyvy`: Cb Y0 Cr Y1.
    Uyvy,
    /// `raw8`: Bayer mosaic.
    Raw8,
    /// `raw10`: Bayer mosaic on a 10-bit bus; a sample is right-aligned in two bytes, low byte first.
    Raw10,
    /// `raw12`: the same on a 12-bit bus.
    Raw12,
}

/// What a format's name leaves open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meaning {
    /// How the YUV formats are made.
    pub yuv: Coefficients,
    /// The mosaic of the RAW formats.
    pub bayer: BayerOrder,
}

impl Default for Meaning {
    /// BT.601 in limited range, and RGGB.
    fn default() -> Self {
        Self { yuv: Coefficients::new(Matrix::Bt601, Range::Limited), bayer: BayerOrder::Rggb }
    }
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Rgb888,
        Self::Rgb565Le,
        Self::Rgb565Be,
        Self::Gray8,
        Self::Yuyv,
        Self::Uyvy,
        Self::Raw8,
        Self::Raw10,
        Self::Raw12,
    ];

    /// The name in small letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rgb888 => "rgb888",
            Self::Rgb565Le => "rgb565-le",
            Self::Rgb565Be => "rgb565-be",
            Self::Gray8 => "gray8",
            Self::Yuyv => "yuyv",
            Self::Uyvy => "uyvy",
            Self::Raw8 => "raw8",
            Self::Raw10 => "raw10",
            Self::Raw12 => "raw12",
        }
    }

    /// The format of that name, in any case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name().eq_ignore_ascii_case(name))
    }

    /// Bytes a pixel, in memory.
    #[must_use]
    pub const fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Rgb888 => 3,
            Self::Rgb565Le | Self::Rgb565Be | Self::Yuyv | Self::Uyvy | Self::Raw10 | Self::Raw12 => 2,
            Self::Gray8 | Self::Raw8 => 1,
        }
    }

    /// Bytes of a line of `width` pixels, in memory.
    #[must_use]
    pub const fn line_bytes(self, width: usize) -> usize {
        width * self.bytes_per_pixel()
    }

    /// Makes line `y` of a picture; `y` matters to the mosaics only.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if `bytes` does not hold [`Format::line_bytes`] of the pixels, and
    /// [`Error::Parameter`] for an odd line in YUV; nothing is then written.
    pub fn encode_line(
        self,
        pixels: &[Rgb],
        bytes: &mut [u8],
        y: usize,
        meaning: &Meaning,
    ) -> Result<(), Error> {
        match self {
            Self::Rgb888 => rgb888::encode_line(pixels, bytes),
            Self::Rgb565Le => rgb565::encode_line(pixels, bytes, ByteOrder::LittleEndian),
            Self::Rgb565Be => rgb565::encode_line(pixels, bytes, ByteOrder::BigEndian),
            Self::Gray8 => gray8::encode_line(pixels, bytes),
            Self::Yuyv => yuv422::encode_line(pixels, bytes, Packing::Yuyv, &meaning.yuv),
            Self::Uyvy => yuv422::encode_line(pixels, bytes, Packing::Uyvy, &meaning.yuv),
            Self::Raw8 => mosaic_line(pixels, bytes, meaning.bayer, y),
            Self::Raw10 => mosaic_words(pixels, bytes, meaning.bayer, y, BitDepth::Bits10),
            Self::Raw12 => mosaic_words(pixels, bytes, meaning.bayer, y, BitDepth::Bits12),
        }
    }

    /// Reads a line of pixels, where that needs no other line.
    ///
    /// # Errors
    /// As [`Format::encode_line`]; and [`Error::Parameter`] for the RAW formats, whose lines must be demosaiced.
    pub fn decode_line(self, bytes: &[u8], pixels: &mut [Rgb], meaning: &Meaning) -> Result<(), Error> {
        match self {
            Self::Rgb888 => rgb888::decode_line(bytes, pixels),
            Self::Rgb565Le => rgb565::decode_line(bytes, pixels, ByteOrder::LittleEndian),
            Self::Rgb565Be => rgb565::decode_line(bytes, pixels, ByteOrder::BigEndian),
            Self::Gray8 => gray8::decode_line(bytes, pixels),
            Self::Yuyv => yuv422::decode_line(bytes, pixels, Packing::Yuyv, &meaning.yuv),
            Self::Uyvy => yuv422::decode_line(bytes, pixels, Packing::Uyvy, &meaning.yuv),
            Self::Raw8 | Self::Raw10 | Self::Raw12 => Err(Error::Parameter {
                name: "format",
                got: self as i64,
                allowed: "one of whole pixels; RAW lines go through `color::demosaic`",
            }),
        }
    }
}

/// A mosaic of right-aligned words, low byte first, without a line of words in between.
fn mosaic_words(
    pixels: &[Rgb],
    bytes: &mut [u8],
    order: BayerOrder,
    y: usize,
    depth: BitDepth,
) -> Result<(), Error> {
    check_length("bytes", 2 * pixels.len(), bytes.len())?;
    let filters = order.line(y);
    let (words, _) = bytes.as_chunks_mut::<2>();
    for (x, (word, &pixel)) in words.iter_mut().zip(pixels).enumerate() {
        *word = depth.expand(filters[x % 2].of(pixel)).to_le_bytes();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixel::bayer::mosaic_line_deep;
    use crate::pixel::raw;

    #[test]
    fn names_and_sizes_agree_with_what_is_written() {
        let pixels = [Rgb::new(10, 200, 30), Rgb::new(250, 0, 99)];
        let (meaning, mut back) = (Meaning::default(), [Rgb::default(); 2]);
        for format in Format::ALL {
            assert_eq!(Format::from_name(&format.name().to_uppercase()), Some(format));
            let mut bytes = [0; 6];
            let bytes = &mut bytes[..format.line_bytes(2)];
            format.encode_line(&pixels, bytes, 0, &meaning).unwrap();
            assert!(format.encode_line(&pixels[..1], bytes, 0, &meaning).is_err());
            let raw = matches!(format, Format::Raw8 | Format::Raw10 | Format::Raw12);
            assert_eq!(format.decode_line(bytes, &mut back, &meaning).is_err(), raw);
        }
        assert_eq!(Format::from_name("rgb"), None);
    }

    #[test]
    fn deep_mosaics_are_those_of_the_two_steps() {
        let pixels: [Rgb; 5] = core::array::from_fn(|i| Rgb::new(i as u8, 100 + i as u8, 255 - i as u8));
        for (format, depth) in [(Format::Raw10, BitDepth::Bits10), (Format::Raw12, BitDepth::Bits12)] {
            let (mut samples, mut steps, mut bytes) = ([0; 5], [0; 10], [0; 10]);
            mosaic_line_deep(&pixels, &mut samples, BayerOrder::Gbrg, 1, depth).unwrap();
            raw::encode_line16(&samples, &mut steps, ByteOrder::LittleEndian).unwrap();
            let meaning = Meaning { bayer: BayerOrder::Gbrg, ..Meaning::default() };
            format.encode_line(&pixels, &mut bytes, 1, &meaning).unwrap();
            assert_eq!(bytes, steps);
        }
    }
}
