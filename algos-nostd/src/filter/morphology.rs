//! Morphology: the least and the greatest value under a mask, and what follows from them.
//!
//! ```text
//!  input          eroded by 3 × 3      dilated by 3 × 3     gradient
//!  . . . . . .    . . . . . .          # # # # # #          # # # # # #
//!  . # # # # .    . . . . . .          # # # # # #          # # # # # #
//!  . # # # # .    . . # # . .          # # # # # #          # # . . # #
//! ```
//!
//! Reference: J. Serra, "Image Analysis and Mathematical Morphology", 1982; P. Soille, "Morphological Image Analysis",
//! 2nd edition, chapters 3 and 4. Dilation reflects the mask, so that opening and closing with any mask are
//! idempotent (away from the border, beyond which the edge is repeated); OpenCV does not reflect, which shows only
//! with masks that are not symmetric. A square needs 2 log₂ of its side comparisons across, because a run of equal
//! length is the union of two overlapping ones half as long.
//!
//! Opening is `Erode.then(Dilate)`, closing the reverse: [`open`], [`close`]. A top-hat is what opening removes:
//! [`Difference`](super::Difference) of an opening.
//!
//! Cost: a square `LINES + 2 log₂ COLUMNS` minima a pixel, a cross the same, any other mask one per place. Memory:
//! [`Neighbourhood::memory`]; [`STRIP`] columns on the stack.

use super::neighbourhood::{Neighbourhood, RowKernel, check_odd};
use crate::image::Error;
use crate::lines::Then;

/// Columns worked on at a time.
const STRIP: usize = 256;
/// Greatest width of a mask.
const COLUMNS_MAX: usize = 63;

/// The places that a morphological filter looks at, of `COLUMNS × LINES` around the centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mask<const COLUMNS: usize, const LINES: usize> {
    /// All of them.
    Rectangle,
    /// The centre's row and column.
    Cross,
    /// Those that are true, given row by row from the top left.
    Any([[bool; COLUMNS]; LINES]),
}

/// What is made of the values under the mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// The least value under the mask.
    Erode,
    /// The greatest value under the reflected mask.
    Dilate,
    /// The difference of both: a ridge along every edge.
    Gradient,
}

/// A morphological operation with a mask, as a row kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Morphology<const COLUMNS: usize, const LINES: usize> {
    operation: Operation,
    mask: Mask<COLUMNS, LINES>,
}

/// [`Morphology`] as a line filter.
pub type MorphologyFilter<'m, const COLUMNS: usize, const LINES: usize> =
    Neighbourhood<'m, Morphology<COLUMNS, LINES>, LINES>;

/// Two morphological operations, one after the other.
pub type MorphologyPair<'m, const COLUMNS: usize, const LINES: usize> =
    Then<MorphologyFilter<'m, COLUMNS, LINES>, MorphologyFilter<'m, COLUMNS, LINES>>;

/// Opening, erosion and then dilation: removes what is bright and smaller than the mask.
///
/// # Errors
/// As [`Morphology::new`] and [`Neighbourhood::new`], for each half of `memory` (of twice
/// [`Neighbourhood::memory`]).
pub fn open<const COLUMNS: usize, const LINES: usize>(
    mask: Mask<COLUMNS, LINES>,
    width: usize,
    memory: &mut [u8],
) -> Result<MorphologyPair<'_, COLUMNS, LINES>, Error> {
    pair([Operation::Erode, Operation::Dilate], mask, width, memory)
}

/// Closing, dilation and then erosion: fills what is dark and smaller than the mask.
///
/// # Errors
/// As [`open`].
pub fn close<const COLUMNS: usize, const LINES: usize>(
    mask: Mask<COLUMNS, LINES>,
    width: usize,
    memory: &mut [u8],
) -> Result<MorphologyPair<'_, COLUMNS, LINES>, Error> {
    pair([Operation::Dilate, Operation::Erode], mask, width, memory)
}

fn pair<const COLUMNS: usize, const LINES: usize>(
    [first, second]: [Operation; 2],
    mask: Mask<COLUMNS, LINES>,
    width: usize,
    memory: &mut [u8],
) -> Result<MorphologyPair<'_, COLUMNS, LINES>, Error> {
    let one = MorphologyFilter::<COLUMNS, LINES>::memory(width);
    let (expected, got) = (one.saturating_mul(2), memory.len());
    let (here, there) =
        memory.split_at_mut_checked(one).ok_or(Error::BufferLength { name: "memory", expected, got })?;
    if there.len() < one {
        return Err(Error::BufferLength { name: "memory", expected, got });
    }
    let first = Neighbourhood::new(Morphology::new(first, mask)?, width, here)?;
    let second = Neighbourhood::new(Morphology::new(second, mask)?, width, there)?;
    Ok(crate::lines::LineFilter::then(first, second))
}

