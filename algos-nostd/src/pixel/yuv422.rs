//! YUV 4:2:2: a luma sample for every pixel, one pair of chroma samples for two.
//!
//! ```text
//! byte     0   1   2   3
//! YUYV     Y0  Cb  Y1  Cr
//! UYVY     Cb  Y0  Cr  Y1
//! ```
//!
//! The matrices are those of ITU-R BT.601-7 §2.5 (Kr = 0.299, Kb = 0.114) and BT.709-6 §3 (Kr = 0.2126, Kb = 0.0722),
//! quantised to 8 bits in limited range (Y 16 to 235, C 16 to 240) or full range (0 to 255, as JFIF has it).
//!
//! **Rounding.** Coefficients are in Q16, made by integer set-up such that grays stay exactly neutral (luma
//! coefficients sum to the span, chroma coefficients to zero). Each sample is rounded once, to the nearest with
//! halves up, and clamped to 0…255.
//!
//! **Chroma siting.** Encoding averages the pair before rounding: the chroma sample lies midway between its two pixels.
//! Decoding gives it to both. A pair of equal pixels comes back within 1 (full range) or 2 (limited range) of itself
//! in every channel.

use super::layout::{check_length, check_multiple};
use crate::image::{Error, Rgb};

/// Which two coefficients make luma.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Matrix {
    /// ITU-R BT.601, standard definition: what sensors mean if they say nothing.
    Bt601,
    /// ITU-R BT.709, high definition.
    Bt709,
}

/// Which codes are black and white.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Range {
    /// Luma and chroma 0 to 255.
    Full,
    /// Luma 16 to 235, chroma 16 to 240.
    Limited,
}

/// In which order the samples cross the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Packing {
    /// Y0 Cb Y1 Cr, also named YUY2.
    Yuyv,
    /// Cb Y0 Cr Y1.
    Uyvy,
}

const ONE: i32 = 1 << 16;
const HALF: i32 = ONE / 2;

/// The coefficients of one matrix and range, in Q16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coefficients {
    luma: [i32; 3],
    blue_difference: [i32; 3],
    red_difference: [i32; 3],
    black: i32,
    gray_from_luma: i32,
    red_from_cr: i32,
    green_from_cb: i32,
    green_from_cr: i32,
    blue_from_cb: i32,
}

/// `numerator / denominator` in Q16, to the nearest.
const fn q16(numerator: i64, denominator: i64) -> i32 {
    let scaled = numerator * ONE as i64 * 2 + if numerator < 0 { -denominator } else { denominator };
    (scaled / (denominator * 2)) as i32
}

impl Coefficients {
    /// The coefficients for a matrix and a range.
    #[must_use]
    pub const fn new(matrix: Matrix, range: Range) -> Self {
        // In ten-thousandths.
        let (kr, kb) = match matrix {
            Matrix::Bt601 => (2_990, 1_140),
            Matrix::Bt709 => (2_126, 722),
        };
        let kg = 10_000 - kr - kb;
        let (black, luma_span, chroma_span) = match range {
            Range::Full => (0, 255, 255),
            Range::Limited => (16, 219, 224),
        };
        let red = q16(kr * luma_span, 10_000 * 255);
        let blue = q16(kb * luma_span, 10_000 * 255);
        let most = q16(chroma_span, 2 * 255);
        let red_of_cb = q16(-kr * chroma_span, 2 * (10_000 - kb) * 255);
        let blue_of_cr = q16(-kb * chroma_span, 2 * (10_000 - kr) * 255);
        Self {
            luma: [red, q16(luma_span, 255) - red - blue, blue],
            blue_difference: [red_of_cb, -most - red_of_cb, most],
            red_difference: [most, -most - blue_of_cr, blue_of_cr],
            black,
            gray_from_luma: q16(255, luma_span),
            red_from_cr: q16(2 * (10_000 - kr) * 255, 10_000 * chroma_span),
            green_from_cb: q16(-2 * (10_000 - kb) * kb * 255, kg * 10_000 * chroma_span),
            green_from_cr: q16(-2 * (10_000 - kr) * kr * 255, kg * 10_000 * chroma_span),
            blue_from_cb: q16(2 * (10_000 - kb) * 255, 10_000 * chroma_span),
        }
    }

