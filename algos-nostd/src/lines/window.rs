//! A window of lines around a line, edges replicated: what every neighbourhood filter looks through.
//!
//! ```text
//!            padding      width       padding
//! row 0       a a │ a b c … x y z │ z z          lines above the first are the first,
//! row 1       d d │ d e f …   …   │ …            lines below the last are the last
//! row 2 ►     …   │     the centre line
//! row 3
//! row 4                                           reach: 2 columns, 2 lines
//! ```
//!
//! The border is handled here and nowhere else: a pixel outside the picture is the nearest one inside. Each line is
//! copied once into a ring, with its first and last pixel repeated at either end, so that a kernel reads the rows as
//! plain slices of equal length and has no branch for the edge.
//!
//! Memory: `2 × lines + 1` rows of `width + 2 × columns` pixels, with gaps such that the pixels of a line begin at a whole
//! word of the memory (a misaligned copy costs a Cortex-M four times as much). Cost: one copy of each line.
//!
//! ```
//! use algos_nostd::lines::{Reach, Window};
//!
//! // The maximum of each pixel and the ones above and below it.
//! const REACH: Reach = Reach { columns: 0, lines: 1 };
//! let mut memory = [0; Window::<u8>::memory(3, REACH)];
//! let mut window = Window::new(3, REACH, &mut memory)?;
//! let mut made = [[0; 3]; 2];
//! let mut emit = |y: usize, [above, centre, below]: [&[u8]; 3]| {
//!     for x in 0..3 {
//!         made[y][x] = above[x].max(centre[x]).max(below[x]);
//!     }
//! };
//! assert!(!window.push(&[1, 2, 9])?, "the first line waits for the second");
//! assert!(window.push(&[4, 0, 3])?);
//! emit(0, window.rows());
//! while window.drain() {
//!     emit(1, window.rows());
//! }
//! assert_eq!(made, [[4, 2, 9], [4, 2, 9]]);
//! # Ok::<(), algos_nostd::image::Error>(())
//! ```

use core::ops::Range;

use super::check_width;
use crate::image::Error;

/// How far a kernel looks from its centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Pixels to the left and to the right.
    pub columns: usize,
    /// Lines up and down; also the latency, in lines, of a filter that looks through the window.
    pub lines: usize,
}

impl Reach {
    /// As far one way as the other: a square kernel of `2 × radius + 1` pixels a side.
    #[must_use]
    pub const fn square(radius: usize) -> Self {
        Self { columns: radius, lines: radius }
    }

    const fn rows(self) -> usize {
        self.lines.saturating_mul(2).saturating_add(1)
    }
}

/// The lines around the one whose output is being made.
///
/// [`Window::push`] and [`Window::drain`] say when there is a centre line; [`Window::rows`] then shows it and its
/// neighbours.
#[derive(Debug)]
pub struct Window<'m, T> {
    memory: &'m mut [T],
    width: usize,
    reach: Reach,
    /// Row of the ring that holds the last line pushed.
    newest: usize,
    /// Lines of this frame in the ring.
    held: usize,
    /// Lines pushed but not yet the centre, save in [`Window::drain`], where the next centre is already taken off.
    pending: usize,
}

impl<'m, T: Copy> Window<'m, T> {
    /// Elements of memory that a window takes.
    #[must_use]
    pub const fn memory(width: usize, reach: Reach) -> usize {
        reach.rows().saturating_mul(Self::stride(width, reach))
    }

    /// Elements before the first pixel of a line: the padding, and what brings the pixel to a whole word.
    const fn front(reach: Reach) -> usize {
        whole_words::<T>(reach.columns)
    }

    /// Elements from the start of a row to that of the next.
    const fn stride(width: usize, reach: Reach) -> usize {
        Self::front(reach).saturating_add(whole_words::<T>(width.saturating_add(reach.columns)))
    }

    /// Where the padded row in a slot of the ring begins and ends.
    fn place(&self, slot: usize) -> Range<usize> {
        let Reach { columns, .. } = self.reach;
        let start = slot * Self::stride(self.width, self.reach) + Self::front(self.reach) - columns;
        start..start + padded(self.width, self.reach)
    }

