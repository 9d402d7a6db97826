//! Thinning: peeling an edge map from its sides until it is one pixel wide.
//!
//! ```text
//! . # # # # .        . . . . . .         p8 p1 p2
//! # # # # # #   ─►   # # # # # .         p7  p p3      the neighbours' names here
//! . # # # # .        . . . . . .         p6 p5 p4
//! ```
//!
//! A pass looks at every pixel as it was before the pass, and deletes those on a side that can go without tearing
//! the figure or shortening it:
//!
//! - [`Thinning::ZhangSuen`]: T. Zhang and C. Suen, Communications of the ACM 27(3), 1984. Two passes a round, south-east and
//!   north-west sides. Quick, but figures of 2 × 2 pixels vanish and diagonals stay two wide, as published.
//! - [`Thinning::GuoHall`]: Z. Guo and R. Hall, Communications of the ACM 32(3), 1989. Two passes a round; diagonals become
//!   one wide and nothing vanishes.
//! - [`Thinning::FourSides`]: a pass for each of north, south, west and east deletes the pixels bare on that
//!   side that are simple (their neighbours hang together without them) and no ends (two neighbours or more). By
//!   A. Rosenfeld, Information and Control 29(3), 1975, who proved that it keeps every figure and every hole.
//!
//! Where we deviate: 32 pixels at a time. Each neighbour is a word shifted by one, each condition a few logical operations
//! on words, and words without a pixel are skipped.
//!
//! Memory: two lines of words. Cost: some 60 operations for 32 pixels and pass; as many rounds as half the greatest width.

use super::bits::{BitMapMut, words_a_line};
use crate::image::Error;

/// Which sides a pass peels and what it spares; see the top of this file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thinning {
    /// Two passes a round, after Zhang and Suen.
    ZhangSuen,
    /// Two passes a round, after Guo and Hall.
    GuoHall,
    /// Four passes a round, one for each side, after Rosenfeld.
    FourSides,
}

/// Words of memory that [`thin`] takes for a map of lines of `width` pixels.
#[must_use]
pub const fn thin_memory(width: usize) -> usize {
    words_a_line(width).saturating_mul(2)
}

/// Thins a map until a round changes nothing; returns the number of pixels deleted.
///
/// # Errors
/// [`Error::BufferLength`] if `memory` is shorter than [`thin_memory`]; the map is then as it was.
pub fn thin(map: &mut BitMapMut<'_>, thinning: Thinning, memory: &mut [u32]) -> Result<usize, Error> {
    let (expected, got) = (thin_memory(map.width()), memory.len());
    let memory = memory.get_mut(..expected).ok_or(Error::BufferLength { name: "memory", expected, got })?;
    map.clear_past_width();
    let mut deleted = 0;
    loop {
        let before = deleted;
        match thinning {
            Thinning::ZhangSuen => {
                deleted += pass(map, memory, |p| zhang_suen(p, p.p3 & p.p5 & (p.p1 | p.p7)));
                deleted += pass(map, memory, |p| zhang_suen(p, p.p1 & p.p7 & (p.p3 | p.p5)));
            }
            Thinning::GuoHall => {
                deleted += pass(map, memory, |p| guo_hall(p, (p.p1 | p.p2 | !p.p4) & p.p3));
                deleted += pass(map, memory, |p| guo_hall(p, (p.p5 | p.p6 | !p.p8) & p.p7));
            }
            Thinning::FourSides => {
                deleted += pass(map, memory, |p| simple(p) & !p.p1);
                deleted += pass(map, memory, |p| simple(p) & !p.p5);
                deleted += pass(map, memory, |p| simple(p) & !p.p7);
                deleted += pass(map, memory, |p| simple(p) & !p.p3);
            }
        }
        if deleted == before {
            return Ok(deleted);
        }
    }
}

/// The neighbours of 32 pixels: bit `i` of `p3` is the pixel to the right of pixel `i`.
struct Neighbours {
    p1: u32,
    p2: u32,
    p3: u32,
    p4: u32,
    p5: u32,
    p6: u32,
    p7: u32,
    p8: u32,
}

