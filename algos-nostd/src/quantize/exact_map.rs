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
//! Deviation: lists hold only what passes the test above, eight colours together, which compilers turn into vector
//! code; they are made when a cell is first met; when the memory for them is used up, further cells search the whole
//! palette, which is slower and just as exact.
//!
//! Cost: a look-up a pixel, and eight distances in a cell across a border. Memory: [`ExactMap::cells`] of 4 bytes
//! (128 KiB at 5 bits, 16 KiB at 4), and [`Group`]s of 64 bytes: one for each 8 colours of the palette, besides as
//! many as the caller likes (4096 do for 256 colours of a photograph at 5 bits).

use super::histogram::cell;
use super::nearest::ColorIndex;
use super::palette::{MOST_COLORS, check_palette, lent};
use crate::image::{Error, Rgb};

/// Colours that are compared together.
const LANES: usize = 8;

/// Eight colours of the palette, and their indices; a list's last colour is repeated to fill the group.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub struct Group {
    channels: [[i16; LANES]; 3],
    indices: [i16; LANES],
}

impl Group {
    /// A place to be filled.
    pub const EMPTY: Self = Self { channels: [[0; LANES]; 3], indices: [0; LANES] };

    /// The least distance² · 256 + index.
    #[inline]
    fn least(&self, color: [i16; 3]) -> i32 {
        let mut keys = [0; LANES];
        for (lane, key) in keys.iter_mut().enumerate() {
            let square = |channel: usize| i32::from(self.channels[channel][lane] - color[channel]).pow(2);
            *key = (square(0) + square(1) + square(2)) << 8 | i32::from(self.indices[lane]);
        }
        keys.into_iter().fold(i32::MAX, i32::min)
    }
}

/// Writes palette colours to groups, as far as there is room.
fn gather(groups: &mut [Group], palette: &[Rgb], mut indices: impl Iterator<Item = u8>) {
    let mut last = 0;
    for group in groups {
        for lane in 0..LANES {
            last = indices.next().unwrap_or(last);
            let color = palette.get(usize::from(last)).copied().unwrap_or_default();
            for (channel, level) in group.channels.iter_mut().zip([color.r, color.g, color.b]) {
                channel[lane] = i16::from(level);
            }
            group.indices[lane] = i16::from(last);
        }
    }
}

/// What is known of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell(u32);

impl Cell {
    /// Nothing yet.
    pub const EMPTY: Self = Self(0);

    /// One colour is nearest everywhere.
    fn single(index: u8) -> Self {
        Self(u32::from(index) << 8 | 1)
    }

    /// `count` (1 to 32) groups from `start`.
    fn groups(start: usize, count: usize) -> Option<Self> {
        let start = u32::try_from(start).ok().filter(|start| *start < 1 << 24)?;
        Some(Self(start << 8 | (count as u32 + 1)))
    }
}

/// Table of candidates, 2^`BITS` (1 to 6) cells a channel.
#[derive(Debug)]
pub struct ExactMap<'a, const BITS: u32> {
    palette: &'a [Rgb],
    cells: &'a mut [Cell],
    /// The whole palette first, then lists.
    groups: &'a mut [Group],
    used: usize,
}

impl<'a, const BITS: u32> ExactMap<'a, BITS> {
    /// Cells needed.
    #[must_use]
    pub const fn cells() -> usize {
        const { assert!(BITS >= 1 && BITS <= 6, "the map keeps 1 to 6 bits of a channel") };
        1 << (3 * BITS)
    }

    /// Groups needed at least: those of the palette itself.
    #[must_use]
    pub const fn groups(colors: usize) -> usize {
        colors.div_ceil(LANES)
    }

    /// An empty map in lent memory, which is cleared; `groups` may be longer than needed, and should.
    ///
    /// # Errors
    /// If the palette's length is not 1 to 256, or `cells` or `groups` is shorter than [`ExactMap::cells`] or
    /// [`ExactMap::groups`].
    pub fn new(palette: &'a [Rgb], cells: &'a mut [Cell], groups: &'a mut [Group]) -> Result<Self, Error> {
        check_palette(palette)?;
        let used = Self::groups(palette.len());
        gather(lent("groups", groups, used)?, palette, (0..=255).take(palette.len()));
        let cells = lent("cells", cells, Self::cells())?;
        cells.fill(Cell::EMPTY);
        Ok(Self { palette, cells, groups, used })
    }

