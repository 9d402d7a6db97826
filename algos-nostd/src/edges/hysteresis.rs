//! Hysteresis: from strong edge pixels along candidates, to every candidate that touches what was reached.
//!
//! ```text
//! candidates  . c c . c .        strong  . . . . . .        result  . # # . . .
//!             c . . . . .                # . . . . .                # . . . . .
//! ```
//!
//! Reference: J. Canny, "A computational approach to edge detection", IEEE PAMI 8(6), 1986, section VI ("thresholding
//! with hysteresis"). The answer is the textbook's, whole: all eight neighbours, to the fixed point, whatever the shape.
//!
//! This is the part of Canny that no window of lines can bound (the strong pixel that saves a candidate may be at the
//! other end of the picture), so it takes whole maps, of one bit a pixel.
//!
//! How: words of 32 pixels. What a word can be reached from are its own strong bits and those of its eight neighbour
//! words. From there each run of candidates fills at once: adding the seeds to the run lets the carry ripple from each
//! seed to the run's end, and the same on the reversed word fills towards its start. A word that has grown puts the
//! neighbour words behind the scan whose candidates its new bits touch on a stack. The stack is short and fixed. When it
//! is full the word is left out and one more scan of the map follows, against the direction of the last; a scan that never
//! finds the stack full has reached the fixed point. Words without open candidates cost two loads and a compare.
//!
//! Memory: 256 bytes of stack beside the two maps. Cost: one scan, and about 60 instructions for each time a word grows.

use super::bits::{BitMap, BitMapMut, last_word_mask, same_size, words_a_line};
use crate::image::Error;

/// Words that can wait for their turn. A photograph's curves need a few dozen.
const STACK: usize = 64;

/// Grows `strong` along `candidates` to the fixed point: on return a candidate is set in `strong` if and only if a chain
/// of candidates, each one of the eight neighbours of the one before, leads to it from a pixel that was set at first.
///
/// Strong pixels that are no candidates count as candidates.
///
/// # Errors
/// [`Error::SizeMismatch`] if the maps differ in size.
pub fn grow(candidates: BitMap<'_>, strong: &mut BitMapMut<'_>) -> Result<(), Error> {
    same_size((candidates.width(), candidates.height()), (strong.width(), strong.height()))?;
    strong.clear_past_width();
    let mut growth = Growth {
        columns: words_a_line(candidates.width()),
        last: last_word_mask(candidates.width()),
        candidates: candidates.words(),
        strong: strong.words_mut(),
        stack: [0; STACK],
        waiting: 0,
        overflow: false,
    };
    let words = candidates.words().len();
    let mut down = true;
    loop {
        growth.overflow = false;
        for step in 0..words {
            growth.scan(if down { step } else { words - 1 - step }, down);
        }
        if !growth.overflow {
            return Ok(());
        }
        down = !down;
    }
}

struct Growth<'a> {
    /// Words a line.
    columns: usize,
    /// Bits of a line's last word that are pixels.
    last: u32,
    candidates: &'a [u32],
    strong: &'a mut [u32],
    /// Words to be looked at again.
    stack: [u32; STACK],
    waiting: usize,
    /// A word found no place on the stack.
    overflow: bool,
}