impl Neighbours {
    /// Around the word in column `w` of three lines.
    #[inline(always)]
    fn new(lines: [&[u32]; 3], w: usize) -> Self {
        let centre = lines.map(|line| line[w]);
        let before = lines.map(|line| if w > 0 { line[w - 1] } else { 0 });
        let after = lines.map(|line| line.get(w + 1).copied().unwrap_or(0));
        let left = |line: usize| centre[line] << 1 | before[line] >> 31;
        let right = |line: usize| centre[line] >> 1 | after[line] << 31;
        Self {
            p1: centre[0],
            p2: right(0),
            p3: right(1),
            p4: right(2),
            p5: centre[2],
            p6: left(2),
            p7: left(1),
            p8: left(0),
        }
    }

    #[inline(always)]
    fn ring(&self) -> [u32; 8] {
        [self.p1, self.p2, self.p3, self.p4, self.p5, self.p6, self.p7, self.p8]
    }
}

/// Deletes what `goes` says of each pixel as it was before the pass.
fn pass(map: &mut BitMapMut<'_>, memory: &mut [u32], goes: impl Fn(&Neighbours) -> u32) -> usize {
    let columns = words_a_line(map.width());
    // Lines as they were: the one above and this one. The one below has not been touched yet.
    let (above, here) = memory.split_at_mut(columns);
    above.fill(0);
    let mut deleted = 0;
    let mut rest = map.words_mut();
    while let Some((line, below)) = rest.split_at_mut_checked(columns).filter(|(line, _)| !line.is_empty()) {
        here.copy_from_slice(line);
        // Past the last line there is nothing; any line of zeros would do, so the line above's place is not needed.
        let next = below.get(..columns);
        for w in 0..columns {
            if here[w] != 0 {
                let neighbours = match next {
                    Some(next) => Neighbours::new([above, here, next], w),
                    None => Neighbours { p4: 0, p5: 0, p6: 0, ..Neighbours::new([above, here, here], w) },
                };
                let gone = here[w] & goes(&neighbours);
                line[w] &= !gone;
                deleted += gone.count_ones() as usize;
            }
        }
        above.copy_from_slice(here);
        rest = below;
    }
    deleted
}

/// Bits that are set in at least one, two, three and seven of eight words.
struct Count {
    two: u32,
    seven: u32,
}

/// Counts neighbours, all 32 pixels at once: a full adder's columns.
#[inline(always)]
fn count(ring: [u32; 8]) -> Count {
    let (mut one, mut two, mut four, mut eight) = (0u32, 0u32, 0u32, 0u32);
    for word in ring {
        let carry = one & word;
        one ^= word;
        let carry_on = two & carry;
        two ^= carry;
        eight |= four & carry_on;
        four ^= carry_on;
    }
    Count { two: two | four | eight, seven: (four & two & one) | eight }
}

/// Zhang and Suen: two to six neighbours, one change from 0 to 1 around, and not all of `corner`.
#[inline(always)]
fn zhang_suen(p: &Neighbours, corner: u32) -> u32 {
    let ring = p.ring();
    let (mut once, mut more) = (0, 0);
    for i in 0..8 {
        let rise = !ring[i] & ring[(i + 1) % 8];
        more |= once & rise;
        once |= rise;
    }
    let count = count(ring);
    count.two & !count.seven & once & !more & !corner
}

