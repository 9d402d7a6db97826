//! The nearest colour by a table over a coarse colour cube: one look-up a pixel, and a known error.
//!
//! ```text
//!   rrrrrrrr gggggggg bbbbbbbb          cells, filled when first met
//!   └─┬─┘    └─┬─┘    └─┬─┘             ┌────┬────┬────┬────┐
//!     └────────┴────────┴─► cell ─────► │  7 │  7 │  ? │ 12 │ …   ? ─► exact search for 16 cells in a row
//!              BITS of each             └────┴────┴────┴────┘
//! ```
//!
//! A cell's colour is the one nearest to the cell's middle. So the colour given to a pixel can be farther than the
//! nearest, by at most twice the distance from the middle to a corner: with cells of `s` = 2^(8 − `BITS`) levels,
//! √3·(s − 1) levels (12.1 at 5 bits, 5.2 at 6). It happens only in cells that lie across the border of two colours,
//! and there both are about equally far. [`super::ExactMap`] has no such error.
//!
//! Reference: Heckbert, "Color Image Quantization for Frame Buffer Display", 1982; Thomas, "Efficient Inverse Color
//! Map Computation", Graphics Gems II, 1991. Deviation: cells are filled on demand, so that an empty part of the
//! cube costs nothing.
//!
//! A cell holds the colour besides its index, so that error diffusion, where each pixel waits for the one before, has
//! one look-up to wait for and not two.
//!
//! Cost: a look-up a pixel. Memory: [`InverseMap::cells`] of 4 bytes (2 KiB at 3 bits, 16 KiB at 4, 128 KiB at 5),
//! and the probes of [`Nearest`].

use super::histogram::cell;
use super::nearest::{BLOCK, ColorIndex, Nearest};
use super::palette::lent;
use crate::image::{Error, Rgb};

/// Table of nearest colours, 2^`BITS` (1 to 6) cells a channel.
#[derive(Debug)]
pub struct InverseMap<'a, const BITS: u32> {
    nearest: Nearest<'a>,
    /// Index, red, green, blue, from the highest byte down.
    cells: &'a mut [u32],
    /// What a cell holds that is not yet filled: the first index with another colour than the first.
    empty: u32,
}

fn pack(index: u8, color: Rgb) -> u32 {
    u32::from_be_bytes([index, color.r, color.g, color.b])
}

impl<'a, const BITS: u32> InverseMap<'a, BITS> {
    /// Cells needed.
    #[must_use]
    pub const fn cells() -> usize {
        const { assert!(BITS >= 1 && BITS <= 6, "the map keeps 1 to 6 bits of a channel") };
        1 << (3 * BITS)
    }

    /// An empty map in lent memory, which is cleared.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if `cells` is shorter than [`InverseMap::cells`].
    pub fn new(nearest: Nearest<'a>, cells: &'a mut [u32]) -> Result<Self, Error> {
        let cells = lent("cells", cells, Self::cells())?;
        let first = nearest.colors().first().copied().unwrap_or_default();
        let empty = pack(0, Rgb { r: !first.r, ..first });
        cells.fill(empty);
        Ok(Self { nearest, cells, empty })
    }

    /// Fills the cell and its neighbours along blue that share a search.
    #[cold]
    #[inline(never)]
    fn fill(&mut self, cell: usize) -> u32 {
        let first = cell & !(BLOCK - 1);
        let mut block = [[0; BLOCK]; 3];
        for lane in 0..BLOCK {
            for (channel, shift) in block.iter_mut().zip([2 * BITS, BITS, 0]) {
                let top = ((first + lane) >> shift & ((1 << BITS) - 1)) as i32;
                // The middle of a cell of s levels is (s − 1)/2 above its lowest: 2·s − 2 quarters.
                channel[lane] = (top << (10 - BITS)) + (2 << (8 - BITS)) - 2;
            }
        }
        for (cell, index) in self.cells.iter_mut().skip(first).zip(self.nearest.block(&block)) {
            let color = self.nearest.colors().get(usize::from(index)).copied().unwrap_or_default();
            *cell = pack(index, color);
        }
        self.cells.get(cell).copied().unwrap_or(0)
    }

    #[inline(always)]
    fn look_up(&mut self, color: Rgb) -> u32 {
        let cell = cell::<BITS>(color);
        match self.cells.get(cell) {
            Some(&filled) if filled != self.empty => filled,
            _ => self.fill(cell),
        }
    }
}

impl<const BITS: u32> ColorIndex for InverseMap<'_, BITS> {
    fn palette(&self) -> &[Rgb] {
        self.nearest.colors()
    }

    #[inline]
    fn index(&mut self, color: Rgb) -> u8 {
        (self.look_up(color) >> 24) as u8
    }

    #[inline]
    fn entry(&mut self, color: Rgb) -> (u8, Rgb) {
        let [index, r, g, b] = self.look_up(color).to_be_bytes();
        (index, Rgb { r, g, b })
    }
}

#[cfg(test)]
mod tests {
    use super::super::nearest::Probe;
    use super::*;

    #[test]
    fn cells_decide_by_their_middle() {
        let gray = |level| Rgb { r: level, g: level, b: level };
        let palette = [gray(0), gray(254)];
        let mut probes = [Probe::EMPTY; 2];
        let nearest = Nearest::new(&palette, &mut probes).unwrap();
        let mut cells = [9; InverseMap::<1>::cells()];
        let mut map = InverseMap::<1>::new(nearest, &mut cells).unwrap();
        // Cells of 128 levels: middles at 63.5 and 191.5.
        assert_eq!([0, 127, 128, 255].map(|level| map.index(gray(level))), [0, 0, 1, 1]);
        assert_eq!(map.index(Rgb { r: 255, g: 127, b: 127 }), 0);
        assert!(InverseMap::<1>::new(nearest, &mut [0; 7]).is_err());
    }
}
