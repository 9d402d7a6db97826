use algos_nostd::pixel::format::Format;
use algos_nostd::pixel::raw;
use algos_nostd::pixel::{BitDepth, ByteOrder};
use image::RgbImage;
use rgb::FromSlice;

use super::demosaic::demosaic;
use crate::profile::Profile;

/// A picture made of a frame's bytes, and how much of it was there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoded {
    /// The picture, of the profile's size. Pixels that lack bytes are a magenta and black checker.
    pub picture: RgbImage,
    /// Bytes that the frame lacks.
    pub missing_bytes: u64,
    /// Bytes beyond the frame, which are not looked at.
    pub extra_bytes: u64,
}

impl Decoded {
    /// Whether the bytes were a frame, no less and no more.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.missing_bytes == 0 && self.extra_bytes == 0
    }
}

/// What stands where bytes are missing: squares of eight pixels in a colour that scenes do not have.
fn missing(x: usize, y: usize) -> rgb::RGB8 {
    if (x / 8 + y / 8).is_multiple_of(2) { rgb::RGB8::new(255, 0, 255) } else { rgb::RGB8::new(0, 0, 0) }
}

/// Makes a picture of a frame's bytes as DMA wrote them (see [`encode`](super::encode)).
///
/// Bytes may be missing at the end or be too many; [`Decoded`] says how many. Samples of RAW formats are brought to 8
/// bits and demosaiced; bits above their depth are ignored. The profile must have passed [`Profile::check`].
#[must_use]
pub fn decode(bytes: &[u8], profile: &Profile) -> Decoded {
    let frame = &profile.frame;
    let (width, height) = (frame.width as usize, frame.height as usize);
    let line = frame.format.line_bytes(width);
    let needed = line * height;
    let mut picture = RgbImage::new(frame.width, frame.height);

    let mut rows: Vec<&mut [rgb::RGB8]> = picture.as_rgb_mut().chunks_mut(width.max(1)).collect();
    let mut scratch = vec![0; line];
    if frame.is_bayer() {
        let mut samples = vec![0u8; width * height];
        for (y, samples) in samples.chunks_mut(width.max(1)).enumerate() {
            eight_bits(frame.format, padded(bytes, y, &mut scratch), samples);
        }
        demosaic(&samples, frame.bayer, &mut rows);
    } else {
        let meaning = frame.meaning();
        for (y, row) in rows.iter_mut().enumerate() {
            // The lengths are right by construction, and a checked profile has no odd line of YUV.
            let _ = frame.format.decode_line(padded(bytes, y, &mut scratch), row, &meaning);
        }
    }
    if bytes.len() < needed {
        for (y, row) in rows.iter_mut().enumerate() {
            let there = bytes.len().saturating_sub(y * line).min(line);
            let whole = whole_pixels(frame.format, there);
            for (x, pixel) in row.iter_mut().enumerate().skip(whole) {
                *pixel = missing(x, y);
            }
        }
    }
    Decoded {
        picture,
        missing_bytes: needed.saturating_sub(bytes.len()) as u64,
        extra_bytes: bytes.len().saturating_sub(needed) as u64,
    }
}

/// Pixels that the first `there` bytes of a line are enough for.
fn whole_pixels(format: Format, there: usize) -> usize {
    match format {
        // Two pixels share four bytes.
        Format::Yuyv | Format::Uyvy => there / 4 * 2,
        _ => there / format.bytes_per_pixel(),
    }
}

/// Line `y` of the frame, zeros in the place of missing bytes; `scratch` is a line long.
fn padded<'a>(bytes: &'a [u8], y: usize, scratch: &'a mut [u8]) -> &'a [u8] {
    let start = (y * scratch.len()).min(bytes.len());
    let rest = &bytes[start..];
    if let Some(line) = rest.get(..scratch.len()) {
        return line;
    }
    let (there, lacking) = scratch.split_at_mut(rest.len());
    there.copy_from_slice(rest);
    lacking.fill(0);
    scratch
}

