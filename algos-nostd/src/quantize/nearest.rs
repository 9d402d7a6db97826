//! The nearest colour of a fixed palette, exactly, by looking at every colour.
//!
//! ```text
//!            palette  c0   c1   c2   c3 …           key = distance² · 256 + index
//! pixel p ─► keys     17·  5·   5·  90·   ─► min ─► the nearest; of equals, the first
//! ```
//!
//! Distance is Euclidean in RGB. It splits into |c|² − 2 c·p + |p|²; the last term is the same for all colours, so a
//! key takes three multiplications. Sixteen pixels go through together, which compilers turn into vector code.
//!
//! Cost: colours × 3 multiplications a pixel. Memory: a [`Probe`] (16 bytes) a colour.

use super::palette::{check_palette, lent, quarters};
use crate::image::{Error, Rgb};

/// Gives each colour an index into a palette: what mapping and dithering work with.
pub trait ColorIndex {
    /// The palette, 1 to 256 colours.
    fn palette(&self) -> &[Rgb];

    /// The index of the palette colour that stands for `color`.
    fn index(&mut self, color: Rgb) -> u8;

    /// The index and the palette colour itself: what error diffusion wants.
    #[inline]
    fn entry(&mut self, color: Rgb) -> (u8, Rgb) {
        let index = self.index(color);
        // An index is always within the palette.
        (index, self.palette().get(usize::from(index)).copied().unwrap_or_default())
    }

    /// The indices of a line's pixels, as far as both slices reach.
    fn indices(&mut self, line: &[Rgb], indices: &mut [u8]) {
        for (index, &pixel) in indices.iter_mut().zip(line) {
            *index = self.index(pixel);
        }
    }
}

impl<T: ColorIndex> ColorIndex for &mut T {
    fn palette(&self) -> &[Rgb] {
        (**self).palette()
    }

    #[inline]
    fn index(&mut self, color: Rgb) -> u8 {
        (**self).index(color)
    }

    #[inline]
    fn entry(&mut self, color: Rgb) -> (u8, Rgb) {
        (**self).entry(color)
    }

    fn indices(&mut self, line: &[Rgb], indices: &mut [u8]) {
        (**self).indices(line, indices);
    }
}

/// Pixels that go through the search together.
pub(super) const BLOCK: usize = 16;

/// Sixteen colours in quarters of a level: red, green, blue.
pub(super) type Block = [[i32; BLOCK]; 3];

/// A palette colour as the search wants it: key = offset + slope · pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Probe {
    offset: i32,
    slope: [i32; 3],
}

impl Probe {
    /// A place to be filled.
    pub const EMPTY: Self = Self { offset: 0, slope: [0; 3] };

    pub(super) fn new(quarters: [u16; 3], index: usize) -> Self {
        let color = quarters.map(i32::from);
        let square: i32 = color.iter().map(|level| level * level).sum();
        // Squares stay below 2^22, so keys stay within ±2^30.
        Self { offset: square << 8 | index as i32, slope: color.map(|level| level * -512) }
    }
}

/// For each colour of the block the index of the nearest probe; of equals, the first.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
pub(super) fn nearest_of_block(probes: &[Probe], block: &Block) -> [u8; BLOCK] {
    let mut best = [i32::MAX; BLOCK];
    for probe in probes {
        for (lane, best) in best.iter_mut().enumerate() {
            let key = probe
                .offset
                .wrapping_add(probe.slope[0].wrapping_mul(block[0][lane]))
                .wrapping_add(probe.slope[1].wrapping_mul(block[1][lane]))
                .wrapping_add(probe.slope[2].wrapping_mul(block[2][lane]));
            *best = (*best).min(key);
        }
    }
    best.map(|key| key as u8)
}

/// Exact search through a whole palette: slow for many colours, but needs next to no memory.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<'a> {
    palette: &'a [Rgb],
    probes: &'a [Probe],
}

impl<'a> Nearest<'a> {
    /// Prepares a palette, with a probe for each of its colours in lent memory.
    ///
    /// # Errors
    /// If the palette's length is not 1 to 256 or there are fewer probes.
    pub fn new(palette: &'a [Rgb], probes: &'a mut [Probe]) -> Result<Self, Error> {
        check_palette(palette)?;
        let probes = lent("probes", probes, palette.len())?;
        for (index, (probe, &color)) in probes.iter_mut().zip(palette).enumerate() {
            *probe = Probe::new(quarters(color), index);
        }
        Ok(Self { palette, probes })
    }

    pub(super) fn colors(&self) -> &'a [Rgb] {
        self.palette
    }

    pub(super) fn block(&self, block: &Block) -> [u8; BLOCK] {
        nearest_of_block(self.probes, block)
    }
}

impl ColorIndex for Nearest<'_> {
    fn palette(&self) -> &[Rgb] {
        self.palette
    }

    fn index(&mut self, color: Rgb) -> u8 {
        let [r, g, b] = quarters(color).map(i32::from);
        let key = |probe: &Probe| probe.offset + probe.slope[0] * r + probe.slope[1] * g + probe.slope[2] * b;
        // There is at least one probe, so the minimum exists.
        self.probes.iter().map(key).min().map_or(0, |key| key as u8)
    }

    fn indices(&mut self, line: &[Rgb], indices: &mut [u8]) {
        let mut block = [[0; BLOCK]; 3];
        for (pixels, indices) in line.chunks(BLOCK).zip(indices.chunks_mut(BLOCK)) {
            for (lane, pixel) in pixels.iter().enumerate() {
                block[0][lane] = i32::from(pixel.r) * 4;
                block[1][lane] = i32::from(pixel.g) * 4;
                block[2][lane] = i32::from(pixel.b) * 4;
            }
            for (index, nearest) in indices.iter_mut().zip(self.block(&block)).take(pixels.len()) {
                *index = nearest;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_equals_the_first() {
        let gray = |level| Rgb { r: level, g: level, b: level };
        let palette = [gray(0), gray(20), gray(20), gray(255)];
        let mut probes = [Probe::EMPTY; 4];
        let mut nearest = Nearest::new(&palette, &mut probes).unwrap();
        assert_eq!([0, 10, 11, 20, 254].map(|level| nearest.index(gray(level))), [0, 0, 1, 1, 3]);
        let line: [Rgb; 19] = core::array::from_fn(|x| gray(x as u8 * 14));
        let mut indices = [9; 20];
        nearest.indices(&line, &mut indices);
        assert_eq!(indices, [0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 9]);
    }

    #[test]
    fn the_corners_of_the_cube_do_not_overflow() {
        let palette: [Rgb; 8] = core::array::from_fn(|corner| {
            let level = |bit: usize| if corner >> bit & 1 == 1 { 255 } else { 0 };
            Rgb { r: level(0), g: level(1), b: level(2) }
        });
        let mut probes = [Probe::EMPTY; 8];
        let mut nearest = Nearest::new(&palette, &mut probes).unwrap();
        for (index, &color) in palette.iter().enumerate() {
            assert_eq!(usize::from(nearest.index(color)), index);
        }
    }
}
