use super::staircase::{Stair, Staircase};
use super::{Point, Walk, Window};

/// Clips a line to a window by outcodes, one edge at a time. Equals [`clip_line`](super::clip_line).
///
/// ```text
///   1001 │ 1000 │ 1010       bits: over, under, right, left of the window
///  ──────┼──────┼──────      both codes 0: accept; a bit in common: reject;
///   0001 │ 0000 │ 0010       else an end that is outside moves along the line
///  ──────┼──────┼──────      to the first edge that its code names
///   0101 │ 0100 │ 0110
/// ```
///
/// Reference: I. Sutherland and D. Cohen, in Newman and Sproull, "Principles of Interactive Computer Graphics", 1973.
/// We deviate in that an end moves to a *pixel of the line*, the first in order behind the edge, so that its code
/// is exact and nothing is rounded; and in working in the line's own octant.
///
/// Cost: one division an edge, up to four, and some in vain when the line misses a corner. Memory: none.
#[must_use]
pub fn cohen_sutherland(from: Point, to: Point, window: &Window) -> Option<Walk> {
    let line = Staircase::new(from, to, window);
    let mut first = Stair { step: 0, across: 0 };
    let mut last = Stair { step: line.major, across: line.minor };
    loop {
        let (first_code, last_code) = (line.outcode(first), line.outcode(last));
        if first_code & last_code != 0 {
            return None;
        }
        if first_code & LEFT != 0 {
            first = line.stair_at(line.along_range.0);
        } else if first_code & UNDER != 0 {
            first = line.first_on(line.across_range.0);
        } else if last_code & RIGHT != 0 {
            last = line.stair_at(line.along_range.1);
        } else if last_code & OVER != 0 {
            last = line.stair_at(line.last_before(line.across_range.1 + 1));
        } else {
            // A line in its octant runs to the right and upwards, so it cannot start over or right of a window that
            // it has not missed, and no other bits are left.
            return Some(line.walk(first, last.step));
        }
    }
}

const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const UNDER: u8 = 4;
const OVER: u8 = 8;

impl Staircase {
    /// On which sides of the window a pixel is outside.
    fn outcode(&self, stair: Stair) -> u8 {
        let bit = |outside: bool, bit: u8| if outside { bit } else { 0 };
        bit(stair.step < self.along_range.0, LEFT)
            | bit(stair.step > self.along_range.1, RIGHT)
            | bit(stair.across < self.across_range.0, UNDER)
            | bit(stair.across > self.across_range.1, OVER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_name_the_sides() {
        let window = Window::new(Point::new(2, 1), Point::new(4, 3)).unwrap();
        let line = Staircase::new(Point::new(0, 0), Point::new(9, 5), &window);
        let code = |step, across| line.outcode(Stair { step, across });
        assert_eq!([code(0, 0), code(3, 2), code(9, 5), code(2, 0)], [LEFT | UNDER, 0, RIGHT | OVER, UNDER]);
    }

    #[test]
    fn all_four_edges_in_one_line() {
        let window = Window::new(Point::new(-2, -2), Point::new(2, 2)).unwrap();
        let clipped = cohen_sutherland(Point::new(-9, 8), Point::new(9, -8), &window).unwrap();
        assert!(clipped.eq(Walk::new(Point::new(-9, 8), Point::new(9, -8)).filter(|&p| window.contains(p))));
    }
}
