use super::walk::fill_by_walking;
use super::{Area, OneColor};
use crate::clip::Point;
use crate::image::ImageMut;

/// A run of pixels whose neighbours in the next line are still to be looked at; memory for [`flood_fill`] to lend.
#[derive(Clone, Copy, Debug, Default)]
pub struct PendingRun {
    /// The line to look at.
    y: u16,
    /// First and last column of the run in the line before.
    left: u16,
    right: u16,
    upwards: bool,
}

impl PendingRun {
    /// Memory to lend.
    pub const EMPTY: Self = Self { y: 0, left: 0, right: 0, upwards: false };
}

/// Fills the pixels of the seed's colour that are joined to it, run by run. Returns how many were filled.
///
/// ```text
/// █ . . . . █ .       s: the seed; its run is filled at once,
/// █ . s . . . █       then runs that touch it below and above (1, 2);
/// █ 1 1 █ 2 2 █       a run that reaches past its parent looks back (3)
/// █ 1 █ █ █ 2 2
/// ```
///
/// A seed outside of the picture, or one that has the new colour already, fills nothing.
///
/// Reference: P. Heckbert, "A seed fill algorithm", Graphics Gems, 1990. We compare and write whole runs instead of
/// pixels, and fill what the lent memory cannot hold by [walking](super::flood_fill_walk), so any length of it, even none, will do.
///
/// Cost: each line of the area is compared once and written once. Memory: `pending`; 64 runs (512 bytes) hold all but
/// contrived areas, an open one takes 2.
pub fn flood_fill<P: Copy + PartialEq>(
    image: &mut ImageMut<'_, P>,
    seed: Point,
    color: P,
    pending: &mut [PendingRun],
) -> usize {
    OneColor::at(image, seed, color).map_or(0, |mut area| fill_runs(&mut area, seed, pending))
}

/// The same for any area that has the seed.
pub(super) fn fill_runs(area: &mut impl Area, seed: Point, pending: &mut [PendingRun]) -> usize {
    let (x, y) = (i32::from(seed.x), i32::from(seed.y));
    if !area.has(x, y) {
        return 0;
    }
    let mut runs = Runs { pending, length: 0, filled: 0 };
    let (start, end) = (area.run_start(x, y), area.run_end(x, y));
    runs.paint(area, start, end, y);
    runs.push(area, (start, end), y, false);
    runs.push(area, (start, end), y, true);
    while let Some(run) = runs.pop() {
        let (y, left, right) = (i32::from(run.y), i32::from(run.left), i32::from(run.right));
        let mut start =
            if area.has(left, y) { area.run_start(left, y) } else { next_in(area, left + 1, right + 1, y) };
        while start <= right {
            let end = area.run_end(start.max(left), y);
            runs.paint(area, start, end, y);
            runs.push(area, (start, end), y, run.upwards);
            // Beyond the parent on either side, look back; the pixels next to the parent are its walls.
            if start < left - 1 {
                runs.push(area, (start, left - 1), y, !run.upwards);
            }
            if end > right + 2 {
                runs.push(area, (right + 2, end), y, !run.upwards);
            }
            start = next_in(area, end + 1, right + 1, y);
        }
    }
    runs.filled
}

/// The first column from `x` to before `end` that the area has, or `end` or more.
fn next_in(area: &impl Area, x: i32, end: i32, y: i32) -> i32 {
    (x..end).find(|&x| area.has(x, y)).unwrap_or(end)
}

/// The stack of runs in lent memory.
struct Runs<'a> {
    pending: &'a mut [PendingRun],
    length: usize,
    /// Pixels painted so far.
    filled: usize,
}

impl Runs<'_> {
    fn paint(&mut self, area: &mut impl Area, start: i32, end: i32, y: i32) {
        area.paint(start, end, y);
        self.filled += (end - start) as usize;
    }

    /// Remembers to look at the line next to `y`; if there is no room, fills what is there straight away.
    fn push(&mut self, area: &mut impl Area, (start, end): (i32, i32), y: i32, upwards: bool) {
        let y = if upwards { y - 1 } else { y + 1 };
        if y < 0 || y >= area.size().1 {
            return;
        }
        if let Some(place) = self.pending.get_mut(self.length) {
            *place = PendingRun { y: y as u16, left: start as u16, right: (end - 1) as u16, upwards };
            self.length += 1;
        } else {
            for x in start..end {
                if area.has(x, y) {
                    self.filled += fill_by_walking(area, x, y);
                }
            }
        }
    }

    fn pop(&mut self) -> Option<PendingRun> {
        self.length = self.length.checked_sub(1)?;
        self.pending.get(self.length).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::picture::{Picture, draw_over};
    use super::*;

    #[test]
    fn around_corners_and_not_through_diagonals() {
        let plan: Picture<9, 6> = [
            *b"...#..#..", //
            *b".###.#...",
            *b".#...#.#.",
            *b".#.#.##..",
            *b".#.#..#.#",
            *b"...##..#.",
        ];
        let expected = [
            *b"~~~#~~#..", //
            *b"~###~#...",
            *b"~#~~~#.#.",
            *b"~#~#~##..",
            *b"~#~#~~#.#",
            *b"~~~##~~#.",
        ];
        for memory in 0..5 {
            let filled = draw_over(plan, |image| {
                let pending = &mut [PendingRun::default(); 5][..memory];
                assert_eq!(flood_fill(image, Point::new(0, 0), b'~', pending), 23);
            });
            assert_eq!(filled, expected, "with memory for {memory} runs");
        }
    }

    #[test]
    fn nothing_to_fill() {
        let plan: Picture<3, 1> = [*b".#."];
        let mut pending = [PendingRun::default(); 4];
        let same = draw_over(plan, |image| {
            assert_eq!(flood_fill(image, Point::new(0, 0), b'.', &mut pending), 0);
            assert_eq!(flood_fill(image, Point::new(3, 0), b'~', &mut pending), 0);
            assert_eq!(flood_fill(image, Point::new(0, -1), b'~', &mut pending), 0);
        });
        assert_eq!(same, plan);
    }
}
