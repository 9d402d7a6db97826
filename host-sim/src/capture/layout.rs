//! How pixels stand in the memory of a capture device, by the codes of V4L2.
//!
//! Source: the Linux kernel's *Video for Linux API*, part I, chapter 2, *Image Formats*.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use v4l2_capture::FourCc;

/// How pixels stand in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// As the camera interface leaves them: `algos-nostd` decodes a line.
    Bus(Format),
    /// A word a pixel, of fields of bits.
    Packed(Packed),
    /// Two pixels in four bytes; where Y0, Cb, Y1 and Cr stand.
    Yuv422([usize; 4]),
    /// Luma in a plane, chroma in one or two others.
    Planar(Planar),
    /// Luma of more than 8 bits in a word of 16.
    DeepGray {
        /// Bits that count, right-aligned.
        bits: u32,
        /// High byte first.
        big_endian: bool,
    },
    /// A mosaic.
    Bayer {
        /// Which colour is where.
        order: BayerOrder,
        /// How a sample stands.
        samples: Samples,
    },
    /// A JPEG picture a frame.
    Jpeg,
}

/// A word a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packed {
    /// Bytes of the word: 1 to 4.
    pub bytes: usize,
    /// High byte first.
    pub big_endian: bool,
    /// Shift and width of each channel.
    pub fields: [(u32, u32); 3],
    /// What the channels mean.
    pub space: Space,
}

/// What three channels mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Red, green, blue.
    Rgb,
    /// Luma, blue difference, red difference.
    Yuv,
    /// Hue, saturation, value.
    Hsv,
}

/// Luma and chroma apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Planar {
    /// Binary logarithm of the pixels across and down that share chroma.
    pub shared: (u32, u32),
    /// Cb and Cr are pairs in one plane.
    pub pairs: bool,
    /// Cr stands before Cb.
    pub red_first: bool,
}

/// How a sample of a mosaic stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// A byte.
    Bytes,
    /// So many bits, right-aligned in 16, low byte first.
    Words(u32),
    /// Four of ten bits in five bytes, as on MIPI CSI-2.
    Mipi10,
    /// Two of twelve bits in three bytes.
    Mipi12,
}

const fn word(bytes: usize, big_endian: bool, space: Space, fields: [(u32, u32); 3]) -> Layout {
    Layout::Packed(Packed { bytes, big_endian, fields, space })
}

const fn rgb(bytes: usize, fields: [(u32, u32); 3]) -> Layout {
    word(bytes, false, Space::Rgb, fields)
}

const fn rgb_big(bytes: usize, fields: [(u32, u32); 3]) -> Layout {
    word(bytes, true, Space::Rgb, fields)
}

const fn yuv(bytes: usize, fields: [(u32, u32); 3]) -> Layout {
    word(bytes, false, Space::Yuv, fields)
}

const fn planar(across: u32, down: u32, red_first: bool) -> Layout {
    Layout::Planar(Planar { shared: (across, down), pairs: false, red_first })
}

const fn pairs(across: u32, down: u32, red_first: bool) -> Layout {
    Layout::Planar(Planar { shared: (across, down), pairs: true, red_first })
}

const fn gray(bits: u32, big_endian: bool) -> Layout {
    Layout::DeepGray { bits, big_endian }
}

const fn bayer(order: BayerOrder, samples: Samples) -> Layout {
    Layout::Bayer { order, samples }
}

/// Three fields of 8 bits, by the bits at which they begin.
const fn eights(first: u32, second: u32, third: u32) -> [(u32, u32); 3] {
    [(first, 8), (second, 8), (third, 8)]
}

const fn fours(first: u32, second: u32, third: u32) -> [(u32, u32); 3] {
    [(first, 4), (second, 4), (third, 4)]
}

const fn fives(first: u32, second: u32, third: u32) -> [(u32, u32); 3] {
    [(first, 5), (second, 5), (third, 5)]
}

