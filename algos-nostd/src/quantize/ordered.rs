//! Ordered dithering: a tile of thresholds laid over the picture decides where a colour is rounded up or down.
//!
//! ```text
//!   Bayer 4 × 4        level 1/4          3/8              1/2
//!    0  8  2 10        ■ · ■ ·          ■ · ■ ·          ■ · ■ ·
//!   12  4 14  6        · · · ·          · ■ · ·          · ■ · ■
//!    3 11  1  9        ■ · ■ ·          ■ · ■ ·          ■ · ■ ·     a pixel is light ■ where its level
//!   15  7 13  5        · · · ·          · · · ■          · ■ · ■     is above the tile's
//! ```
//!
//! Reference: Bayer, "An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures", 1973; for the tile of
//! blue noise see [`BLUE_NOISE`]. With a palette of any kind, ½ to −½ of `spread` levels are added
//! to the pixel, less the higher the threshold, and the nearest colour taken. The right spread is the step between
//! neighbouring colours: [`Ordered::spread_of`] measures it.
//!
//! Cost: an addition a channel, and the [`ColorIndex`]. Memory: a line of pixels and one of indices.

use super::nearest::ColorIndex;
use super::palette::{lent, squared_distance};
use crate::image::{Error, Rgb};
use crate::lines::{LineFilter, LineSink, check_width};

pub use super::blue_noise::BLUE_NOISE;

/// Square tile of thresholds, repeated over the picture.
#[derive(Clone, Copy, Debug)]
pub struct Tile<'a> {
    side: usize,
    thresholds: &'a [u8],
}

/// Bayer's tile of 2 × 2.
pub const BAYER_2: Tile<'static> = Tile::of_side(2, &bayer::<4>(2));
/// Bayer's tile of 4 × 4.
pub const BAYER_4: Tile<'static> = Tile::of_side(4, &bayer::<16>(4));
/// Bayer's tile of 8 × 8.
pub const BAYER_8: Tile<'static> = Tile::of_side(8, &bayer::<64>(8));

/// Each quarter of a tile is the tile of half the side, times four, plus 0, 2, 3, 1.
const fn bayer<const CELLS: usize>(side: usize) -> [u8; CELLS] {
    let mut thresholds = [0; CELLS];
    let mut cell = 0;
    while cell < CELLS {
        let (x, y) = (cell % side, cell / side);
        let (mut rank, mut bit) = (0, 1);
        while bit < side {
            let (right, down) = ((x & bit != 0) as usize, (y & bit != 0) as usize);
            rank = rank * 4 + 2 * (right ^ down) + down;
            bit *= 2;
        }
        // The middle of the rank's share of 0 to 255.
        thresholds[cell] = ((rank * 256 + 128) / CELLS) as u8;
        cell += 1;
    }
    thresholds
}

impl<'a> Tile<'a> {
    /// A tile of one's own, line by line; thresholds should be spread evenly from 0 to 255.
    ///
    /// # Errors
    /// If `side` is zero or `thresholds` is not `side × side` long.
    pub const fn new(side: usize, thresholds: &'a [u8]) -> Result<Self, Error> {
        if side == 0 {
            return Err(Error::ZeroSize { width: side, height: side });
        }
        let (expected, got) = (side.saturating_mul(side), thresholds.len());
        if expected != got {
            return Err(Error::BufferLength { name: "thresholds", expected, got });
        }
        Ok(Self { side, thresholds })
    }

    /// A tile that is known to be right.
    pub(super) const fn of_side(side: usize, thresholds: &'a [u8]) -> Self {
        Self { side, thresholds }
    }

    /// Pixels a side.
    #[must_use]
    pub const fn side(&self) -> usize {
        self.side
    }

    /// The thresholds, line by line.
    #[must_use]
    pub const fn thresholds(&self) -> &'a [u8] {
        self.thresholds
    }
}

/// Line filter from pixels to dithered indices.
#[derive(Debug)]
pub struct Ordered<'a, C> {
    tile: Tile<'a>,
    spread: i32,
    colors: C,
    pixels: &'a mut [Rgb],
    indices: &'a mut [u8],
    /// The tile's line for the next line of the picture.
    row: usize,
}

impl<'a, C: ColorIndex> Ordered<'a, C> {
    /// A filter for lines of `width` pixels with thresholds `spread` levels apart (0 is no dithering), and lent
    /// memory for as many pixels and indices.
    ///
    /// # Errors
    /// If `width` is zero or a buffer is shorter.
    pub fn new(
        width: usize,
        tile: Tile<'a>,
        spread: u8,
        colors: C,
        pixels: &'a mut [Rgb],
        indices: &'a mut [u8],
    ) -> Result<Self, Error> {
        if width == 0 {
            return Err(Error::ZeroSize { width, height: 1 });
        }
        let pixels = lent("pixels", pixels, width)?;
        let indices = lent("indices", indices, width)?;
        Ok(Self { tile, spread: i32::from(spread), colors, pixels, indices, row: 0 })
    }

    /// The spread that suits a palette: the mean distance of a colour to its nearest neighbour, in levels.
    ///
    /// For evenly spaced grays or a uniform palette with equal steps it is the step. It takes a distance for each
    /// pair of colours.
    #[must_use]
    pub fn spread_of(palette: &[Rgb]) -> u8 {
        let nearest = |color: &Rgb| {
            palette.iter().map(|other| squared_distance(*color, *other)).filter(|d| *d > 0).min()
        };
        let (mut sum, mut colors) = (0u64, 0u64);
        for distance in palette.iter().filter_map(nearest) {
            // In sixteenths of a level, so that rounding does not add up.
            sum += u64::from((distance * 256).isqrt());
            colors += 1;
        }
        let mean = (sum + colors * 8).checked_div(colors * 16);
        mean.map_or(0, |mean| mean.min(255) as u8)
    }
}

