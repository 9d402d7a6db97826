//! Octree: colours fall down a tree of eighths of the cube, and the deepest leaves are merged when there are too many.
//!
//! ```text
//!   level 0        ●            bit 7 of r, g and b chooses the child, then bit 6, …
//!                ╱ │ ╲
//!   level 1     ●  ○  ●         ○ leaf: a colour of the palette, the mean of what fell into it
//!              ╱ ╲    │
//!   level 2   ○   ○   ○         one leaf too many: the node of the deepest level with fewest pixels becomes a leaf
//! ```
//!
//! Reference: Gervautz and Purgathofer, "A Simple Method for Color Quantization: Octree Quantization", 1988.
//! Deviation: every node, and not only leaves, keeps the sum of its pixels, so a merge only drops the children; and
//! of the deepest nodes the one with fewest pixels is merged, where the paper takes any.
//!
//! It takes pixels as they come and needs no histogram. A merge takes up to seven colours away at once, so the
//! palette may come out that much shorter than asked for.
//!
//! Cost: `depth` steps a pixel, and a walk through one level's nodes for each merge. Memory: [`Octree::nodes`] of
//! [`Node`] (40 bytes): 3.4 KiB for 16 colours 5 levels deep, 80 KiB for 256 colours 8 levels deep.

use super::palette::{MOST_COLORS, MOST_PIXELS, PIXELS_ALLOWED, WeightedColor, lent, rounded};
use crate::image::{Error, Rgb};

/// Deepest tree: one level for each bit of a channel.
const MOST_DEPTH: usize = 8;

/// A cube of the tree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Node {
    /// Places of the eight halves of halves of halves; 0, the root's own place, is none.
    children: [u16; 8],
    /// The next inner node of the same level, or of the free list; 0 is none.
    next: u16,
    inner: bool,
    count: u32,
    /// Sum of the pixels' levels.
    sum: [u32; 3],
}

impl Node {
    /// A place to be filled.
    pub const EMPTY: Self = Self { children: [0; 8], next: 0, inner: false, count: 0, sum: [0; 3] };
}

/// Tree that never has more leaves than it was made for.
#[derive(Debug)]
pub struct Octree<'a> {
    nodes: &'a mut [Node],
    colors: usize,
    depth: usize,
    leaves: usize,
    pixels: u32,
    /// First inner node of each level below the root's.
    inner: [u16; MOST_DEPTH],
    free: u16,
}

impl<'a> Octree<'a> {
    /// Nodes needed for palettes of `colors`, `depth` levels deep: each leaf's path, and one more.
    #[must_use]
    pub const fn nodes(colors: usize, depth: usize) -> usize {
        1 + (colors + 1) * depth
    }

    /// An empty tree in lent memory, for palettes of at most `colors`, that tells `depth` bits of a channel apart.
    ///
    /// # Errors
    /// If `colors` is not 1 to 256, `depth` not 1 to 8, or `nodes` shorter than [`Octree::nodes`].
    pub fn new(colors: usize, depth: usize, nodes: &'a mut [Node]) -> Result<Self, Error> {
        if !(1..=MOST_COLORS).contains(&colors) {
            return Err(Error::Parameter { name: "colors", got: colors as i64, allowed: "1 to 256" });
        }
        if !(1..=MOST_DEPTH).contains(&depth) {
            return Err(Error::Parameter { name: "depth", got: depth as i64, allowed: "1 to 8" });
        }
        let nodes = lent("nodes", nodes, Self::nodes(colors, depth))?;
        let mut tree = Self { nodes, colors, depth, leaves: 0, pixels: 0, inner: [0; MOST_DEPTH], free: 0 };
        tree.clear();
        Ok(tree)
    }