impl Growth<'_> {
    /// Grows the word at `index`, and what the scan has passed and can grow from it.
    #[inline(always)]
    fn scan(&mut self, index: usize, down: bool) {
        if self.open(index) != 0 {
            self.visit(index, index, down);
            while self.waiting > 0 {
                self.waiting -= 1;
                let next = self.stack[self.waiting % STACK];
                self.visit(next as usize, index, down);
            }
        }
    }

    /// Candidates of a word that are not strong yet.
    #[inline(always)]
    fn open(&self, index: usize) -> u32 {
        match (self.candidates.get(index), self.strong.get(index)) {
            (Some(candidates), Some(strong)) => candidates & !strong,
            _ => 0, // above the first line or below the last
        }
    }

    /// The strong bits of three words of a line that touch the middle one's from another line or its own: bit `i`
    /// is set if one of the bits `i - 1`, `i`, `i + 1` is.
    #[inline(always)]
    fn touch(&self, index: usize, has_left: bool, has_right: bool) -> u32 {
        let Some(&centre) = self.strong.get(index) else { return 0 };
        let at = |index| self.strong.get(index).copied().unwrap_or(0);
        let left = if has_left { at(index.wrapping_sub(1)) >> 31 } else { 0 };
        let right = if has_right { at(index + 1) << 31 } else { 0 };
        centre | centre << 1 | centre >> 1 | left | right
    }

    /// Grows one word from itself and its neighbours, and remembers the neighbours that can grow from it and that the
    /// scan, which is at `cursor`, will not come to.
    fn visit(&mut self, index: usize, cursor: usize, down: bool) {
        let column = index.checked_rem(self.columns).unwrap_or(0);
        let (has_left, has_right) = (column > 0, column + 1 < self.columns);
        let mask = if has_right { u32::MAX } else { self.last };
        let open = self.open(index) & mask;
        let (above, below) = (index.wrapping_sub(self.columns), index + self.columns);
        let touched = self.touch(above, has_left, has_right)
            | self.touch(index, has_left, has_right)
            | self.touch(below, has_left, has_right);
        let seeds = open & touched;
        if seeds == 0 {
            return;
        }
        let added = fill(open, seeds);
        if let Some(strong) = self.strong.get_mut(index) {
            *strong |= added;
        }
        let reach = added | added << 1 | added >> 1;
        for line in [above, index, below] {
            if line != index {
                self.remember(line, reach, cursor, down);
            }
            if has_left && added & 1 != 0 {
                self.remember(line.wrapping_sub(1), 1 << 31, cursor, down);
            }
            if has_right && added >> 31 != 0 {
                self.remember(line.wrapping_add(1), 1, cursor, down);
            }
        }
    }

    #[inline(always)]
    fn remember(&mut self, index: usize, reach: u32, cursor: usize, down: bool) {
        let passed = if down { index <= cursor } else { index >= cursor };
        if passed && self.open(index) & reach != 0 {
            match (self.stack.get_mut(self.waiting), u32::try_from(index)) {
                (Some(place), Ok(index)) => {
                    *place = index;
                    self.waiting += 1;
                }
                _ => self.overflow = true,
            }
        }
    }
}