    /// Groups in use: what to lend next time.
    #[must_use]
    pub fn used(&self) -> usize {
        self.used
    }

    /// Finds the candidates of the cell in which `color` lies.
    #[cold]
    #[inline(never)]
    fn fill(&mut self, cell: usize, color: Rgb) -> Cell {
        let size = 1i16 << (8 - BITS);
        let low = [color.r, color.g, color.b].map(|level| i16::from(level) & -size);
        let whole = Self::groups(self.palette.len());
        let mut least = [[0i32; LANES]; MOST_COLORS / LANES];
        let mut bounds = [i32::MAX; LANES];
        for (least, group) in least.iter_mut().zip(&self.groups[..whole]) {
            for lane in 0..LANES {
                let (mut near, mut far) = (0, 0);
                for (channel, low) in group.channels.iter().zip(low) {
                    let (below, above) = (low - channel[lane], channel[lane] - (low + size - 1));
                    near += i32::from(below.max(above).max(0)).pow(2);
                    far += i32::from(below.max(above) + size - 1).pow(2);
                }
                least[lane] = near;
                bounds[lane] = bounds[lane].min(far);
            }
        }
        let bound = bounds.into_iter().fold(i32::MAX, i32::min);
        let (mut passing, mut count) = ([0; MOST_COLORS], 0);
        for (index, &least) in (0..=255).zip(least.as_flattened()).take(self.palette.len()) {
            passing[count] = index;
            count += usize::from(least <= bound);
        }
        let known = if count == 1 { Some(Cell::single(passing[0])) } else { self.list(&passing[..count]) };
        let known = known.or_else(|| Cell::groups(0, whole)).unwrap_or(Cell::EMPTY);
        if let Some(place) = self.cells.get_mut(cell) {
            *place = known;
        }
        known
    }

    /// Stores a list, if there is room.
    fn list(&mut self, indices: &[u8]) -> Option<Cell> {
        let (start, count) = (self.used, indices.len().div_ceil(LANES));
        let cell = Cell::groups(start, count)?;
        gather(self.groups.get_mut(start..start + count)?, self.palette, indices.iter().copied());
        self.used += count;
        Some(cell)
    }
}

impl<const BITS: u32> ColorIndex for ExactMap<'_, BITS> {
    fn palette(&self) -> &[Rgb] {
        self.palette
    }

    #[inline]
    fn index(&mut self, color: Rgb) -> u8 {
        let cell = cell::<BITS>(color);
        let known = match self.cells.get(cell) {
            Some(&known) if known != Cell::EMPTY => known,
            _ => self.fill(cell, color),
        };
        let (start, count) = ((known.0 >> 8) as usize, (known.0 & 255) as usize - 1);
        if count == 0 {
            return start as u8;
        }
        let color = [color.r, color.g, color.b].map(i16::from);
        let groups = self.groups.get(start..start + count).unwrap_or_default();
        // Of equals the first, since the index is part of the key.
        groups.iter().map(|group| group.least(color)).fold(i32::MAX, i32::min) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_get_lists_and_full_memory_searches_on() {
        let gray = |level| Rgb { r: level, g: level, b: level };
        let palette = [gray(0), gray(100), gray(130)];
        for memory in 1..4 {
            let mut cells = [Cell::EMPTY; ExactMap::<3>::cells()];
            let mut groups = [Group::EMPTY; 3];
            let mut map = ExactMap::<3>::new(&palette, &mut cells, &mut groups[..memory]).unwrap();
            assert_eq!(map.index(gray(3)), 0);
            assert_eq!(map.used(), 1, "one colour needs no list");
            assert_eq!([114, 115, 116].map(|level| map.index(gray(level))), [1, 1, 2]);
            assert_eq!(map.used(), if memory < 2 { 1 } else { 2 });
        }
        assert!(ExactMap::<3>::new(&palette, &mut [Cell::EMPTY; 512], &mut []).is_err());
        assert!(ExactMap::<3>::new(&palette, &mut [Cell::EMPTY; 511], &mut [Group::EMPTY; 1]).is_err());
    }
}
