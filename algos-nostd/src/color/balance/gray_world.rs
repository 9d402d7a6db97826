//! Gray-world: the mean of the scene is taken for gray, so its colour is that of the light.
//!
//! ```text
//! white = (ΣR, ΣG, ΣB) / pixels
//! ```
//!
//! G. Buchsbaum, "A spatial processor model for object colour perception", J. Franklin Institute 310 (1980).
//! Every pixel counts, saturated ones too, as in the usual libraries.
//!
//! **Cost and memory.** One addition a byte: lines are summed byte by byte in 96 columns of 16 bits, a multiple of three
//! and of every vector unit's width, and the columns are gathered every 256 rows of them. 32 bytes of state,
//! 192 bytes of stack.

use super::White;
use crate::image::{Image, Rgb};
use crate::pixel::rgb888;

/// Sums a picture's channels line by line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GrayWorld {
    sums: [u64; 3],
    pixels: u64,
}

impl GrayWorld {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { sums: [0; 3], pixels: 0 }
    }

    /// Takes a line, of any length.
    pub fn push(&mut self, line: &[Rgb]) {
        let sums = sum_bytes(rgb888::as_bytes(line));
        self.sums.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
        self.pixels += line.len() as u64;
    }

    /// The light's colour, the mean to the nearest 1/256, and is ready for the next frame. `None` without pixels.
    pub fn finish(&mut self) -> Option<White> {
        let seen = core::mem::take(self);
        (seen.pixels > 0).then(|| White::mean(seen.sums, seen.pixels))
    }
}

/// The estimate for a whole picture.
#[must_use]
pub fn estimate(image: Image<'_, Rgb>) -> White {
    let mut sums = GrayWorld::new();
    match image.as_contiguous() {
        Some(pixels) => sums.push(pixels),
        None => image.rows().for_each(|row| sums.push(row)),
    }
    White::mean(sums.sums, sums.pixels)
}

/// Columns of the running sums: a multiple of 3 and of 32.
const COLUMNS: usize = 96;
/// Rows until a column of 16 bits could overflow: 257 × 255 = 65,535.
const ROWS: usize = 257;

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn sum_bytes(bytes: &[u8]) -> [u64; 3] {
    let mut sums = [0; 3];
    let (rows, rest) = bytes.as_chunks::<COLUMNS>();
    for rows in rows.chunks(ROWS) {
        let mut columns = [0u16; COLUMNS];
        for row in rows {
            columns.iter_mut().zip(row).for_each(|(column, &byte)| *column += u16::from(byte));
        }
        for (at, &column) in columns.iter().enumerate() {
            sums[at % 3] += u64::from(column);
        }
    }
    for (at, &byte) in rest.iter().enumerate() {
        sums[at % 3] += u64::from(byte);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_brightest_picture_does_not_overflow() {
        let mut sums = GrayWorld::new();
        sums.push(&vec![Rgb::new(255, 254, 0); 32 * ROWS + 40]);
        assert_eq!(sums.finish(), Some(White { r: 255 << 8, g: 254 << 8, b: 0 }));
        assert_eq!(sums.finish(), None, "and the next frame starts afresh");
    }

    #[test]
    fn lines_and_a_whole_picture_agree() {
        let pixels: Vec<Rgb> = (0..77u8).map(|i| Rgb::new(i, 3 * i, 255 - i)).collect();
        let mut sums = GrayWorld::new();
        pixels.chunks(7).for_each(|line| sums.push(line));
        let whole = estimate(Image::new(&pixels, 11, 7).unwrap());
        assert_eq!(sums.finish(), Some(whole));
        assert_eq!(whole.r, 38 << 8);
        let left = Image::with_stride(&pixels, 10, 7, 11).unwrap();
        assert_ne!(estimate(left), whole, "padding does not count");
    }
}
