//! Pictures of one bit a pixel, in words that the caller lends.
//!
//! ```text
//! pixel   0 1 2 … 31 │ 32 33 … 63 │ 64 …       each line starts a new word;
//! bit     0 1 2 … 31 │  0  1 … 31 │  0 …       bits past the width mean nothing and are kept 0
//! word        0      │      1     │  2
//! ```
//!
//! An edge map at VGA takes 38,400 bytes in this form, an eighth of a byte map, and what looks at neighbours
//! ([`super::grow`], [`super::thin`]) looks at 32 of them in one operation.

use crate::image::Error;

/// Pixels in a word.
pub const PIXELS_A_WORD: usize = 32;

/// Words in a line of `width` pixels.
#[must_use]
pub const fn words_a_line(width: usize) -> usize {
    width.div_ceil(PIXELS_A_WORD)
}

/// Words in a map of `width × height` pixels.
#[must_use]
pub const fn words_a_map(width: usize, height: usize) -> usize {
    words_a_line(width).saturating_mul(height)
}

/// The bits of a line's last word that are pixels.
pub(super) const fn last_word_mask(width: usize) -> u32 {
    u32::MAX >> ((PIXELS_A_WORD - width % PIXELS_A_WORD) % PIXELS_A_WORD)
}

/// Words that a map takes, or why it can't be.
fn checked_length(width: usize, height: usize, got: usize) -> Result<usize, Error> {
    if width == 0 || height == 0 {
        return Err(Error::ZeroSize { width, height });
    }
    let expected = words_a_map(width, height);
    if got < expected { Err(Error::BufferLength { name: "words", expected, got }) } else { Ok(expected) }
}

/// A map of bits, borrowed from its owner.
#[derive(Clone, Copy, Debug)]
pub struct BitMap<'a> {
    words: &'a [u32],
    width: usize,
    height: usize,
}

/// The same, to be written to.
#[derive(Debug)]
pub struct BitMapMut<'a> {
    words: &'a mut [u32],
    width: usize,
    height: usize,
}

impl<'a> BitMap<'a> {
    /// A map of `width × height` pixels in [`words_a_map`] words; more may be given.
    ///
    /// # Errors
    /// If a side is zero or `words` is too short.
    pub fn new(words: &'a [u32], width: usize, height: usize) -> Result<Self, Error> {
        let length = checked_length(width, height, words.len())?;
        Ok(Self { words: &words[..length], width, height })
    }

    /// Pixels a line.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Lines.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All words, line after line.
    #[must_use]
    pub fn words(&self) -> &'a [u32] {
        self.words
    }

    /// The lines, top to bottom, each of [`words_a_line`] words.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &'a [u32]> + DoubleEndedIterator + use<'a> {
        self.words.chunks_exact(words_a_line(self.width))
    }

    /// Whether the pixel in column `x` of line `y` is set; outside the map nothing is.
    #[must_use]
    pub fn get(&self, x: usize, y: usize) -> bool {
        x < self.width && y < self.height && {
            let word = self.words[y * words_a_line(self.width) + x / PIXELS_A_WORD];
            word >> (x % PIXELS_A_WORD) & 1 != 0
        }
    }

    /// Pixels that are set.
    #[must_use]
    pub fn count(&self) -> usize {
        let mask = last_word_mask(self.width);
        self.rows()
            .map(|row| {
                let past = row.last().map_or(0, |last| (last & !mask).count_ones());
                row.iter().map(|word| word.count_ones() as usize).sum::<usize>() - past as usize
            })
            .sum()
    }
}

impl<'a> BitMapMut<'a> {
    /// A map of `width × height` pixels in [`words_a_map`] words; more may be given.
    ///
    /// # Errors
    /// If a side is zero or `words` is too short.
    pub fn new(words: &'a mut [u32], width: usize, height: usize) -> Result<Self, Error> {
        let length = checked_length(width, height, words.len())?;
        Ok(Self { words: &mut words[..length], width, height })
    }

