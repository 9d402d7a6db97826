use super::staircase::{Stair, Staircase};
use super::{Point, Walk, Window};

/// Clips a line to a window by the sides on which it passes the corners. Equals [`clip_line`](super::clip_line).
///
/// ```text
///             ┊ ╲          The start's region decides which corners matter;
///       ┌─────┊──╲──┐      rays from the start through them split the plane
///       │     ┊   ╲ │      into parts, and the end's part names the sides
///       └─────┊────╲┘      that are crossed. Only these are divided for.
///          start
/// ```
///
/// Reference: T. M. Nicholl, D. T. Lee and R. A. Nicholl, "An efficient new algorithm for 2-D line clipping: its
/// development and analysis", SIGGRAPH 1987. Their mirrorings into three cases are the octant's here. We deviate in what is compared
/// with a corner: not the ideal line, but the pixel that is lit in the corner's column.
///
/// Cost: one division a side that is crossed, none for a line that misses, except where it slips between the pixels
/// of a corner. Memory: none.
#[must_use]
pub fn nicholl_lee_nicholl(from: Point, to: Point, window: &Window) -> Option<Walk> {
    let line = Staircase::new(from, to, window);
    if line.misses() {
        return None;
    }
    let (near, far) = (line.along_range.0, line.along_range.1);
    let (low, high) = (line.across_range.0, line.across_range.1);
    let entry = match (near > 0, low > 0) {
        (false, false) => Stair { step: 0, across: 0 },
        (true, false) => {
            // Left of the window: past the upper left corner?
            if line.passes_above(near, high) {
                return None;
            }
            line.stair_at(near)
        }
        (false, true) => {
            // Below the window: past the lower right corner?
            if line.passes_below(far, low) {
                return None;
            }
            line.first_on(low)
        }
        (true, true) => {
            // In the corner: past the upper left one, or the lower right one, or on which side of the near one?
            if line.passes_above(near, high) || line.passes_below(far, low) {
                return None;
            }
            if line.reaches(near, low) { line.stair_at(near) } else { line.first_on(low) }
        }
    };
    let last = match (line.major > far, line.minor > high) {
        (false, false) => line.major,
        (false, true) => line.last_before(high + 1),
        (true, true) if line.passes_above(far, high) => line.last_before(high + 1),
        (true, _) => far,
    };
    // Fails only between the pixels of a corner.
    (entry.step <= last).then(|| line.walk(entry, last))
}

impl Staircase {
    /// Whether the pixel at a step of 0 or more is above `across`, which is 0 or more.
    fn passes_above(&self, step: i32, across: i32) -> bool {
        self.minor > across && self.reaches(step, across + 1)
    }

    /// Whether the pixel at a step of 0 or more (if the line gets so far) is below `across`.
    fn passes_below(&self, step: i32, across: i32) -> bool {
        step < self.major && !self.reaches(step, across)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_decide() {
        let window = Window::new(Point::new(4, 2), Point::new(8, 4)).unwrap();
        let clip = |from, to| nicholl_lee_nicholl(from, to, &window);
        let start = Point::new(0, 0);
        assert_eq!(clip(start, Point::new(12, 12)).map(|w| w.position()), Some(Point::new(4, 4)));
        assert_eq!(clip(start, Point::new(12, 11)).map(|w| w.position()), Some(Point::new(4, 4)));
        assert_eq!(clip(start, Point::new(12, 4)).map(|w| w.position()), Some(Point::new(5, 2)));
        assert_eq!(clip(start, Point::new(16, 1)), None, "below the lower right corner");
        assert_eq!(clip(start, Point::new(9, 12)), None, "above the upper left corner");
    }
}
