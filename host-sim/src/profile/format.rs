use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use algos_nostd::pixel::format::Meaning;
use firmware::camif::pins::Edge;

use super::{Choice, Frame};

impl Choice for Format {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("rgb888", Self::Rgb888),
        ("rgb565-be", Self::Rgb565Be),
        ("rgb565-le", Self::Rgb565Le),
        ("yuyv", Self::Yuyv),
        ("uyvy", Self::Uyvy),
        ("gray8", Self::Gray8),
        ("raw8", Self::Raw8),
        ("raw10", Self::Raw10),
        ("raw12", Self::Raw12),
    ];
}

impl Choice for BayerOrder {
    const NAMES: &'static [(&'static str, Self)] =
        &[("rggb", Self::Rggb), ("bggr", Self::Bggr), ("grbg", Self::Grbg), ("gbrg", Self::Gbrg)];
}

impl Choice for Edge {
    const NAMES: &'static [(&'static str, Self)] = &[("rising", Self::Rising), ("falling", Self::Falling)];
}

impl Frame {
    /// Samples, that is pixel clocks that carry data, a pixel.
    #[must_use]
    pub const fn samples_per_pixel(&self) -> u32 {
        match self.format {
            Format::Rgb888 => 3,
            Format::Rgb565Be | Format::Rgb565Le | Format::Yuyv | Format::Uyvy => 2,
            Format::Gray8 | Format::Raw8 | Format::Raw10 | Format::Raw12 => 1,
        }
    }

    /// Bits of a sample.
    #[must_use]
    pub const fn sample_bits(&self) -> u32 {
        match self.format {
            Format::Raw10 => 10,
            Format::Raw12 => 12,
            _ => 8,
        }
    }

    /// Whether each pixel has one colour only, so that the order of the mosaic matters.
    #[must_use]
    pub const fn is_bayer(&self) -> bool {
        matches!(self.format, Format::Raw8 | Format::Raw10 | Format::Raw12)
    }

    /// Whether two pixels share their colour, so that a line holds an even number of pixels.
    #[must_use]
    pub const fn is_yuv422(&self) -> bool {
        matches!(self.format, Format::Yuyv | Format::Uyvy)
    }

    /// What the format's name leaves open: this frame's mosaic, and YUV as sensors mean it (BT.601, limited range).
    #[must_use]
    pub fn meaning(&self) -> Meaning {
        Meaning { bayer: self.bayer, ..Meaning::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_are_the_names_of_the_formats() {
        assert_eq!(<Format as Choice>::NAMES.len(), Format::ALL.len());
        for format in Format::ALL {
            assert_eq!(Choice::name(format), format.name());
        }
        for order in BayerOrder::ALL {
            assert_eq!(Choice::name(order), order.name());
        }
    }

    #[test]
    fn samples_are_bytes_but_for_wide_ones() {
        for format in Format::ALL {
            let frame = Frame { width: 2, height: 1, format, bayer: BayerOrder::Rggb };
            let bytes = frame.samples_per_pixel() * if frame.sample_bits() > 8 { 2 } else { 1 };
            assert_eq!(bytes as usize, format.bytes_per_pixel());
        }
    }
}