/// Guo and Hall: one figure around, two or three neighbours in pairs at the least, and not `side`.
#[inline(always)]
fn guo_hall(p: &Neighbours, side: u32) -> u32 {
    let figures =
        [!p.p1 & (p.p2 | p.p3), !p.p3 & (p.p4 | p.p5), !p.p5 & (p.p6 | p.p7), !p.p7 & (p.p8 | p.p1)];
    let one_figure = exactly_one(figures);
    let at_least_two = |pairs: [u32; 4]| at_least_two(pairs);
    let first = [p.p8 | p.p1, p.p2 | p.p3, p.p4 | p.p5, p.p6 | p.p7];
    let second = [p.p1 | p.p2, p.p3 | p.p4, p.p5 | p.p6, p.p7 | p.p8];
    // The lesser of the two counts of pairs is two or three.
    let enough = at_least_two(first) & at_least_two(second);
    let all = |pairs: [u32; 4]| pairs[0] & pairs[1] & pairs[2] & pairs[3];
    one_figure & enough & !(all(first) & all(second)) & !side
}

/// Rosenfeld: the eight-connected figures around are one, and there are two neighbours or more.
#[inline(always)]
fn simple(p: &Neighbours) -> u32 {
    let figures =
        [!p.p1 & (p.p2 | p.p3), !p.p3 & (p.p4 | p.p5), !p.p5 & (p.p6 | p.p7), !p.p7 & (p.p8 | p.p1)];
    exactly_one(figures) & count(p.ring()).two
}

#[inline(always)]
fn at_least_two([a, b, c, d]: [u32; 4]) -> u32 {
    (a & b) | (c & d) | ((a | b) & (c | d))
}

#[inline(always)]
fn exactly_one(words: [u32; 4]) -> u32 {
    (words[0] | words[1] | words[2] | words[3]) & !at_least_two(words)
}

#[cfg(test)]
mod tests {
    use super::super::bits::tests::{draw, show};
    use super::*;

    fn thinned(picture: &[&str], thinning: Thinning) -> Vec<String> {
        let (mut words, width, height) = draw(picture);
        let mut memory = vec![u32::MAX; thin_memory(width)];
        let mut map = BitMapMut::new(&mut words, width, height).unwrap();
        let before = map.as_map().count();
        let deleted = thin(&mut map, thinning, &mut memory).unwrap();
        assert_eq!(before - deleted, map.as_map().count());
        show(map.as_map())
    }

    const ALL: [Thinning; 3] = [Thinning::ZhangSuen, Thinning::GuoHall, Thinning::FourSides];

    #[test]
    fn a_bar_becomes_a_line() {
        for thinning in ALL {
            let made = thinned(&["........", ".######.", ".######.", ".######.", "........"], thinning);
            assert!(made[2].contains("###"), "{thinning:?}: {made:#?}");
            assert_eq!((&*made[1], &*made[3]), ("........", "........"), "{thinning:?}");
        }
    }

    #[test]
    fn lines_and_rings_stay() {
        let picture =
            ["#...#...", ".#..#...", "..#..###", "........", ".##.....", "#..#....", "#..#....", ".##....."];
        for thinning in ALL {
            assert_eq!(thinned(&picture, thinning), picture, "{thinning:?}");
        }
    }

    #[test]
    fn what_is_known_of_two_by_two() {
        let left =
            |thinning| thinned(&["....", ".##.", ".##.", "...."], thinning).concat().matches('#').count();
        assert_eq!(left(Thinning::ZhangSuen), 0, "as published");
        assert!(left(Thinning::GuoHall) > 0);
        assert!(left(Thinning::FourSides) > 0);
    }

    #[test]
    fn counting_is_right_for_every_neighbourhood() {
        for pattern in 0u32..256 {
            let ring = core::array::from_fn(|i| pattern >> i & 1);
            let Count { two, seven } = count(ring);
            assert_eq!(two & 1 == 1, pattern.count_ones() >= 2, "{pattern:#b}");
            assert_eq!(seven & 1 == 1, pattern.count_ones() >= 7, "{pattern:#b}");
        }
    }

    #[test]
    fn short_memory_is_refused() {
        let mut words = [0; 4];
        let mut map = BitMapMut::new(&mut words, 33, 2).unwrap();
        let error = thin(&mut map, Thinning::GuoHall, &mut [0; 3]).unwrap_err();
        assert_eq!(error, Error::BufferLength { name: "memory", expected: 4, got: 3 });
    }
}
