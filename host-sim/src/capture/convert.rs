//! Frames as devices leave them in memory become pictures, in one pass from the mapped memory.

use std::borrow::Cow;

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::{Format, Meaning};
use algos_nostd::pixel::yuv422::Coefficients;
use image::{ImageFormat, RgbImage};
use rgb::{FromSlice as _, RGB8};

use super::device::FrameFormat;
use super::layout::{Layout, Packed, Planar, Samples, Space};
use crate::picture::demosaic;

/// Why a frame does not become a picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameFault {
    /// The device wrote less than a frame.
    #[error("{got} bytes, where a frame has {needed}")]
    Short {
        /// Bytes of a frame.
        needed: usize,
        /// Bytes written.
        got: usize,
    },
    /// What should be a JPEG picture is none, or is broken.
    #[error("not a whole JPEG picture: {0}")]
    Jpeg(String),
    /// Nothing is known of the pixel format.
    #[error(
        "the pixel format {0} is captured as raw bytes only; ask for another with --format, --list says which there are"
    )]
    Unknown(String),
}

/// Makes pictures of the frames of one format. What it needs beside them is kept from frame to frame.
#[derive(Debug)]
pub struct Converter {
    format: FrameFormat,
    layout: Option<Layout>,
    coefficients: Coefficients,
    picture: RgbImage,
    samples: Vec<u8>,
}

/// A plane of a frame: its bytes and those from line to line.
#[derive(Clone, Copy, Debug)]
struct Plane<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Plane<'a> {
    /// Line `y` of `length` bytes.
    fn line(self, y: usize, length: usize) -> &'a [u8] {
        &self.bytes[y * self.stride..][..length]
    }
}

impl Converter {
    /// For frames of this format.
    #[must_use]
    pub fn new(format: &FrameFormat) -> Self {
        let layout = Layout::of(format.code);
        let (width, height) = if layout.is_some() { (format.width, format.height) } else { (0, 0) };
        Self {
            layout,
            coefficients: format.yuv.coefficients(),
            picture: RgbImage::new(width, height),
            samples: Vec::new(),
            format: format.clone(),
        }
    }

    /// Whether the device wrote a whole frame, as far as that can be known from its format.
    ///
    /// # Errors
    /// [`FrameFault::Short`] if it wrote less.
    pub fn check(&self, planes: &[&[u8]]) -> Result<(), FrameFault> {
        let total = planes.iter().map(|plane| plane.len()).sum();
        let short = |needed, got| Err(FrameFault::Short { needed, got });
        let Some(layout) = self.layout else {
            return if total == 0 { short(1, 0) } else { Ok(()) };
        };
        let (width, height) = self.format.size();
        let plane_bytes = |stride: usize, line: usize, lines: usize| (lines - 1) * stride + line;
        let first = plane_bytes(self.stride(0), layout.line_bytes(width), height);
        match layout {
            Layout::Jpeg if total < 4 => short(4, total),
            Layout::Jpeg => Ok(()),
            Layout::Planar(planar) => {
                let (line, lines) = planar.chroma_size((width, height));
                let chroma_planes = if planar.pairs { 1 } else { 2 };
                if planes.len() > chroma_planes {
                    let needed = std::iter::once(first)
                        .chain((1..=chroma_planes).map(|index| plane_bytes(self.stride(index), line, lines)));
                    let missing = needed.zip(planes).find(|(needed, plane)| plane.len() < *needed);
                    return missing.map_or(Ok(()), |(needed, plane)| short(needed, plane.len()));
                }
                let stride = planar.chroma_stride(self.stride(0));
                let needed = self.stride(0) * height
                    + stride * lines * (chroma_planes - 1)
                    + plane_bytes(stride, line, lines);
                if total < needed { short(needed, total) } else { Ok(()) }
            }
            _ if total < first => short(first, total),
            _ => Ok(()),
        }
    }

    /// The picture of a frame.
    ///
    /// # Errors
    /// [`FrameFault`]; the next frame may be good.
    pub fn picture(&mut self, planes: &[&[u8]]) -> Result<&RgbImage, FrameFault> {
        self.check(planes)?;
        let Some(layout) = self.layout else {
            return Err(FrameFault::Unknown(self.format.code.to_string()));
        };
        let all = Plane { bytes: planes.first().copied().unwrap_or_default(), stride: self.stride(0) };
        let (width, height) = self.format.size();
        let length = layout.line_bytes(width);
        match layout {
            Layout::Jpeg => {
                self.picture = jpeg(all.bytes)?;
                return Ok(&self.picture);
            }
            Layout::Planar(planar) => self.planar(planar, planes),
            Layout::Bus(Format::Raw8) | Layout::Bayer { samples: Samples::Bytes, .. }
                if all.stride == width =>
            {
                // Without a gap the frame is the mosaic as it stands.
                let order = match layout {
                    Layout::Bayer { order, .. } => order,
                    _ => BayerOrder::Rggb,
                };
                let mut rows: Vec<&mut [RGB8]> = self.picture.as_rgb_mut().chunks_mut(width).collect();
                demosaic(&all.bytes[..width * height], order, &mut rows);
            }
            Layout::Bayer { order, samples } => {
                self.samples.clear();
                for y in 0..height {
                    eight_bits(samples, all.line(y, length), width, &mut self.samples);
                }
                let mut rows: Vec<&mut [RGB8]> = self.picture.as_rgb_mut().chunks_mut(width).collect();
                demosaic(&self.samples, order, &mut rows);
            }
            _ => {
                let coefficients = self.coefficients;
                for (y, row) in self.picture.as_rgb_mut().chunks_exact_mut(width).enumerate() {
                    line(layout, &coefficients, self.format.yuv.whole_hue, all.line(y, length), row);
                }
            }
        }
        Ok(&self.picture)
    }

