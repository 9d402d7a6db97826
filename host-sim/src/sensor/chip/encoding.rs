use algos_nostd::image::Rgb;
use algos_nostd::pixel::format::{Format, Meaning};

/// How a pixel stands on the wires: the formats of profiles, and what sensors can be set to beside them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// A profile's.
    Format(Format),
    /// Y0 Cr Y1 Cb.
    Yvyu,
    /// Cr Y0 Cb Y1.
    Vyuy,
    /// RGB565 with blue in the place of red, high byte first.
    Bgr565,
    /// Five bits each below an unused one, high byte first.
    Rgb555,
    /// Four bits each below four unused ones, high byte first.
    Rgb444,
    /// Luma of 10 bits, low byte first.
    Luma10,
}

impl Encoding {
    /// The profile's format with the same bytes a pixel that is nearest in meaning.
    #[must_use]
    pub fn nearest(self) -> Format {
        match self {
            Self::Format(format) => format,
            Self::Yvyu => Format::Yuyv,
            Self::Vyuy => Format::Uyvy,
            Self::Bgr565 | Self::Rgb555 | Self::Rgb444 => Format::Rgb565Be,
            Self::Luma10 => Format::Raw10,
        }
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Format(format) => format.name(),
            Self::Yvyu => "yvyu",
            Self::Vyuy => "vyuy",
            Self::Bgr565 => "bgr565",
            Self::Rgb555 => "rgb555",
            Self::Rgb444 => "rgb444",
            Self::Luma10 => "luma10",
        }
    }

    /// Makes line `y`. `bytes` has [`Format::line_bytes`] of [`Encoding::nearest`] for the pixels; a YUV line is even.
    pub(super) fn encode_line(self, pixels: &[Rgb], bytes: &mut [u8], y: usize, meaning: &Meaning) {
        // Lengths and evenness are the readout's own, so encoding cannot fail; a line left black would show.
        let mut by_format =
            |format: Format| format.encode_line(pixels, bytes, y, meaning).unwrap_or_default();
        match self {
            Self::Format(format) => by_format(format),
            Self::Yvyu => {
                by_format(Format::Yuyv);
                bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|quad| quad.swap(1, 3));
            }
            Self::Vyuy => {
                by_format(Format::Uyvy);
                bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|quad| quad.swap(0, 2));
            }
            Self::Bgr565 => words(pixels, bytes, |pixel| {
                field(pixel.b, 5, 11) | field(pixel.g, 6, 5) | field(pixel.r, 5, 0)
            }),
            Self::Rgb555 => words(pixels, bytes, |pixel| {
                field(pixel.r, 5, 10) | field(pixel.g, 5, 5) | field(pixel.b, 5, 0)
            }),
            Self::Rgb444 => words(pixels, bytes, |pixel| {
                field(pixel.r, 4, 8) | field(pixel.g, 4, 4) | field(pixel.b, 4, 0)
            }),
            Self::Luma10 => {
                let mut luma = vec![0; pixels.len()];
                Format::Gray8.encode_line(pixels, &mut luma, y, meaning).unwrap_or_default();
                for (bytes, luma) in bytes.as_chunks_mut::<2>().0.iter_mut().zip(luma) {
                    *bytes = (u16::from(luma) << 2 | u16::from(luma) >> 6).to_le_bytes();
                }
            }
        }
    }
}

/// The upper `bits` bits of a channel, at place `low` of a word.
fn field(channel: u8, bits: u32, low: u32) -> u16 {
    u16::from(channel) >> (8 - bits) << low
}

fn words(pixels: &[Rgb], bytes: &mut [u8], word: impl Fn(&Rgb) -> u16) {
    for (bytes, pixel) in bytes.as_chunks_mut::<2>().0.iter_mut().zip(pixels) {
        *bytes = word(pixel).to_be_bytes();
    }
}
