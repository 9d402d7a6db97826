//! What the pixels of a stream are, and how they are coded: the numbers on the wire.

use algos_nostd::pixel::format::Format as Pixels;

/// A pixel format of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// What a camera sends.
    Pixels(Pixels),
    /// `index8`: places in a palette.
    Index8,
}

impl Format {
    /// Of 8 bits of luma; maps too.
    pub const GRAY8: Self = Self::Pixels(Pixels::Gray8);
    /// Of red, green, blue.
    pub const RGB888: Self = Self::Pixels(Pixels::Rgb888);

    /// All of them, in the order of their codes from 1 on.
    pub const ALL: [Self; 10] = [
        Self::Pixels(Pixels::Rgb888),
        Self::Pixels(Pixels::Rgb565Le),
        Self::Pixels(Pixels::Rgb565Be),
        Self::Pixels(Pixels::Gray8),
        Self::Pixels(Pixels::Yuyv),
        Self::Pixels(Pixels::Uyvy),
        Self::Pixels(Pixels::Raw8),
        Self::Pixels(Pixels::Raw10),
        Self::Pixels(Pixels::Raw12),
        Self::Index8,
    ];

    /// The number on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Pixels(Pixels::Rgb888) => 1,
            Self::Pixels(Pixels::Rgb565Le) => 2,
            Self::Pixels(Pixels::Rgb565Be) => 3,
            Self::Pixels(Pixels::Gray8) => 4,
            Self::Pixels(Pixels::Yuyv) => 5,
            Self::Pixels(Pixels::Uyvy) => 6,
            Self::Pixels(Pixels::Raw8) => 7,
            Self::Pixels(Pixels::Raw10) => 8,
            Self::Pixels(Pixels::Raw12) => 9,
            Self::Index8 => 10,
        }
    }

    /// The format with this number.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code).checked_sub(1)?).copied()
    }

    /// The name in small letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pixels(pixels) => pixels.name(),
            Self::Index8 => "index8",
        }
    }

    /// Bytes a pixel.
    #[must_use]
    pub const fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Pixels(pixels) => pixels.bytes_per_pixel(),
            Self::Index8 => 1,
        }
    }

    /// Pixels that stand and fall together.
    #[must_use]
    pub const fn unit_pixels(self) -> usize {
        match self {
            Self::Pixels(Pixels::Yuyv | Pixels::Uyvy) => 2,
            _ => 1,
        }
    }

    /// Bytes of them.
    #[must_use]
    pub const fn unit_bytes(self) -> usize {
        self.unit_pixels() * self.bytes_per_pixel()
    }

    /// Bytes of a line of `width` pixels.
    #[must_use]
    pub const fn line_bytes(self, width: usize) -> usize {
        width * self.bytes_per_pixel()
    }
}

/// How the pixels of a LINE are coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// As they are.
    Raw,
    /// Runs of equal units.
    RunLength,
    /// As in the Quite OK Image format; gray by small differences.
    Qoi,
    /// A bit a pixel: maps of 0 and 255.
    Bits,
    /// Runs of such bits.
    BitsRunLength,
}

impl Encoding {
    /// All of them, in the order of their codes from 0 on.
    pub const ALL: [Self; 5] = [Self::Raw, Self::RunLength, Self::Qoi, Self::Bits, Self::BitsRunLength];

    /// These as HELLO names them: bit *n* for the one whose number is *n*.
    #[must_use]
    pub fn bits(encodings: &[Self]) -> u16 {
        encodings.iter().fold(0, |bits, encoding| bits | 1 << encoding.code())
    }

    /// The number on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The encoding with this number.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// The name in small letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::RunLength => "run-length",
            Self::Qoi => "qoi",
            Self::Bits => "bits",
            Self::BitsRunLength => "bits-run-length",
        }
    }
}

/// Which encoding is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Choice {
    /// The sender takes for each line what is short.
    #[default]
    Sender,
    /// This one, and raw for lines that it makes no shorter.
    One(Encoding),
}

impl Choice {
    /// The number on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Sender => 15,
            Self::One(encoding) => encoding.code(),
        }
    }

    /// The choice with this number.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Self> {
        if code == Self::Sender.code() {
            Some(Self::Sender)
        } else {
            Encoding::from_code(code).map(Self::One)
        }
    }

    /// The name in small letters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sender => "auto",
            Self::One(encoding) => encoding.name(),
        }
    }

    /// The choice of that name, in any case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let all = Encoding::ALL.into_iter().map(Self::One).chain([Self::Sender]);
        all.into_iter().find(|choice| choice.name().eq_ignore_ascii_case(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_come_back() {
        for (at, format) in Format::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(format.code()), at + 1);
            assert_eq!(Format::from_code(format.code()), Some(format));
        }
        assert_eq!((Format::from_code(0), Format::from_code(11)), (None, None));
        for (at, encoding) in Encoding::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(encoding.code()), at);
            assert_eq!(Choice::from_code(encoding.code()), Some(Choice::One(encoding)));
            assert_eq!(Choice::from_name(encoding.name()), Some(Choice::One(encoding)));
        }
        assert_eq!(Choice::from_name("AUTO"), Choice::from_code(15));
        assert_eq!((Choice::from_code(5), Choice::from_name("x")), (None, None));
    }
}