use BayerOrder::{Bggr, Gbrg, Grbg, Rggb};
use Samples::{Bytes, Mipi10, Mipi12, Words};

/// The codes that become pictures, those first that a device is best asked for: whole pixels, then YUV, then mosaics, then
/// what is compressed.
#[rustfmt::skip]
const LAYOUTS: &[(&str, Layout)] = &[
    ("RGB3", Layout::Bus(Format::Rgb888)),
    ("BGR3", rgb(3, eights(16, 8, 0))),
    ("YUYV", Layout::Bus(Format::Yuyv)), ("UYVY", Layout::Bus(Format::Uyvy)),
    ("YVYU", Layout::Yuv422([0, 3, 2, 1])), ("VYUY", Layout::Yuv422([1, 2, 3, 0])),
    ("NV12", pairs(1, 1, false)), ("NV21", pairs(1, 1, true)),
    ("NM12", pairs(1, 1, false)), ("NM21", pairs(1, 1, true)),
    ("NV16", pairs(1, 0, false)), ("NV61", pairs(1, 0, true)),
    ("NM16", pairs(1, 0, false)), ("NM61", pairs(1, 0, true)),
    ("NV24", pairs(0, 0, false)), ("NV42", pairs(0, 0, true)),
    ("YU12", planar(1, 1, false)), ("YV12", planar(1, 1, true)),
    ("YM12", planar(1, 1, false)), ("YM21", planar(1, 1, true)),
    ("422P", planar(1, 0, false)),
    ("YM16", planar(1, 0, false)), ("YM61", planar(1, 0, true)),
    ("YM24", planar(0, 0, false)), ("YM42", planar(0, 0, true)),
    ("XR24", rgb(4, eights(16, 8, 0))), ("AR24", rgb(4, eights(16, 8, 0))), ("BGR4", rgb(4, eights(16, 8, 0))),
    ("XB24", rgb(4, eights(0, 8, 16))), ("AB24", rgb(4, eights(0, 8, 16))),
    ("BX24", rgb(4, eights(8, 16, 24))), ("BA24", rgb(4, eights(8, 16, 24))), ("RGB4", rgb(4, eights(8, 16, 24))),
    ("RX24", rgb(4, eights(24, 16, 8))), ("RA24", rgb(4, eights(24, 16, 8))),
    ("RGBP", Layout::Bus(Format::Rgb565Le)), ("RGBR", Layout::Bus(Format::Rgb565Be)),
    ("YUV4", yuv(4, eights(8, 16, 24))), ("AYUV", yuv(4, eights(8, 16, 24))), ("XYUV", yuv(4, eights(8, 16, 24))),
    ("VUYA", yuv(4, eights(16, 8, 0))), ("VUYX", yuv(4, eights(16, 8, 0))),
    ("YUVA", yuv(4, eights(0, 8, 16))), ("YUVX", yuv(4, eights(0, 8, 16))), ("YUV3", yuv(3, eights(0, 8, 16))),
    ("GREY", Layout::Bus(Format::Gray8)),
    ("Y10", gray(10, false)), ("Y12", gray(12, false)), ("Y14", gray(14, false)),
    ("Y16", gray(16, false)), ("Y16-BE", gray(16, true)),
    ("BA81", bayer(Bggr, Bytes)), ("GBRG", bayer(Gbrg, Bytes)), ("GRBG", bayer(Grbg, Bytes)), ("RGGB", bayer(Rggb, Bytes)),
    ("BG10", bayer(Bggr, Words(10))), ("GB10", bayer(Gbrg, Words(10))), ("BA10", bayer(Grbg, Words(10))), ("RG10", bayer(Rggb, Words(10))),
    ("BG12", bayer(Bggr, Words(12))), ("GB12", bayer(Gbrg, Words(12))), ("BA12", bayer(Grbg, Words(12))), ("RG12", bayer(Rggb, Words(12))),
    ("BG14", bayer(Bggr, Words(14))), ("GB14", bayer(Gbrg, Words(14))), ("GR14", bayer(Grbg, Words(14))), ("RG14", bayer(Rggb, Words(14))),
    ("BYR2", bayer(Bggr, Words(16))), ("GB16", bayer(Gbrg, Words(16))), ("GR16", bayer(Grbg, Words(16))), ("RG16", bayer(Rggb, Words(16))),
    ("pBAA", bayer(Bggr, Mipi10)), ("pGAA", bayer(Gbrg, Mipi10)), ("pgAA", bayer(Grbg, Mipi10)), ("pRAA", bayer(Rggb, Mipi10)),
    ("pBCC", bayer(Bggr, Mipi12)), ("pGCC", bayer(Gbrg, Mipi12)), ("pgCC", bayer(Grbg, Mipi12)), ("pRCC", bayer(Rggb, Mipi12)),
    ("BGRH", rgb_big(4, [(14, 6), (20, 6), (26, 6)])),
    ("RGBO", rgb(2, fives(10, 5, 0))), ("XR15", rgb(2, fives(10, 5, 0))), ("AR15", rgb(2, fives(10, 5, 0))),
    ("XB15", rgb(2, fives(0, 5, 10))), ("AB15", rgb(2, fives(0, 5, 10))),
    ("RX15", rgb(2, fives(11, 6, 1))), ("RA15", rgb(2, fives(11, 6, 1))),
    ("BX15", rgb(2, fives(1, 6, 11))), ("BA15", rgb(2, fives(1, 6, 11))),
    ("RGBQ", rgb_big(2, fives(10, 5, 0))), ("XR15-BE", rgb_big(2, fives(10, 5, 0))), ("AR15-BE", rgb_big(2, fives(10, 5, 0))),
    ("YUVO", yuv(2, fives(10, 5, 0))), ("YUVP", yuv(2, [(11, 5), (5, 6), (0, 5)])), ("Y444", yuv(2, fours(8, 4, 0))),
    ("R444", rgb(2, fours(8, 4, 0))), ("XR12", rgb(2, fours(8, 4, 0))), ("AR12", rgb(2, fours(8, 4, 0))),
    ("XB12", rgb(2, fours(0, 4, 8))), ("AB12", rgb(2, fours(0, 4, 8))),
    ("RX12", rgb(2, fours(12, 8, 4))), ("RA12", rgb(2, fours(12, 8, 4))),
    ("BX12", rgb(2, fours(4, 8, 12))), ("GA12", rgb(2, fours(4, 8, 12))),
    ("RGB1", rgb(1, [(5, 3), (2, 3), (0, 2)])),
    ("HSV3", word(3, false, Space::Hsv, eights(0, 8, 16))), ("HSV4", word(4, false, Space::Hsv, eights(8, 16, 24))),
    ("MJPG", Layout::Jpeg), ("JPEG", Layout::Jpeg),
];