/// The runs of ones in `open` that hold a bit of `seeds`, a part of `open`.
///
/// In a run, adding a seed turns it and all ones above it to 0 by carry, up to the zero past the run's end. So the ones
/// that the sum has lost (and the seeds themselves, which come back where a carry meets them) are those from the lowest
/// seed upwards. Reversed, the same gives those downwards.
#[inline(always)]
fn fill(open: u32, seeds: u32) -> u32 {
    let up = |open: u32, seeds: u32| open & (!open.wrapping_add(seeds) | seeds);
    up(open, seeds) | up(open.reverse_bits(), seeds.reverse_bits()).reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::super::bits::tests::{draw, show};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_run_fills_from_any_of_its_pixels() {
        assert_eq!(fill(0b0111_0110, 0b0010_0000), 0b0111_0000);
        assert_eq!(fill(0b0111_0110, 0b0101_0010), 0b0111_0110);
        assert_eq!(fill(u32::MAX, 1 << 31), u32::MAX);
        assert_eq!(fill(u32::MAX, 1), u32::MAX);
        assert_eq!(fill(0b101, 0), 0);
    }

    #[test]
    fn all_eight_neighbours_count() {
        let candidates = [
            "#.....#..#",
            ".#...#....",
            "..#.#.....",
            "...s......",
            "..#.#.....",
            ".#...#....",
            "#.....#..#",
        ];
        let (mut strong, width, height) = draw(
            &candidates.map(|line| line.replace('#', ".").replace('s', "#")).each_ref().map(String::as_str),
        );
        let (words, ..) = draw(&candidates.map(|line| line.replace('s', "#")).each_ref().map(String::as_str));
        let mut map = BitMapMut::new(&mut strong, width, height).unwrap();
        grow(BitMap::new(&words, width, height).unwrap(), &mut map).unwrap();
        let expected = [
            "#.....#...",
            ".#...#....",
            "..#.#.....",
            "...#......",
            "..#.#.....",
            ".#...#....",
            "#.....#...",
        ];
        assert_eq!(show(map.as_map()), expected);
    }

    /// The definition: a queue of pixels.
    fn flood(candidates: BitMap<'_>, strong: BitMap<'_>) -> Vec<u32> {
        let (width, height) = (strong.width(), strong.height());
        let mut words = vec![0; strong.words().len()];
        let mut reached = BitMapMut::new(&mut words, width, height).unwrap();
        let mut queue: Vec<(usize, usize)> = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .filter(|&(x, y)| strong.get(x, y))
            .collect();
        while let Some((x, y)) = queue.pop() {
            if reached.as_map().get(x, y) {
                continue;
            }
            reached.set(x, y, true);
            for (dx, dy) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1), (2, 2)] {
                let (x, y) = ((x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1));
                if candidates.get(x, y) {
                    queue.push((x, y));
                }
            }
        }
        words
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn growth_is_the_flood(
            (width, height) in (1usize..100, 1usize..40),
            density in 1u32..4,
            seed in any::<u64>(),
        ) {
            let mut state = seed;
            let mut random = || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 32) as u32
            };
            let length = words_a_line(width) * height;
            // Denser maps percolate: long winding chains.
            let candidates: Vec<u32> = (0..length)
                .map(|_| (0..density).fold(0, |word, _| word | random()) & !(random() & random() & random()))
                .collect();
            let mut strong: Vec<u32> = (0..length).map(|_| (0..7).fold(u32::MAX, |word, _| word & random())).collect();
            let candidates = BitMap::new(&candidates, width, height).unwrap();
            let expected = flood(candidates, BitMap::new(&strong, width, height).unwrap());
            let mut map = BitMapMut::new(&mut strong, width, height).unwrap();
            grow(candidates, &mut map).unwrap();
            prop_assert_eq!(strong, expected);
        }
    }

    /// A spiral one pixel wide from the corner to the centre: the longest way a map has.
    fn spiral(side: usize) -> Vec<u32> {
        let mut words = vec![0; words_a_line(side) * side];
        let mut map = BitMapMut::new(&mut words, side, side).unwrap();
        let (mut x, mut y, mut dx, mut dy) = (0i32, 0i32, 1, 0);
        let mut turned = 0;
        map.set(0, 0, true);
        while turned < 2 {
            let at = |map: &BitMapMut<'_>, steps: i32| {
                let (x, y) = (x + dx * steps, y + dy * steps);
                x < 0
                    || y < 0
                    || x >= side as i32
                    || y >= side as i32
                    || map.as_map().get(x as usize, y as usize)
            };
            let inside = |steps: i32| {
                let (x, y) = (x + dx * steps, y + dy * steps);
                (0..side as i32).contains(&x) && (0..side as i32).contains(&y)
            };
            if at(&map, 1) || (inside(2) && at(&map, 2)) {
                (dx, dy) = (-dy, dx);
                turned += 1;
            } else {
                (x, y) = (x + dx, y + dy);
                map.set(x as usize, y as usize, true);
                turned = 0;
            }
        }
        words
    }

    #[test]
    fn a_spiral_is_followed_from_either_end() {
        let side = 151;
        let words = spiral(side);
        let candidates = BitMap::new(&words, side, side).unwrap();
        for start in [(0, 0), (side / 2, side / 2)] {
            let mut strong = vec![0; words.len()];
            let mut map = BitMapMut::new(&mut strong, side, side).unwrap();
            map.set(start.0, start.1, true);
            let expected = flood(candidates, map.as_map());
            grow(candidates, &mut map).unwrap();
            assert!(map.as_map().count() > side * side / 3, "{} pixels reached", map.as_map().count());
            assert_eq!(strong, expected);
        }
    }

    #[test]
    fn maps_of_two_sizes_are_refused() {
        let words = [0; 4];
        let mut strong = [0; 4];
        let mut map = BitMapMut::new(&mut strong, 4, 4).unwrap();
        assert_eq!(
            grow(BitMap::new(&words, 3, 4).unwrap(), &mut map),
            Err(Error::SizeMismatch { expected: (3, 4), got: (4, 4) })
        );
    }
}
