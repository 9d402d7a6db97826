//! Rows cut into strips of a fixed number of columns: sums of a strip fit on the stack and in the first-level cache,
//! and loops over arrays of a fixed size need no bounds checks and no remainder.
//!
//! ```text
//! let mut strips = Strips::<ROWS, STRIP>::new(rows);
//! let mut last = [0; STRIP];
//! for made in made.chunks_mut(STRIP) {
//!     let rows: [&[u8; STRIP]; ROWS] = strips.next();
//!     let strip: &mut [u8; STRIP] = made.first_chunk_mut().unwrap_or(&mut last);
//!     // … make the strip …
//!     copy_narrow(&last, made);
//! }
//! ```
//!
//! This is no function that takes a closure: the closure would be compiled once, for all callers, and so without the
//! vector instructions that one of them was compiled with.

/// The rest of some rows, to be taken a strip at a time.
pub(super) struct Strips<'r, const ROWS: usize, const STRIP: usize> {
    rows: [&'r [u8]; ROWS],
    padded: [[u8; STRIP]; ROWS],
}

impl<'r, const ROWS: usize, const STRIP: usize> Strips<'r, ROWS, STRIP> {
    #[inline(always)]
    pub(super) fn new(rows: [&'r [u8]; ROWS]) -> Self {
        Self { rows, padded: [[0; STRIP]; ROWS] }
    }

    /// The next `STRIP` columns; where a row has fewer, the rest of its strip has no meaning.
    #[inline(always)]
    pub(super) fn next(&mut self) -> [&[u8; STRIP]; ROWS] {
        for (padded, row) in self.padded.iter_mut().zip(&mut self.rows) {
            if row.len() < STRIP {
                padded[..row.len()].copy_from_slice(row);
                *row = &[];
            }
        }
        let mut strips = self.padded.each_ref();
        for (strip, row) in strips.iter_mut().zip(&mut self.rows) {
            if let Some((first, others)) = row.split_first_chunk() {
                (*strip, *row) = (first, others);
            }
        }
        strips
    }
}

/// Copies the pixels of a last strip that is narrower than `STRIP`, which could not be made in place.
#[inline(always)]
pub(super) fn copy_narrow<T: Copy, const STRIP: usize>(last: &[T; STRIP], made: &mut [T]) {
    if made.len() < STRIP {
        made.copy_from_slice(&last[..made.len()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_cover_the_row() {
        for width in 0..20 {
            let row: Vec<u8> = (1..=width).collect();
            let mut made = vec![0; row.len()];
            let mut strips = Strips::<1, 4>::new([&row]);
            for made in made.chunks_mut(4) {
                let [strip] = strips.next();
                made.copy_from_slice(&strip[..made.len()]);
            }
            assert_eq!(made, row);
        }
    }
}