impl Layout {
    /// The layout of a code; `None` if it does not become a picture here.
    #[must_use]
    pub fn of(code: FourCc) -> Option<Self> {
        LAYOUTS.iter().find(|(name, _)| FourCc::parse(name) == Some(code)).map(|(_, layout)| *layout)
    }

    /// All codes that become pictures, those first that a device is best asked for.
    pub fn codes() -> impl Iterator<Item = FourCc> {
        LAYOUTS.iter().filter_map(|(name, _)| FourCc::parse(name))
    }

    /// Bytes of a line of `width` pixels in the first plane, without what may follow to the start of the next.
    #[must_use]
    pub fn line_bytes(self, width: usize) -> usize {
        match self {
            // Two pixels share chroma, so an odd one takes a pair's place.
            Self::Bus(format @ (Format::Yuyv | Format::Uyvy)) => format.line_bytes(width.next_multiple_of(2)),
            Self::Bus(format) => format.line_bytes(width),
            Self::Packed(packed) => packed.bytes * width,
            Self::Yuv422(_) => 2 * width.next_multiple_of(2),
            Self::Planar(_) | Self::Bayer { samples: Bytes, .. } => width,
            Self::DeepGray { .. } | Self::Bayer { samples: Words(_), .. } => 2 * width,
            Self::Bayer { samples: Mipi10, .. } => (10 * width).div_ceil(8),
            Self::Bayer { samples: Mipi12, .. } => (12 * width).div_ceil(8),
            Self::Jpeg => 0,
        }
    }