/// A line of RAW bytes as samples of 8 bits.
fn eight_bits(format: Format, line: &[u8], samples: &mut [u8]) {
    let depth = match format {
        Format::Raw10 => BitDepth::Bits10,
        Format::Raw12 => BitDepth::Bits12,
        _ => return samples.copy_from_slice(line),
    };
    let mut words = vec![0u16; samples.len()];
    // The lengths are right by construction.
    let _ = raw::decode_line16(line, &mut words, ByteOrder::LittleEndian, depth);
    let _ = raw::reduce_line(&words, samples, depth);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::encode;
    use crate::profile::Choice as _;
    use crate::scene::Scene;

    fn profile_of(format: Format, width: u32, height: u32) -> Profile {
        let bits = match format {
            Format::Raw10 => 10,
            Format::Raw12 => 12,
            _ => 8,
        };
        let name = format.name();
        Profile::from_toml(&format!(
            "[bus]\nbits = {bits}\n[frame]\nwidth = {width}\nheight = {height}\nformat = \"{name}\"\nbayer = \"gbrg\""
        ))
        .unwrap()
    }

    /// Encoding loses what the format cannot hold and no more.
    #[test]
    fn every_format_gives_the_picture_back_within_its_bound() {
        for &(name, format) in Format::NAMES {
            let profile = profile_of(format, 64, 48);
            // Pairs of equal pixels, so that shared chroma loses nothing but its rounding.
            let pairs = Scene::Noise { seed: 4 }.render(0, 32, 48);
            let picture = RgbImage::from_fn(64, 48, |x, y| *pairs.get_pixel(x / 2, y));
            let decoded = decode(&encode(&picture, &profile).unwrap(), &profile);
            assert!(decoded.is_whole());
            let error =
                picture.iter().zip(decoded.picture.iter()).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            let bound = match format {
                Format::Rgb888 => 0,
                // The low 3 bits of 8 are cut off.
                Format::Rgb565Be | Format::Rgb565Le => 7,
                // 8-bit YUV in limited range: rounding of chroma, times 2.02 for blue, and of luma, times 1.16.
                Format::Yuyv | Format::Uyvy => 3,
                // One of three colours is kept; see the tests below.
                Format::Gray8 | Format::Raw8 | Format::Raw10 | Format::Raw12 => continue,
            };
            assert!(error <= bound, "{name}: {error} > {bound}");
        }
    }

    #[test]
    fn gray_stays_gray() {
        for &(name, format) in Format::NAMES {
            let profile = profile_of(format, 16, 16);
            for level in [0, 1, 77, 128, 254, 255] {
                let picture = RgbImage::from_pixel(16, 16, image::Rgb([level; 3]));
                let decoded = decode(&encode(&picture, &profile).unwrap(), &profile).picture;
                let bound = match format {
                    Format::Rgb565Be | Format::Rgb565Le => 7,
                    Format::Yuyv | Format::Uyvy => 1,
                    _ => 0,
                };
                assert!(decoded.iter().all(|value| value.abs_diff(level) <= bound), "{name} at {level}");
            }
        }
    }

    #[test]
    fn a_mosaic_keeps_its_samples_and_even_colours() {
        for format in [Format::Raw8, Format::Raw10, Format::Raw12] {
            let profile = profile_of(format, 16, 16);
            let even = RgbImage::from_pixel(16, 16, image::Rgb([200, 90, 13]));
            assert_eq!(decode(&encode(&even, &profile).unwrap(), &profile).picture, even);
            let noise = Scene::Noise { seed: 5 }.render(0, 16, 16);
            let decoded = decode(&encode(&noise, &profile).unwrap(), &profile).picture;
            for (x, y, pixel) in noise.enumerate_pixels() {
                let channel = profile.frame.bayer.channel(x as usize, y as usize) as usize;
                assert_eq!(decoded.get_pixel(x, y).0[channel], pixel.0[channel], "{format:?} ({x}, {y})");
            }
        }
    }

    #[test]
    fn bits_above_the_depth_are_ignored() {
        let profile = profile_of(Format::Raw10, 4, 4);
        let picture = Scene::Noise { seed: 5 }.render(0, 4, 4);
        let mut bytes = encode(&picture, &profile).unwrap();
        let clean = decode(&bytes, &profile);
        bytes.iter_mut().skip(1).step_by(2).for_each(|high| *high |= 0xFC);
        assert_eq!(decode(&bytes, &profile), clean);
    }

    #[test]
    fn missing_bytes_are_marked_and_extra_ones_counted() {
        for &(name, format) in Format::NAMES {
            let profile = profile_of(format, 18, 9);
            let picture = RgbImage::from_pixel(18, 9, image::Rgb([9, 99, 199]));
            let bytes = encode(&picture, &profile).unwrap();
            let whole = decode(&bytes, &profile);
            let line = format.line_bytes(18);
            for length in [0, 1, line - 1, line, line + 5, bytes.len() - 1] {
                let short = decode(&bytes[..length], &profile);
                assert_eq!(short.missing_bytes, (bytes.len() - length) as u64);
                assert!(!short.is_whole());
                let there = length / line * 18 + whole_pixels(format, length % line);
                for (index, (got, pixel)) in short.picture.pixels().zip(whole.picture.pixels()).enumerate() {
                    let marker = missing(index % 18, index / 18);
                    if index >= there {
                        assert_eq!(
                            got.0,
                            [marker.r, marker.g, marker.b],
                            "{name}, {length} bytes, pixel {index}"
                        );
                    } else if !profile.frame.is_bayer() {
                        assert_eq!(got, pixel, "{name}, {length} bytes, pixel {index}");
                    }
                }
            }
            let mut more = bytes.clone();
            more.extend([1, 2, 3]);
            let long = decode(&more, &profile);
            assert_eq!((long.extra_bytes, &long.picture), (3, &whole.picture));
        }
    }
}