    /// A window over lines of `width` pixels; `memory` may be longer than [`Window::memory`], the rest is not used.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if `width` is zero, [`Error::BufferLength`] if `memory` is too short.
    pub fn new(width: usize, reach: Reach, memory: &'m mut [T]) -> Result<Self, Error> {
        if width == 0 {
            return Err(Error::ZeroSize { width, height: reach.rows() });
        }
        let (expected, got) = (Self::memory(width, reach), memory.len());
        let memory =
            memory.get_mut(..expected).ok_or(Error::BufferLength { name: "memory", expected, got })?;
        Ok(Self { memory, width, reach, newest: 0, held: 0, pending: 0 })
    }

    /// Pixels a line, without the padding.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// How far the window looks.
    #[must_use]
    pub fn reach(&self) -> Reach {
        self.reach
    }

    /// Whether no line of the current frame has been pushed yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.held == 0
    }

    /// Takes the next line; true if there is now a centre line, which lies `reach.lines` above it.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if the line is not `width` pixels; it is then not taken.
    pub fn push(&mut self, line: &[T]) -> Result<bool, Error> {
        check_width(self.width, line.len())?;
        Ok(self.push_with(|row| {
            for (place, &pixel) in row.iter_mut().zip(line) {
                *place = pixel;
            }
        }))
    }

    /// Takes the next line as `make` writes it, all `width` pixels of it, into the window itself: a line that is computed
    /// need not be copied. True as in [`Window::push`].
    pub fn push_with(&mut self, make: impl FnOnce(&mut [T])) -> bool {
        self.newest = if self.newest + 1 < self.reach.rows() { self.newest + 1 } else { 0 };
        self.held = (self.held + 1).min(self.reach.rows());

        let Reach { columns, lines } = self.reach;
        let place = self.place(self.newest);
        // All of these are there: the memory was checked, and the width is not zero.
        if let Some(row) = self.memory.get_mut(place)
            && let Some((left, rest)) = row.split_at_mut_checked(columns)
            && let Some((middle, right)) = rest.split_at_mut_checked(self.width)
        {
            make(middle);
            if let (Some(&first), Some(&last)) = (middle.first(), middle.last()) {
                left.fill(first);
                right.fill(last);
            }
        }
        self.pending = self.held.min(lines);
        self.held > lines
    }

    /// After the last line: moves on to the next line that has not been the centre yet; true if there is one.
    /// After false the window is empty and ready for the next frame.
    pub fn drain(&mut self) -> bool {
        if self.pending == 0 {
            self.held = 0;
            return false;
        }
        self.pending -= 1;
        true
    }

    /// Row `index` of the window, of `width + 2 × columns` pixels; row `reach.lines` is the centre line. Before the first
    /// centre line the content has no meaning. A row below the last is the last.
    #[must_use]
    pub fn row(&self, index: usize) -> &[T] {
        // Ages: 0 is the newest line. The centre has as many lines below it as wait to be the centre.
        let centre = self.pending;
        let oldest = self.held.saturating_sub(1);
        let age = (centre + self.reach.lines).saturating_sub(index).min(oldest);
        let slot = if age <= self.newest { self.newest - age } else { self.newest + self.reach.rows() - age };
        self.memory.get(self.place(slot)).unwrap_or_default()
    }

    /// The first `N` rows of the window from top to bottom, each of `width + 2 × columns` pixels: all of them if `N` is
    /// `2 × reach.lines + 1`, as it should be.
    #[must_use]
    pub fn rows<const N: usize>(&self) -> [&[T]; N] {
        debug_assert!(N == self.reach.rows(), "as many rows as the window has");
        core::array::from_fn(|index| self.row(index))
    }
}