    /// Pixels a line.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Lines.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The map, to be read.
    #[must_use]
    pub fn as_map(&self) -> BitMap<'_> {
        BitMap { words: self.words, width: self.width, height: self.height }
    }

    /// The same map, lent on.
    #[must_use]
    pub fn reborrow(&mut self) -> BitMapMut<'_> {
        BitMapMut { words: self.words, width: self.width, height: self.height }
    }

    /// All words, line after line.
    #[must_use]
    pub fn words_mut(&mut self) -> &mut [u32] {
        self.words
    }

    /// The lines, top to bottom, each of [`words_a_line`] words.
    pub fn rows_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [u32]> + DoubleEndedIterator {
        self.words.chunks_exact_mut(words_a_line(self.width))
    }

    /// Sets or clears the pixel in column `x` of line `y`; outside the map nothing happens.
    pub fn set(&mut self, x: usize, y: usize, value: bool) {
        if x < self.width && y < self.height {
            let word = &mut self.words[y * words_a_line(self.width) + x / PIXELS_A_WORD];
            let bit = 1 << (x % PIXELS_A_WORD);
            *word = if value { *word | bit } else { *word & !bit };
        }
    }

    /// Clears every pixel.
    pub fn clear(&mut self) {
        self.words.fill(0);
    }

    /// Copies another map of the same size.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] if the sizes differ.
    pub fn copy_from(&mut self, other: BitMap<'_>) -> Result<(), Error> {
        same_size((self.width, self.height), (other.width, other.height))?;
        self.words.copy_from_slice(other.words);
        Ok(())
    }

    /// Clears the bits past the width, which a caller's memory may have set.
    pub(super) fn clear_past_width(&mut self) {
        let mask = last_word_mask(self.width);
        if mask != u32::MAX {
            for row in self.rows_mut() {
                if let Some(last) = row.last_mut() {
                    *last &= mask;
                }
            }
        }
    }
}

/// Two maps must be of one size.
pub(super) fn same_size(expected: (usize, usize), got: (usize, usize)) -> Result<(), Error> {
    if expected == got { Ok(()) } else { Err(Error::SizeMismatch { expected, got }) }
}

/// Unpacks a line of bits into bytes: 255 where a bit is set, else 0. Stops with the shorter of the two.
pub fn unpack(words: &[u32], bytes: &mut [u8]) {
    for (word, bytes) in words.iter().zip(bytes.chunks_mut(PIXELS_A_WORD)) {
        for (i, byte) in bytes.iter_mut().enumerate() {
            *byte = (word >> i & 1) as u8 * 255;
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Words of a drawing, `#` set; and its width and height.
    pub(crate) fn draw(picture: &[&str]) -> (Vec<u32>, usize, usize) {
        let (width, height) = (picture[0].len(), picture.len());
        let mut words = vec![0; words_a_map(width, height)];
        let mut map = BitMapMut::new(&mut words, width, height).unwrap();
        for (y, line) in picture.iter().enumerate() {
            assert_eq!(line.len(), width, "a ragged drawing");
            line.bytes().enumerate().for_each(|(x, byte)| map.set(x, y, byte == b'#'));
        }
        (words, width, height)
    }

    /// The drawing of a map.
    pub(crate) fn show(map: BitMap<'_>) -> Vec<String> {
        let pixel = |x, y| if map.get(x, y) { '#' } else { '.' };
        (0..map.height()).map(|y| (0..map.width()).map(|x| pixel(x, y)).collect()).collect()
    }

    #[test]
    fn drawings_come_back() {
        let picture = ["#..#", ".##.", "...."];
        let (words, width, height) = draw(&picture);
        assert_eq!(words, [0b1001, 0b0110, 0]);
        let map = BitMap::new(&words, width, height).unwrap();
        assert_eq!(show(map), picture);
        assert_eq!(map.count(), 4);
        let mut bytes = [7; 4];
        unpack(&words[..1], &mut bytes);
        assert_eq!(bytes, [255, 0, 0, 255]);
    }

    #[test]
    fn what_lies_past_the_width_does_not_count() {
        let mut words = [u32::MAX; 4];
        let mut map = BitMapMut::new(&mut words, 33, 2).unwrap();
        assert_eq!(map.as_map().count(), 66);
        assert!(!map.as_map().get(33, 0) && !map.as_map().get(0, 2));
        map.set(33, 0, true);
        map.clear_past_width();
        assert_eq!(words, [u32::MAX, 1, u32::MAX, 1]);
        assert_eq!(last_word_mask(32), u32::MAX);
    }

    #[test]
    fn bad_sizes_say_what_was_expected() {
        assert_eq!(BitMap::new(&[], 0, 1).unwrap_err(), Error::ZeroSize { width: 0, height: 1 });
        assert_eq!(
            BitMapMut::new(&mut [0; 3], 33, 2).unwrap_err(),
            Error::BufferLength { name: "words", expected: 4, got: 3 }
        );
        assert!(BitMap::new(&[], usize::MAX, usize::MAX).is_err());
    }
}