    /// Forgets all pixels.
    pub fn clear(&mut self) {
        let length = self.nodes.len();
        for (place, node) in self.nodes.iter_mut().enumerate() {
            // At most 1 + 257 · 8 nodes.
            let next = if place + 1 < length { place as u16 + 1 } else { 0 };
            *node = Node { next, ..Node::EMPTY };
        }
        self.nodes[0] = Node { inner: true, ..Node::EMPTY };
        (self.leaves, self.pixels, self.inner, self.free) = (0, 0, [0; MOST_DEPTH], 1);
    }

    /// Takes the pixels of a line.
    ///
    /// # Errors
    /// If the tree would then hold more than [`super::MOST_PIXELS`]; none of the line is then taken.
    pub fn add(&mut self, line: &[Rgb]) -> Result<(), Error> {
        self.reserve(line.len() as u64)?;
        line.iter().for_each(|&pixel| self.insert(pixel, 1));
        Ok(())
    }

    /// Takes weighted colours, each rounded to whole levels.
    ///
    /// # Errors
    /// As [`Octree::add`].
    pub fn add_weighted(&mut self, colors: &[WeightedColor]) -> Result<(), Error> {
        self.reserve(colors.iter().map(|color| u64::from(color.count())).sum())?;
        let present = colors.iter().filter(|color| color.count() > 0);
        present.for_each(|color| self.insert(color.rounded(), color.count()));
        Ok(())
    }

    fn reserve(&mut self, added: u64) -> Result<(), Error> {
        let pixels = added.saturating_add(u64::from(self.pixels));
        if pixels > u64::from(MOST_PIXELS) {
            let got = i64::try_from(pixels).unwrap_or(i64::MAX);
            return Err(Error::Parameter { name: "pixels", got, allowed: PIXELS_ALLOWED });
        }
        self.pixels = pixels as u32;
        Ok(())
    }

    fn insert(&mut self, color: Rgb, count: u32) {
        let mut place = 0;
        for level in 0.. {
            let node = &mut self.nodes[place];
            node.count += count;
            for (sum, channel) in node.sum.iter_mut().zip([color.r, color.g, color.b]) {
                *sum += u32::from(channel) * count;
            }
            if !node.inner {
                break;
            }
            let bit = |channel: u8| usize::from(channel >> (7 - level) & 1);
            let child = bit(color.r) << 2 | bit(color.g) << 1 | bit(color.b);
            place = match usize::from(node.children[child]) {
                0 => self.grow(place, child, level + 1),
                place => place,
            };
        }
        while self.leaves > self.colors {
            self.merge();
        }
    }

    /// Hangs a new node at `level` below `parent`.
    fn grow(&mut self, parent: usize, child: usize, level: usize) -> usize {
        // There is always a free one: leaves and the nodes above them never exceed `nodes`.
        let place = self.free;
        let inner = level < self.depth;
        let next = if inner { self.inner[level] } else { 0 };
        let node = &mut self.nodes[usize::from(place)];
        self.free = node.next;
        *node = Node { inner, next, ..Node::EMPTY };
        if inner {
            self.inner[level] = place;
        } else {
            self.leaves += 1;
        }
        self.nodes[parent].children[child] = place;
        usize::from(place)
    }

    /// Makes a leaf of the inner node with fewest pixels on the deepest level that has any.
    fn merge(&mut self) {
        let Some(level) = (1..MOST_DEPTH).rev().find(|level| self.inner[*level] != 0) else {
            // Only the root is left.
            self.drop_children(0);
            return;
        };
        let (mut before, mut least) = (0, usize::from(self.inner[level]));
        let (mut previous, mut place) = (0, least);
        while place != 0 {
            if self.nodes[place].count < self.nodes[least].count {
                (before, least) = (previous, place);
            }
            (previous, place) = (place, usize::from(self.nodes[place].next));
        }
        let next = self.nodes[least].next;
        match before {
            0 => self.inner[level] = next,
            before => self.nodes[before].next = next,
        }
        self.drop_children(least);
    }

