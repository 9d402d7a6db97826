//! The nearest colour exactly, by a table over a coarse colour cube that knows which colours can matter in a cell.
//!
//! ```text
//!   ┌────┬────┬────┐        cell ─► 3            one colour is nearest all over the cell
//!   │  3 │ 3 5│  5 │        cell ─► 3, 5         a border runs through: compare these two
//!   ├────┼────┼────┤
//!   │  3 │3 57│5 7 │        a colour is out when even its least distance to the cell
//!   └────┴────┴────┘        is more than the greatest distance of some other colour
//! ```
//!
//! Reference: the locally sorted search of Heckbert, "Color Image Quantization for Frame Buffer Display", 1982.
//! Deviation: lists hold only what passes the test above; they are made when a cell is first met; when the memory
//! for them is used up, further cells search the whole palette, which is slower and just as exact.
//!
//! Cost: a look-up a pixel, and a distance for each candidate of a cell across a border. Memory: [`ExactMap::cells`]
//! of 4 bytes (128 KiB at 5 bits, 16 KiB at 4), the candidates, one byte each, as many as the caller likes (16 KiB
//! does for 256 colours of a photograph), and the probes of [`Nearest`].

use super::histogram::cell;
use super::nearest::{ColorIndex, Nearest};
use super::palette::{MOST_COLORS, lent, squared_distance};
use crate::image::{Error, Rgb};

/// What is known of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell(u32);

impl Cell {
    /// Nothing yet.
    pub const EMPTY: Self = Self(0);
    /// No room for a list: the whole palette is searched.
    const WHOLE: Self = Self(1);

    /// `count` (1 to 256) candidates from `start`; for one candidate, `start` is the candidate itself.
    fn list(start: usize, count: usize) -> Option<Self> {
        let start = u32::try_from(start).ok().filter(|start| *start < 1 << 22)?;
        Some(Self(start << 10 | (count as u32 + 1)))
    }

    fn start(self) -> usize {
        (self.0 >> 10) as usize
    }

    fn count(self) -> usize {
        ((self.0 & 1023) as usize).saturating_sub(1)
    }
}

/// Table of candidates, 2^`BITS` (1 to 6) cells a channel.
#[derive(Debug)]
pub struct ExactMap<'a, const BITS: u32> {
    nearest: Nearest<'a>,
    cells: &'a mut [Cell],
    candidates: &'a mut [u8],
    used: usize,
}

impl<'a, const BITS: u32> ExactMap<'a, BITS> {
    /// Cells needed.
    #[must_use]
    pub const fn cells() -> usize {
        assert!(BITS >= 1 && BITS <= 6, "the map keeps 1 to 6 bits of a channel");
        1 << (3 * BITS)
    }

    /// An empty map in lent memory, which is cleared; `candidates` may be of any length.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if `cells` is shorter than [`ExactMap::cells`].
    pub fn new(nearest: Nearest<'a>, cells: &'a mut [Cell], candidates: &'a mut [u8]) -> Result<Self, Error> {
        let cells = lent("cells", cells, Self::cells())?;
        cells.fill(Cell::EMPTY);
        Ok(Self { nearest, cells, candidates, used: 0 })
    }

    /// Bytes of candidates in use: what to lend next time.
    #[must_use]
    pub fn used(&self) -> usize {
        self.used
    }

    /// Finds the candidates of the cell in which `color` lies.
    #[cold]
    #[inline(never)]
    fn fill(&mut self, cell: usize, color: Rgb) -> Cell {
        let size = 1i32 << (8 - BITS);
        let low = [color.r, color.g, color.b].map(|level| i32::from(level) & -size);
        let high = low.map(|low| low + size - 1);
        let palette = self.nearest.colors();
        let mut least = [0u32; MOST_COLORS];
        let mut bound = u32::MAX;
        for (least, color) in least.iter_mut().zip(palette) {
            let color = [color.r, color.g, color.b].map(i32::from);
            let (mut near, mut far) = (0, 0);
            for axis in 0..3 {
                let (below, above) = (low[axis] - color[axis], color[axis] - high[axis]);
                near += below.max(above).max(0).pow(2);
                far += (below + size - 1).max(above + size - 1).pow(2);
            }
            *least = near as u32;
            bound = bound.min(far as u32);
        }
        let mut passing = (0..=255).zip(&least[..palette.len()]).filter(|(_, least)| **least <= bound);
        let count = passing.clone().count();
        let room = self.candidates.get_mut(self.used..).and_then(|rest| rest.get_mut(..count));
        let known = match (count, passing.next(), room) {
            (1, Some((index, _)), _) => Cell::list(index as usize, 1),
            (_, Some((first, _)), Some(room)) => {
                let start = self.used;
                self.used += count;
                for (place, index) in room.iter_mut().zip(core::iter::once(first).chain(passing.map(|p| p.0)))
                {
                    *place = index as u8;
                }
                Cell::list(start, count)
            }
            _ => None,
        }
        .unwrap_or(Cell::WHOLE);
        if let Some(place) = self.cells.get_mut(cell) {
            *place = known;
        }
        known
    }

    /// The nearest of a cell's candidates; of equals, the first.
    fn search(&mut self, known: Cell, color: Rgb) -> u8 {
        let list = self.candidates.get(known.start()..known.start() + known.count());
        let palette = self.nearest.colors();
        let distance =
            |index: u8| palette.get(usize::from(index)).map_or(u32::MAX, |&c| squared_distance(c, color));
        let key = |&index: &u8| distance(index) << 8 | u32::from(index);
        match list.and_then(|list| list.iter().map(key).min()) {
            Some(key) => key as u8,
            None => self.nearest.index(color),
        }
    }
}

impl<const BITS: u32> ColorIndex for ExactMap<'_, BITS> {
    fn palette(&self) -> &[Rgb] {
        self.nearest.colors()
    }

    #[inline]
    fn index(&mut self, color: Rgb) -> u8 {
        let cell = cell::<BITS>(color);
        let known = match self.cells.get(cell) {
            Some(&known) if known != Cell::EMPTY => known,
            _ => self.fill(cell, color),
        };
        if known.count() == 1 { known.start() as u8 } else { self.search(known, color) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::nearest::Probe;
    use super::*;

    #[test]
    fn borders_get_lists_and_full_memory_searches_on() {
        let gray = |level| Rgb { r: level, g: level, b: level };
        let palette = [gray(0), gray(100), gray(130)];
        for memory in 0..4 {
            let mut probes = [Probe::EMPTY; 3];
            let nearest = Nearest::new(&palette, &mut probes).unwrap();
            let mut cells = [Cell::EMPTY; ExactMap::<3>::cells()];
            let mut candidates = [0; 3];
            let mut map = ExactMap::<3>::new(nearest, &mut cells, &mut candidates[..memory]).unwrap();
            assert_eq!(map.index(gray(3)), 0);
            assert_eq!(map.used(), 0, "one colour needs no list");
            assert_eq!([114, 115, 116].map(|level| map.index(gray(level))), [1, 1, 2]);
            assert_eq!(map.used(), if memory < 2 { 0 } else { 2 });
        }
    }
}
