use super::pixel::{fill_span, put};
use crate::clip::{Direction, Point, Walk, Window, clip_line};
use crate::image::ImageMut;

/// Pixels of a line that follow one another along its longer side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The first pixel of the run, in the line's own order.
    pub first: Point,
    /// The last one, which may be the same.
    pub last: Point,
}

/// The runs of a line, from its start to its end.
///
/// ```text
/// ■ ■ ■ . . . . . . .      all runs but the first and the last are floor(major/minor)
/// . . . ■ ■ ■ ■ . . .      pixels long, or one longer, which a single comparison
/// . . . . . . . ■ ■ ■      of the error term tells
/// ```
///
/// They are together exactly the pixels of the [`Walk`] that they are made from, so a clipped walk gives clipped runs.
///
/// Reference: J. E. Bresenham, "Run length slice algorithm for incremental lines", in Fundamental Algorithms for
/// Computer Graphics, 1985.
///
/// Cost: one division for the first run and one for the others' length; then additions only. Memory: this struct.
#[derive(Clone, Debug)]
pub struct Runs {
    first: Point,
    left: u32,
    error: i64,
    /// Twice the sides of the line.
    major: i64,
    minor: i64,
    /// The shorter of the two lengths that runs have, in pixels; all that is left if the line is level.
    short: u32,
    at_start: bool,
    along: Direction,
    across: Direction,
}

impl Runs {
    /// The runs of what is left of a walk.
    #[must_use]
    pub fn new(walk: &Walk) -> Self {
        let (major, minor) = walk.sides();
        let (along, across) = walk.directions();
        Self {
            first: walk.position(),
            left: walk.pixels_left(),
            error: i64::from(walk.error()),
            major: 2 * i64::from(major),
            minor: 2 * i64::from(minor),
            short: major.checked_div(minor).map_or(u32::MAX, |length| length as u32),
            at_start: true,
            along,
            across,
        }
    }
}

impl Iterator for Runs {
    type Item = Run;

    fn next(&mut self) -> Option<Run> {
        if self.left == 0 {
            return None;
        }
        // A run ends at the first pixel whose error is above 0.
        let length = if self.minor == 0 {
            self.left
        } else if self.at_start {
            if self.error > 0 { 1 } else { (-self.error / self.minor) as u32 + 2 }
        } else {
            let at_end = self.error + self.minor * i64::from(self.short - 1);
            self.short + u32::from(at_end <= 0)
        };
        self.at_start = false;
        self.error += self.minor * i64::from(length) - self.major;
        let length = length.min(self.left);
        self.left -= length;
        let moved = |point: Point, by: Direction, times: i16| {
            // Wraps only behind the last run.
            let along = |at: i16, by: i16| at.wrapping_add(by.wrapping_mul(times));
            Point::new(along(point.x, by.x), along(point.y, by.y))
        };
        let last = moved(self.first, self.along, (length - 1) as i16);
        let run = Run { first: self.first, last };
        self.first = moved(moved(last, self.along, 1), self.across, 1);
        Some(run)
    }
}

impl core::iter::FusedIterator for Runs {}

/// Draws a line of single pixels run by run. Equals [`draw_line`](super::draw_line); faster for lines that are nearly
/// level, whose runs are filled in bulk.
pub fn draw_line_runs<P: Copy>(image: &mut ImageMut<'_, P>, from: Point, to: Point, color: P) {
    let Some(walk) = clip_line(from, to, &Window::of_mut(image)) else { return };
    for Run { first, last } in Runs::new(&walk) {
        let ((x, y), (to_x, to_y)) = (wide(first), wide(last));
        if y == to_y {
            fill_span(image, (x.min(to_x), x.max(to_x)), y, color);
        } else {
            for y in y.min(to_y)..=y.max(to_y) {
                put(image, x, y, color);
            }
        }
    }
}

fn wide(point: Point) -> (i32, i32) {
    (i32::from(point.x), i32::from(point.y))
}

#[cfg(test)]
mod tests {
    use super::super::line::draw_line;
    use super::super::picture::{Picture, draw};
    use super::*;

    #[test]
    fn runs_are_the_walk_in_larger_pieces() {
        let ends = [(0, 0), (9, 2), (9, 0), (0, -9), (2, 9), (-9, -3), (-1, 9), (7, 7), (-8, 7)];
        for (x, y) in ends {
            let walk = Walk::new(Point::new(1, 2), Point::new(1 + x, 2 + y));
            for skipped in 0..walk.len() {
                let mut walk = walk.clone();
                let _ = walk.by_ref().take(skipped).last();
                let runs = Runs::new(&walk).flat_map(|run| Walk::new(run.first, run.last));
                assert!(runs.eq(walk), "to {x}, {y} from pixel {skipped} on");
            }
        }
    }

    #[test]
    fn the_same_pixels_as_draw_line() {
        for (x, y) in (-20..20).flat_map(|x| (-20..20).map(move |y| (x, y))) {
            let (from, to) = (Point::new(x, y), Point::new(9 - y, x));
            let runs: Picture<9, 8> = draw(|image| draw_line_runs(image, from, to, b'#'));
            assert_eq!(runs, draw(|image| draw_line(image, from, to, b'#')));
        }
    }

    #[test]
    fn the_longest_line_is_one_run() {
        let walk = Walk::new(Point::new(i16::MIN, 5), Point::new(i16::MAX, 5));
        let mut runs = Runs::new(&walk);
        let run = Run { first: Point::new(i16::MIN, 5), last: Point::new(i16::MAX, 5) };
        assert_eq!((runs.next(), runs.next()), (Some(run), None));
    }
}