    /// The frame without gaps between lines, as a camera interface leaves it; only of formats that it has. Nothing is
    /// copied where there are no gaps.
    #[must_use]
    pub fn as_bus<'a>(&self, planes: &[&'a [u8]]) -> Option<Cow<'a, [u8]>> {
        let layout = self.layout?;
        layout.as_bus()?;
        self.check(planes).ok()?;
        let all = Plane { bytes: planes.first()?, stride: self.stride(0) };
        let (width, height) = self.format.size();
        let length = layout.line_bytes(width);
        if all.stride == length {
            return Some(Cow::Borrowed(&all.bytes[..length * height]));
        }
        Some(Cow::Owned((0..height).flat_map(|y| all.line(y, length)).copied().collect()))
    }

    fn stride(&self, plane: usize) -> usize {
        let stride = |index: usize| self.format.strides.get(index).map_or(0, |&stride| stride as usize);
        let (width, _) = self.format.size();
        let least = |layout: Layout| layout.line_bytes(width);
        let Some(layout) = self.layout else { return stride(0) };
        // A driver that gives no stride means lines without a gap.
        let first = stride(0).max(least(layout));
        match layout {
            _ if plane == 0 => first,
            Layout::Planar(planar) => {
                let (line, _) = planar.chroma_size(self.format.size());
                let own = stride(plane);
                (if own == 0 { planar.chroma_stride(first) } else { own }).max(line)
            }
            _ => first,
        }
    }

    fn planar(&mut self, planar: Planar, planes: &[&[u8]]) {
        let (width, height) = self.format.size();
        let luma = Plane { bytes: planes[0], stride: self.stride(0) };
        let (line, lines) = planar.chroma_size((width, height));
        let apart = planes.len() > if planar.pairs { 1 } else { 2 };
        let chroma = |index: usize| {
            if apart {
                return Plane { bytes: planes[index], stride: self.stride(index) };
            }
            let stride = planar.chroma_stride(luma.stride);
            Plane { bytes: &planes[0][luma.stride * height + stride * lines * (index - 1)..], stride }
        };
        let (first, second) = (chroma(1), if planar.pairs { chroma(1) } else { chroma(2) });
        let (across, down) = planar.shared;
        let coefficients = self.coefficients;
        for (y, row) in self.picture.as_rgb_mut().chunks_exact_mut(width).enumerate() {
            let luma = luma.line(y, width);
            let (one, two) = (first.line(y >> down, line), second.line(y >> down, line));
            let chroma = |sample: usize| {
                let (one, two) = if planar.pairs {
                    (one[2 * sample], one[2 * sample + 1])
                } else {
                    (one[sample], two[sample])
                };
                if planar.red_first { (two, one) } else { (one, two) }
            };
            let group = 1 << across;
            for (sample, (pixels, luma)) in row.chunks_mut(group).zip(luma.chunks(group)).enumerate() {
                let (cb, cr) = chroma(sample);
                for (pixel, &luma) in pixels.iter_mut().zip(luma) {
                    *pixel = coefficients.decode(luma, cb, cr);
                }
            }
        }
    }
}

/// A line of pixels that needs no other line.
fn line(layout: Layout, coefficients: &Coefficients, whole_hue: bool, bytes: &[u8], row: &mut [RGB8]) {
    match layout {
        Layout::Bus(Format::Yuyv) if !row.len().is_multiple_of(2) => {
            yuv422([0, 1, 2, 3], coefficients, bytes, row);
        }
        Layout::Bus(Format::Uyvy) if !row.len().is_multiple_of(2) => {
            yuv422([1, 0, 3, 2], coefficients, bytes, row);
        }
        Layout::Bus(format) => {
            let meaning = Meaning { yuv: *coefficients, ..Meaning::default() };
            // The lengths are right by construction.
            let _ = format.decode_line(bytes, row, &meaning);
        }
        Layout::Yuv422(order) => yuv422(order, coefficients, bytes, row),
        Layout::Packed(layout) => packed(layout, coefficients, whole_hue, bytes, row),
        Layout::DeepGray { bits, big_endian } => {
            let (words, _) = bytes.as_chunks::<2>();
            for (pixel, &word) in row.iter_mut().zip(words) {
                let word = if big_endian { u16::from_be_bytes(word) } else { u16::from_le_bytes(word) };
                let gray = (word >> (bits - 8)).min(255) as u8;
                *pixel = RGB8::new(gray, gray, gray);
            }
        }
        Layout::Planar(_) | Layout::Bayer { .. } | Layout::Jpeg => {}
    }
}