    /// The same frame as a camera interface would have it, if it has such a format, and which mosaic that is.
    #[must_use]
    pub fn as_bus(self) -> Option<(Format, Option<BayerOrder>)> {
        match self {
            Self::Bus(format) => Some((format, None)),
            Self::Bayer { order, samples: Bytes } => Some((Format::Raw8, Some(order))),
            Self::Bayer { order, samples: Words(10) } => Some((Format::Raw10, Some(order))),
            Self::Bayer { order, samples: Words(12) } => Some((Format::Raw12, Some(order))),
            _ => None,
        }
    }
}

impl Planar {
    /// Bytes of a line and lines of a chroma plane under a luma plane of `width` × `height`.
    #[must_use]
    pub fn chroma_size(self, (width, height): (usize, usize)) -> (usize, usize) {
        let (across, down) = self.shared;
        let samples = width.div_ceil(1 << across);
        (if self.pairs { 2 * samples } else { samples }, height.div_ceil(1 << down))
    }

    /// Bytes from line to line of a chroma plane that follows a luma plane with this stride.
    #[must_use]
    pub fn chroma_stride(self, stride: usize) -> usize {
        let across = stride >> self.shared.0;
        if self.pairs { 2 * across } else { across }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_written_right_and_once() {
        for (index, (name, layout)) in LAYOUTS.iter().enumerate() {
            let code = FourCc::parse(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(code.to_string(), *name);
            assert_eq!(Layout::of(code), Some(*layout));
            assert!(LAYOUTS[..index].iter().all(|(other, _)| other != name), "{name} stands twice");
        }
        assert_eq!(Layout::of(FourCc::new(b"H264")), None);
        assert_eq!(Layout::codes().next(), Some(FourCc::new(b"RGB3")));
    }

    #[test]
    fn fields_lie_within_their_word_and_apart() {
        for (name, layout) in LAYOUTS {
            if let Layout::Packed(packed) = layout {
                let masks = packed.fields.map(|(shift, width)| ((1u64 << width) - 1) << shift);
                assert!(masks.iter().all(|mask| *mask < 1 << (8 * packed.bytes)), "{name}");
                assert_eq!(masks[0] & masks[1] | masks[1] & masks[2] | masks[0] & masks[2], 0, "{name}");
            }
        }
    }

    #[test]
    fn lines_and_chroma_are_rounded_up() {
        let line = |name, width| Layout::of(FourCc::parse(name).unwrap()).unwrap().line_bytes(width);
        assert_eq!(
            ["YUYV", "YVYU", "RGB3", "pBAA", "pBCC", "Y16"].map(|name| line(name, 5)),
            [12, 12, 15, 7, 8, 10]
        );
        let Layout::Planar(nv12) = pairs(1, 1, false) else { panic!() };
        assert_eq!((nv12.chroma_size((5, 3)), nv12.chroma_stride(64)), ((6, 2), 64));
        let Layout::Planar(yu12) = planar(1, 1, false) else { panic!() };
        assert_eq!((yu12.chroma_size((5, 3)), yu12.chroma_stride(64)), ((3, 2), 32));
        let Layout::Planar(nv24) = pairs(0, 0, false) else { panic!() };
        assert_eq!((nv24.chroma_size((5, 3)), nv24.chroma_stride(64)), ((10, 3), 128));
    }
}