/// The `N` slices of `width` elements that start at columns 0, 1, … `N − 1` of a padded row: the row as seen by each
/// column of a kernel. Slices of one known length let a kernel's loop run without bounds checks.
///
/// `None` if the row is shorter than `width + N − 1`.
#[must_use]
#[inline(always)]
pub fn shifted<T, const N: usize>(row: &[T], width: usize) -> Option<[&[T]; N]> {
    let mut slices = [row; N];
    for (shift, slice) in slices.iter_mut().enumerate() {
        *slice = row.get(shift..)?.get(..width)?;
    }
    Some(slices)
}

/// So many elements of `T`, or the next number that fills whole words.
const fn whole_words<T>(elements: usize) -> usize {
    match elements.checked_next_multiple_of(if size_of::<T>() < 4 { 4 / size_of::<T>() } else { 1 }) {
        Some(elements) => elements,
        None => usize::MAX,
    }
}

/// Elements of a row with its padding.
const fn padded(width: usize, reach: Reach) -> usize {
    width.saturating_add(reach.columns.saturating_mul(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every window over lines named a, b, c… of `width` pixels, drawn as text: a row of letters a centre line.
    fn windows<const N: usize>(height: usize) -> Vec<String> {
        let reach = Reach { columns: 0, lines: N / 2 };
        let mut memory = vec![0; Window::<u8>::memory(1, reach)];
        let mut window = Window::new(1, reach, &mut memory).unwrap();
        let mut seen = Vec::new();
        for frame in 0..2 {
            seen.clear();
            let letters = |window: &Window<u8>| window.rows::<N>().map(|row| row[0] as char).iter().collect();
            for y in 0..height {
                if window.push(&[b'a' + (frame * height + y) as u8]).unwrap() {
                    seen.push(letters(&window));
                }
            }
            while window.drain() {
                seen.push(letters(&window));
            }
        }
        seen
    }

    #[test]
    fn lines_outside_are_the_nearest_inside() {
        // The second frame's lines: nothing is left of the first's.
        assert_eq!(windows::<3>(4), ["eef", "efg", "fgh", "ghh"]);
        assert_eq!(windows::<5>(3), ["dddef", "ddeff", "defff"]);
        assert_eq!(windows::<5>(1), ["bbbbb"]);
        assert_eq!(windows::<7>(2), ["ccccddd", "cccdddd"]);
        assert_eq!(windows::<1>(2), ["c", "d"]);
        assert_eq!(windows::<3>(0), [""; 0]);
    }

    #[test]
    fn columns_outside_are_the_nearest_inside() {
        const REACH: Reach = Reach { columns: 2, lines: 0 };
        let mut memory = [0; Window::<u8>::memory(3, REACH) + 1];
        let mut window = Window::new(3, REACH, &mut memory).unwrap();
        assert_eq!(window.push(&[1, 2, 3]), Ok(true));
        assert_eq!(window.rows(), [&[1, 1, 1, 2, 3, 3, 3]]);
        let expected = [[1, 1, 1, 2, 3], [1, 1, 2, 3, 3], [1, 2, 3, 3, 3]];
        assert_eq!(shifted(window.row(0), 5), Some(expected.each_ref().map(|row| &row[..])));
        assert_eq!(shifted::<_, 4>(window.row(0), 5), None);
        let narrow = Error::BufferLength { name: "line", expected: 3, got: 2 };
        assert_eq!(window.push(&[1, 2]), Err(narrow));
        assert!(!window.drain(), "a refused line is not taken");
    }

    #[test]
    fn bad_sizes_say_what_was_expected() {
        let reach = Reach::square(1);
        assert_eq!(
            Window::<u8>::new(0, reach, &mut []).unwrap_err(),
            Error::ZeroSize { width: 0, height: 3 }
        );
        assert_eq!(
            Window::<u8>::new(2, reach, &mut [0; 11]).unwrap_err(),
            Error::BufferLength { name: "memory", expected: 24, got: 11 }
        );
        assert!(Window::<u8>::new(usize::MAX, reach, &mut []).is_err());
        assert!(Window::<u8>::new(1, Reach::square(usize::MAX), &mut []).is_err());
    }
}