impl<const COLUMNS: usize, const LINES: usize> Morphology<COLUMNS, LINES> {
    /// An operation with a mask.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a side of the mask is even, its width is over 63, or no place of it is true.
    pub fn new(operation: Operation, mask: Mask<COLUMNS, LINES>) -> Result<Self, Error> {
        check_odd("COLUMNS", COLUMNS)?;
        check_odd("LINES", LINES)?;
        if COLUMNS > COLUMNS_MAX {
            return Err(Error::Parameter { name: "COLUMNS", got: COLUMNS as i64, allowed: "at most 63" });
        }
        if matches!(mask, Mask::Any(places) if !places.as_flattened().contains(&true)) {
            return Err(Error::Parameter { name: "mask", got: 0, allowed: "a mask with at least one place" });
        }
        Ok(Self { operation, mask })
    }
}

impl<const COLUMNS: usize, const LINES: usize> RowKernel<LINES> for Morphology<COLUMNS, LINES> {
    const COLUMNS: usize = COLUMNS / 2;

    fn row(&mut self, rows: [&[u8]; LINES], made: &mut [u8]) {
        match self.operation {
            Operation::Erode => extreme::<Least, COLUMNS, LINES>(&self.mask, rows, made),
            Operation::Dilate => extreme::<Greatest, COLUMNS, LINES>(&self.mask, rows, made),
            Operation::Gradient => {
                for (index, made) in made.chunks_mut(STRIP).enumerate() {
                    let rows = rows.map(|row| &row[index * STRIP..][..made.len() + COLUMNS - 1]);
                    let mut least = [0; STRIP];
                    let least = &mut least[..made.len()];
                    extreme::<Least, COLUMNS, LINES>(&self.mask, rows, least);
                    extreme::<Greatest, COLUMNS, LINES>(&self.mask, rows, made);
                    // With a mask that lacks its centre the reflected one's greatest may be below the least.
                    for (made, &least) in made.iter_mut().zip(&*least) {
                        *made = made.saturating_sub(least);
                    }
                }
            }
        }
    }
}

/// Erosion's choice of two values, or dilation's.
trait Extreme {
    /// Whether the mask is turned by half a turn.
    const REFLECTED: bool;
    fn pick(a: u8, b: u8) -> u8;
}

struct Least;

impl Extreme for Least {
    const REFLECTED: bool = false;

    #[inline(always)]
    fn pick(a: u8, b: u8) -> u8 {
        a.min(b)
    }
}

struct Greatest;

impl Extreme for Greatest {
    const REFLECTED: bool = true;