    #[inline(always)]
    fn luma(&self, pixel: Rgb) -> u8 {
        clamp((weigh(self.luma, wide(pixel)) + (self.black << 16) + HALF) >> 16)
    }

    /// Luma of either pixel and the chroma of their mean, as `[Y0, Y1, Cb, Cr]`.
    #[inline(always)]
    fn encode(&self, first: Rgb, second: Rgb) -> [u8; 4] {
        let (one, two) = (wide(first), wide(second));
        let sum = [one[0] + two[0], one[1] + two[1], one[2] + two[2]];
        // One bit more to shift, because it is the sum of two.
        let chroma = |row| clamp((weigh(row, sum) + (128 << 17) + ONE) >> 17);
        [self.luma(first), self.luma(second), chroma(self.blue_difference), chroma(self.red_difference)]
    }

    /// The colour of one sample of each: for layouts other than those of this module. Codes outside the range are
    /// clamped as colours.
    #[inline(always)]
    #[must_use]
    pub fn decode(&self, luma: u8, cb: u8, cr: u8) -> Rgb {
        let gray = (i32::from(luma) - self.black) * self.gray_from_luma + HALF;
        let (cb, cr) = (i32::from(cb) - 128, i32::from(cr) - 128);
        Rgb {
            r: clamp((gray + self.red_from_cr * cr) >> 16),
            g: clamp((gray + self.green_from_cb * cb + self.green_from_cr * cr) >> 16),
            b: clamp((gray + self.blue_from_cb * cb) >> 16),
        }
    }
}

#[inline]
fn wide(pixel: Rgb) -> [i32; 3] {
    [i32::from(pixel.r), i32::from(pixel.g), i32::from(pixel.b)]
}

#[inline]
fn weigh(row: [i32; 3], pixel: [i32; 3]) -> i32 {
    row[0] * pixel[0] + row[1] * pixel[1] + row[2] * pixel[2]
}

#[inline]
fn clamp(value: i32) -> u8 {
    value.clamp(0, 255) as u8
}

/// Bytes of a line of `width` pixels.
#[must_use]
pub const fn line_bytes(width: usize) -> usize {
    2 * width
}

fn check(pixels: usize, bytes: usize) -> Result<(), Error> {
    check_multiple(pixels, 2, "a multiple of 2, because two pixels share their chroma")?;
    check_length("bytes", line_bytes(pixels), bytes)
}