impl<C: ColorIndex> LineFilter for Ordered<'_, C> {
    type Input = Rgb;
    type Output = u8;

    const LATENCY: usize = 0;

    fn push(&mut self, line: &[Rgb], sink: &mut impl LineSink<u8>) -> Result<(), Error> {
        check_width(self.indices.len(), line.len())?;
        let side = self.tile.side;
        let thresholds = &self.tile.thresholds[self.row * side..][..side];
        for (pixels, line) in self.pixels.chunks_mut(side).zip(line.chunks(side)) {
            for ((pixel, &from), &threshold) in pixels.iter_mut().zip(line).zip(thresholds) {
                // From 255/512 to −255/512 of the spread, rounded to whole levels.
                let offset = ((255 - 2 * i32::from(threshold)) * self.spread + 256) >> 9;
                let [r, g, b] =
                    [from.r, from.g, from.b].map(|level| (i32::from(level) + offset).clamp(0, 255) as u8);
                *pixel = Rgb { r, g, b };
            }
        }
        self.colors.indices(self.pixels, self.indices);
        self.row = (self.row + 1) % side;
        sink.line(self.indices);
        Ok(())
    }

    fn finish(&mut self, _: &mut impl LineSink<u8>) {
        self.row = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Nearest, Probe};
    use super::*;
    use crate::image::{Image, ImageMut};
    use crate::lines::run;

    const BLACK: Rgb = Rgb { r: 0, g: 0, b: 0 };
    const WHITE: Rgb = Rgb { r: 255, g: 255, b: 255 };

    /// A flat gray in black and white, `#` being black.
    fn draw<const SIDE: usize>(tile: Tile<'_>, level: u8) -> [[char; SIDE]; SIDE] {
        let palette = [BLACK, WHITE];
        let mut probes = [Probe::EMPTY; 2];
        let colors = Nearest::new(&palette, &mut probes).unwrap();
        let (mut pixels, mut indices, mut output) = ([BLACK; SIDE], [0; SIDE], [[0; SIDE]; SIDE]);
        let mut filter = Ordered::new(SIDE, tile, 255, colors, &mut pixels, &mut indices).unwrap();
        let gray = [[Rgb { r: level, g: level, b: level }; SIDE]; SIDE];
        let mut output_view = ImageMut::new(output.as_flattened_mut(), SIDE, SIDE).unwrap();
        run(&mut filter, Image::new(gray.as_flattened(), SIDE, SIDE).unwrap(), &mut output_view).unwrap();
        output.map(|line| line.map(|index| if index == 0 { '#' } else { '.' }))
    }

    #[test]
    fn a_quarter_and_a_half() {
        let picture = |lines: [&str; 4]| {
            lines.map(|line| -> [char; 4] { core::array::from_fn(|x| line.as_bytes()[x] as char) })
        };
        assert_eq!(draw(BAYER_4, 64), picture([".#.#", "####", ".#.#", "####"]));
        assert_eq!(draw(BAYER_2, 128), picture([".#.#", "#.#.", ".#.#", "#.#."]));
        assert_eq!(draw::<4>(BAYER_4, 0), [['#'; 4]; 4]);
        assert_eq!(draw::<4>(BAYER_4, 255), [['.'; 4]; 4]);
    }

    #[test]
    fn bayer_by_its_ranks() {
        let ranks: [u8; 16] = core::array::from_fn(|cell| BAYER_4.thresholds()[cell] / 16);
        assert_eq!(ranks, [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5]);
    }

    #[test]
    fn the_mean_of_a_flat_gray_is_kept() {
        for tile in [BAYER_8, BLUE_NOISE] {
            for level in [10, 64, 127, 200, 250] {
                let light = draw::<32>(tile, level).as_flattened().iter().filter(|dot| **dot == '.').count();
                let error = (light as i32 * 255 / 1024).abs_diff(i32::from(level));
                assert!(error <= 255 / 64 + 1, "{level}: {light}");
            }
        }
    }

    #[test]
    fn spread_is_the_step() {
        type Any<'a> = Ordered<'a, Nearest<'a>>;
        let grays: [Rgb; 6] = core::array::from_fn(|step| Rgb { r: step as u8 * 51, g: 0, b: 0 });
        assert_eq!(Any::spread_of(&grays), 51);
        assert_eq!(Any::spread_of(&[WHITE; 3]), 0);
        assert_eq!(Any::spread_of(&[BLACK, WHITE]), 255);
    }

    #[test]
    fn bad_parameters_are_refused() {
        assert!(Tile::new(0, &[]).is_err());
        assert!(Tile::new(2, &[1, 2, 3]).is_err());
        let mut probes = [Probe::EMPTY];
        let palette = [BLACK];
        let colors = Nearest::new(&palette, &mut probes).unwrap();
        assert!(Ordered::new(0, BAYER_2, 1, colors, &mut [], &mut []).is_err());
        assert!(Ordered::new(2, BAYER_2, 1, colors, &mut [BLACK; 2], &mut [0]).is_err());
        assert!(Ordered::new(2, BAYER_2, 1, colors, &mut [BLACK; 1], &mut [0; 2]).is_err());
    }
}