    #[inline(always)]
    fn pick(a: u8, b: u8) -> u8 {
        a.max(b)
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn extreme<E: Extreme, const COLUMNS: usize, const LINES: usize>(
    mask: &Mask<COLUMNS, LINES>,
    rows: [&[u8]; LINES],
    made: &mut [u8],
) {
    for (index, made) in made.chunks_mut(STRIP).enumerate() {
        let width = made.len();
        let rows = rows.map(|row| &row[index * STRIP..][..width + COLUMNS - 1]);
        match mask {
            Mask::Rectangle => {
                let mut columns = [0; STRIP + COLUMNS_MAX];
                let columns = &mut columns[..width + COLUMNS - 1];
                columns.copy_from_slice(rows[0]);
                for row in &rows[1..] {
                    take_in::<E>(columns, row);
                }
                across::<E>(columns, COLUMNS, made);
            }
            Mask::Cross => {
                let mut centre = [0; STRIP + COLUMNS_MAX];
                let centre = &mut centre[..width + COLUMNS - 1];
                centre.copy_from_slice(rows[LINES / 2]);
                across::<E>(centre, COLUMNS, made);
                for row in &rows {
                    take_in::<E>(made, &row[COLUMNS / 2..]);
                }
            }
            Mask::Any(places) => {
                let mut first = true;
                for (y, places) in places.iter().enumerate() {
                    for (x, _) in places.iter().enumerate().filter(|(_, place)| **place) {
                        let (x, y) = if E::REFLECTED { (COLUMNS - 1 - x, LINES - 1 - y) } else { (x, y) };
                        let row = &rows[y][x..][..width];
                        if first {
                            made.copy_from_slice(row);
                            first = false;
                        } else {
                            take_in::<E>(made, row);
                        }
                    }
                }
            }
        }
    }
}

/// The extreme of what is there and what comes in.
#[inline(always)]
fn take_in<E: Extreme>(made: &mut [u8], row: &[u8]) {
    for (made, &value) in made.iter_mut().zip(row) {
        *made = E::pick(*made, value);
    }
}

/// The extremes of runs of `length` pixels; `row` is used up.
#[inline(always)]
fn across<E: Extreme>(row: &mut [u8], length: usize, made: &mut [u8]) {
    // Runs twice as long, as long as they are not too long.
    let mut run = 1;
    while 2 * run <= length {
        // Pixel x only needs pixels to its right, which are still those of the shorter runs.
        for x in 0..row.len() - run {
            row[x] = E::pick(row[x], row[x + run]);
        }
        run *= 2;
    }
    // The last step may overlap.
    let width = made.len();
    let (left, right) = (&row[..width], &row[length - run..][..width]);
    for x in 0..width {
        made[x] = E::pick(left[x], right[x]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::LineFilter;

    /// Runs a filter over a drawing: `#` is 9, `.` is 0.
    fn draw(mut filter: impl LineFilter<Input = u8, Output = u8>, picture: &[&str]) -> Vec<String> {
        let mut drawn = Vec::new();
        let mut sink = |line: &[u8]| {
            drawn.push(line.iter().map(|&value| if value == 0 { '.' } else { '#' }).collect::<String>());
        };
        for line in picture {
            let line: Vec<u8> = line.bytes().map(|byte| 9 * u8::from(byte == b'#')).collect();
            filter.push(&line, &mut sink).unwrap();
        }
        filter.finish(&mut sink);
        drawn
    }

    const PICTURE: [&str; 6] = [
        "........", //
        ".####...", //
        ".####.#.", //
        ".####...", //
        ".####...", //
        "........",
    ];

    fn filter<const C: usize, const L: usize>(
        operation: Operation,
        mask: Mask<C, L>,
        memory: &mut [u8],
    ) -> MorphologyFilter<'_, C, L> {
        Neighbourhood::new(Morphology::new(operation, mask).unwrap(), 8, memory).unwrap()
    }

    #[test]
    fn squares_shrink_and_grow() {
        let mut memory = [0; MorphologyFilter::<3, 3>::memory(8)];
        assert_eq!(
            draw(filter(Operation::Erode, Mask::<3, 3>::Rectangle, &mut memory), &PICTURE),
            ["........", "........", "..##....", "..##....", "........", "........"]
        );
        assert_eq!(
            draw(filter(Operation::Gradient, Mask::<3, 3>::Rectangle, &mut memory), &PICTURE),
            ["######..", "########", "##..####", "##..####", "######..", "######.."]
        );
        assert_eq!(
            draw(filter(Operation::Dilate, Mask::<3, 3>::Cross, &mut memory), &PICTURE),
            [".####...", "#######.", "########", "#######.", "######..", ".####..."]
        );
    }

    #[test]
    fn dilation_reflects_the_mask() {
        let mut memory = [0; MorphologyFilter::<3, 1>::memory(8)];
        let mask = Mask::Any([[false, true, true]]);
        assert_eq!(draw(filter(Operation::Erode, mask, &mut memory), &["..###..."]), ["..##...."]);
        assert_eq!(draw(filter(Operation::Dilate, mask, &mut memory), &["..##...."]), ["..###..."]);
    }

    #[test]
    fn opening_removes_and_closing_fills() {
        let mut memory = [0; 2 * MorphologyFilter::<3, 3>::memory(8)];
        assert_eq!(
            draw(open(Mask::<3, 3>::Rectangle, 8, &mut memory).unwrap(), &PICTURE),
            ["........", ".####...", ".####...", ".####...", ".####...", "........"]
        );
        assert_eq!(
            draw(close(Mask::<3, 1>::Rectangle, 8, &mut memory).unwrap(), &["..#.##.."]),
            ["..####.."],
        );
    }

    #[test]
    fn bad_parameters_say_what_is_right() {
        assert!(Morphology::<2, 3>::new(Operation::Erode, Mask::Rectangle).is_err());
        assert!(Morphology::<3, 4>::new(Operation::Erode, Mask::Cross).is_err());
        assert!(Morphology::<65, 1>::new(Operation::Erode, Mask::Cross).is_err());
        assert!(Morphology::<1, 1>::new(Operation::Erode, Mask::Any([[false]])).is_err());
        assert!(open(Mask::<3, 3>::Cross, 8, &mut [0; 75]).is_err());
    }
}