fn yuv422([y0, cb, y1, cr]: [usize; 4], coefficients: &Coefficients, bytes: &[u8], row: &mut [RGB8]) {
    let (groups, _) = bytes.as_chunks::<4>();
    for (pair, group) in row.chunks_mut(2).zip(groups) {
        for (pixel, luma) in pair.iter_mut().zip([y0, y1]) {
            *pixel = coefficients.decode(group[luma], group[cb], group[cr]);
        }
    }
}

fn packed(layout: Packed, coefficients: &Coefficients, whole_hue: bool, bytes: &[u8], row: &mut [RGB8]) {
    // Each width's 8 bits, so that there is no division a pixel.
    let tables = layout.fields.map(|(_, width)| {
        let greatest = (1u32 << width) - 1;
        std::array::from_fn::<u8, 256, _>(|value| {
            ((value as u32 * 255 + greatest / 2) / greatest).min(255) as u8
        })
    });
    for (pixel, word) in row.iter_mut().zip(bytes.chunks_exact(layout.bytes)) {
        let mut wide = [0; 4];
        if layout.big_endian {
            wide[4 - layout.bytes..].copy_from_slice(word);
        } else {
            wide[..layout.bytes].copy_from_slice(word);
        }
        let word = if layout.big_endian { u32::from_be_bytes(wide) } else { u32::from_le_bytes(wide) };
        let channel = |index: usize| {
            let (shift, width) = layout.fields[index];
            tables[index][(word >> shift & ((1 << width) - 1)) as usize]
        };
        let [a, b, c] = [channel(0), channel(1), channel(2)];
        *pixel = match layout.space {
            Space::Rgb => RGB8::new(a, b, c),
            Space::Yuv => coefficients.decode(a, b, c),
            Space::Hsv => hsv(a, b, c, whole_hue),
        };
    }
}

/// The colour of hue, saturation and value. Hue is a turn in 256 steps, or in 180 of two degrees.
fn hsv(hue: u8, saturation: u8, value: u8, whole_hue: bool) -> RGB8 {
    let turn = if whole_hue { 256 } else { 180 };
    // In 1,536ths of a turn: six sixths of 256.
    let hue = u32::from(hue) * 1536 / turn % 1536;
    let (sixth, within) = (hue / 256, hue % 256);
    let scaled = |part: u32| {
        ((u32::from(value) * (255 * 256 - u32::from(saturation) * part) + 255 * 128) / (255 * 256)) as u8
    };
    let (least, falling, rising) = (scaled(256), scaled(within), scaled(256 - within));
    let (r, g, b) = match sixth {
        0 => (value, rising, least),
        1 => (falling, value, least),
        2 => (least, value, rising),
        3 => (least, falling, value),
        4 => (rising, least, value),
        _ => (value, least, falling),
    };
    RGB8::new(r, g, b)
}

/// A line of a mosaic, the high 8 bits of each sample.
fn eight_bits(samples: Samples, line: &[u8], width: usize, out: &mut Vec<u8>) {
    match samples {
        Samples::Bytes => out.extend_from_slice(line),
        Samples::Words(bits) => {
            let (words, _) = line.as_chunks::<2>();
            out.extend(words.iter().map(|&word| (u16::from_le_bytes(word) >> (bits - 8)).min(255) as u8));
        }
        // The low bits of a group stand in its last byte.
        Samples::Mipi10 => out.extend((0..width).map(|x| line[x / 4 * 5 + x % 4])),
        Samples::Mipi12 => out.extend((0..width).map(|x| line[x / 2 * 3 + x % 2])),
    }
}

/// A picture out of JPEG bytes, with whatever follows its end.
fn jpeg(bytes: &[u8]) -> Result<RgbImage, FrameFault> {
    let broken = |error: image::ImageError| FrameFault::Jpeg(error.to_string());
    let bytes = with_tables(bytes);
    Ok(image::load_from_memory_with_format(&bytes, ImageFormat::Jpeg).map_err(broken)?.into_rgb8())
}

/// Many webcams leave the Huffman tables out, because they are always those of ITU-T T.81, annex K; decoders take these
/// where the frame is marked `AVI1`, so it is marked.
fn with_tables(bytes: &[u8]) -> Cow<'_, [u8]> {
    const MARK: [u8; 18] = [0xFF, 0xE0, 0, 16, b'A', b'V', b'I', b'1', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    let Some(rest) = bytes.strip_prefix(&[0xFF, 0xD8]) else { return Cow::Borrowed(bytes) };
    let mut at = 0;
    // Segments up to the start of the scan.
    while let Some([0xFF, marker, high, low]) = rest.get(at..at + 4) {
        match marker {
            0xC4 => return Cow::Borrowed(bytes),
            0xDA => break,
            _ => at += 2 + usize::from(u16::from_be_bytes([*high, *low])),
        }
    }
    Cow::Owned([&bytes[..2], &MARK, rest].concat())
}

#[cfg(test)]
#[path = "convert_tests.rs"]
mod tests;