    /// All children of the node are leaves, because no level below has inner nodes.
    fn drop_children(&mut self, place: usize) {
        let node = &mut self.nodes[place];
        let children = core::mem::take(&mut node.children);
        node.inner = false;
        node.next = 0;
        self.leaves += 1;
        for child in children.into_iter().filter(|child| *child != 0) {
            self.nodes[usize::from(child)].next = self.free;
            self.free = child;
            self.leaves -= 1;
        }
    }

    /// Writes the leaves' colours, and says how many. The order is that of a walk through the tree.
    ///
    /// # Errors
    /// If the tree is empty, or has more leaves than `palette` is long.
    pub fn palette(&self, palette: &mut [Rgb]) -> Result<usize, Error> {
        if self.pixels == 0 {
            return Err(Error::Parameter { name: "pixels", got: 0, allowed: PIXELS_ALLOWED });
        }
        let palette = lent("palette", palette, self.leaves)?;
        let mut made = 0;
        self.walk(0, palette, &mut made);
        Ok(made)
    }

    /// No deeper than eight calls.
    fn walk(&self, place: usize, palette: &mut [Rgb], made: &mut usize) {
        let node = &self.nodes[place];
        if node.inner {
            for &child in node.children.iter().filter(|child| **child != 0) {
                self.walk(usize::from(child), palette, made);
            }
        } else if let Some(color) = palette.get_mut(*made) {
            let count = u64::from(node.count.max(1));
            *color = rounded(node.sum.map(|sum| ((u64::from(sum) * 4 + count / 2) / count) as u16));
            *made += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(level: u8) -> Rgb {
        Rgb { r: level, g: level, b: level }
    }

    #[test]
    fn few_colours_stay_themselves_and_more_are_merged_at_the_bottom() {
        let mut nodes = [Node::EMPTY; Octree::nodes(4, 8)];
        let mut tree = Octree::new(4, 8, &mut nodes).unwrap();
        let mut palette = [gray(0); 4];
        assert!(tree.palette(&mut palette).is_err(), "empty");
        tree.add(&[gray(200), gray(1), gray(100), gray(200)]).unwrap();
        assert_eq!(tree.palette(&mut palette), Ok(3));
        assert_eq!(palette[..3], [gray(1), gray(100), gray(200)]);
        assert!(tree.palette(&mut palette[..2]).is_err());
        tree.add(&[gray(101), gray(0)]).unwrap();
        assert_eq!(tree.palette(&mut palette), Ok(4), "100 and 101 share seven bits, as 0 and 1 do");
        tree.clear();
        tree.add_weighted(&[WeightedColor::new(gray(7), 3), WeightedColor::EMPTY]).unwrap();
        assert_eq!(tree.palette(&mut palette), Ok(1));
        assert_eq!(palette[0], gray(7));
    }

    #[test]
    fn a_palette_of_one_is_the_mean() {
        let mut nodes = [Node::EMPTY; Octree::nodes(1, 3)];
        let mut tree = Octree::new(1, 3, &mut nodes).unwrap();
        tree.add(&[0, 255, 255, 90].map(gray)).unwrap();
        let mut palette = [gray(0)];
        assert_eq!(tree.palette(&mut palette), Ok(1));
        assert_eq!(palette, [gray(150)]);
    }

    #[test]
    fn bad_parameters_are_refused() {
        let mut nodes = [Node::EMPTY; Octree::nodes(2, 2)];
        assert!(Octree::new(0, 2, &mut nodes).is_err());
        assert!(Octree::new(257, 2, &mut nodes).is_err());
        assert!(Octree::new(2, 0, &mut nodes).is_err());
        assert!(Octree::new(2, 9, &mut nodes).is_err());
        assert!(Octree::new(2, 3, &mut nodes).is_err());
        let mut tree = Octree::new(2, 2, &mut nodes).unwrap();
        assert!(tree.add_weighted(&[WeightedColor::new(gray(0), MOST_PIXELS + 1)]).is_err());
    }
}