/// Writes a line of pixels; each pair shares its mean chroma.
///
/// # Errors
/// [`Error::Parameter`] if the line has an odd number of pixels, [`Error::BufferLength`] if `bytes` does not hold
/// [`line_bytes`] of them; nothing is then written.
pub fn encode_line(
    pixels: &[Rgb],
    bytes: &mut [u8],
    packing: Packing,
    coefficients: &Coefficients,
) -> Result<(), Error> {
    check(pixels.len(), bytes.len())?;
    encode_groups(pixels, bytes, packing, *coefficients);
    Ok(())
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn encode_groups(pixels: &[Rgb], bytes: &mut [u8], packing: Packing, coefficients: Coefficients) {
    let (pairs, _) = pixels.as_chunks::<2>();
    let (groups, _) = bytes.as_chunks_mut::<4>();
    for (group, &[first, second]) in groups.iter_mut().zip(pairs) {
        let [y0, y1, cb, cr] = coefficients.encode(first, second);
        *group = match packing {
            Packing::Yuyv => [y0, cb, y1, cr],
            Packing::Uyvy => [cb, y0, cr, y1],
        };
    }
}

/// Reads a line of pixels; each pair shares its chroma. Codes outside the range are clamped as colours.
///
/// # Errors
/// As [`encode_line`].
pub fn decode_line(
    bytes: &[u8],
    pixels: &mut [Rgb],
    packing: Packing,
    coefficients: &Coefficients,
) -> Result<(), Error> {
    check(pixels.len(), bytes.len())?;
    let (pairs, _) = pixels.as_chunks_mut::<2>();
    let (groups, _) = bytes.as_chunks::<4>();
    for (pair, &group) in pairs.iter_mut().zip(groups) {
        let [y0, y1, cb, cr] = match (packing, group) {
            (Packing::Yuyv, [y0, cb, y1, cr]) | (Packing::Uyvy, [cb, y0, cr, y1]) => [y0, y1, cb, cr],
        };
        *pair = [coefficients.decode(y0, cb, cr), coefficients.decode(y1, cb, cr)];
    }
    Ok(())
}

/// Reads only the luma of a line, as it was sent: the cheapest way to a gray picture.
///
/// # Errors
/// As [`encode_line`].
pub fn luma_line(bytes: &[u8], luma: &mut [u8], packing: Packing) -> Result<(), Error> {
    check(luma.len(), bytes.len())?;
    let first = match packing {
        Packing::Yuyv => 0,
        Packing::Uyvy => 1,
    };
    let (groups, _) = bytes.as_chunks::<2>();
    luma.iter_mut().zip(groups).for_each(|(luma, group)| *luma = group[first]);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Rgb = Rgb::new(0, 0, 0);
    const WHITE: Rgb = Rgb::new(255, 255, 255);

    #[test]
    fn packings_differ_in_order_only() {
        let pixels = [Rgb::new(200, 10, 30), Rgb::new(10, 220, 90)];
        let coefficients = Coefficients::new(Matrix::Bt601, Range::Limited);
        let (mut yuyv, mut uyvy, mut luma) = ([0; 4], [0; 4], [0; 2]);
        encode_line(&pixels, &mut yuyv, Packing::Yuyv, &coefficients).unwrap();
        encode_line(&pixels, &mut uyvy, Packing::Uyvy, &coefficients).unwrap();
        assert_eq!(yuyv, [uyvy[1], uyvy[0], uyvy[3], uyvy[2]]);
        luma_line(&uyvy, &mut luma, Packing::Uyvy).unwrap();
        assert_eq!(luma, [yuyv[0], yuyv[2]]);
    }

    #[test]
    fn black_and_white_are_the_ends_of_the_range_and_grays_are_neutral() {
        for matrix in [Matrix::Bt601, Matrix::Bt709] {
            for (range, black, white) in [(Range::Full, 0, 255), (Range::Limited, 16, 235)] {
                let coefficients = Coefficients::new(matrix, range);
                assert_eq!(coefficients.encode(BLACK, WHITE), [black, white, 128, 128]);
                for value in 0..=255 {
                    let gray = Rgb::new(value, value, value);
                    let [luma, _, cb, cr] = coefficients.encode(gray, gray);
                    assert_eq!([cb, cr], [128, 128]);
                    let back = coefficients.decode(luma, cb, cr);
                    assert!(back.r == back.g && back.g == back.b && back.r.abs_diff(value) <= 1);
                }
            }
        }
    }

    #[test]
    fn odd_lines_and_short_buffers_are_refused() {
        let coefficients = Coefficients::new(Matrix::Bt709, Range::Full);
        let error = encode_line(&[BLACK; 3], &mut [0; 6], Packing::Yuyv, &coefficients).unwrap_err();
        assert!(matches!(error, Error::Parameter { name: "width", got: 3, .. }));
        let error = decode_line(&[0; 6], &mut [BLACK; 2], Packing::Yuyv, &coefficients).unwrap_err();
        assert_eq!(error, Error::BufferLength { name: "bytes", expected: 4, got: 6 });
    }
}
