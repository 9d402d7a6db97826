use super::Point;

/// One pixel to the right, left, down or up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Direction {
    pub(crate) x: i16,
    pub(crate) y: i16,
}

/// The state of Bresenham's line algorithm at a pixel of a line; as an iterator, the pixels from there to the end.
///
/// ```text
/// ■ ■ . . . . .        error > 0: step across as well
/// . . ■ ■ ■ . .        each step along:  error += 2·minor
/// . . . . . ■ ■        each step across: error −= 2·major
/// ```
///
/// In order from the start to the end, both included, in all octants; at a tie the pixel on the start's side, so that
/// a line and its reverse may differ where they pass halfway between two pixels. Integers only; nothing overflows for
/// any ends.
///
/// Reference: J. E. Bresenham, "Algorithm for computer control of a digital plotter", IBM Systems Journal 4 (1), 1965.
///
/// Cost: two additions and a comparison a pixel. Memory: this struct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Walk {
    pub(super) next: Point,
    pub(super) left: u32,
    pub(super) error: i32,
    pub(super) major: i32,
    pub(super) minor: i32,
    pub(super) along: Direction,
    pub(super) across: Direction,
}

impl Walk {
    /// The whole line.
    #[must_use]
    #[inline]
    pub fn new(from: Point, to: Point) -> Self {
        use core::hint::select_unpredictable as select;
        let dx = i32::from(to.x) - i32::from(from.x);
        let dy = i32::from(to.y) - i32::from(from.y);
        let horizontal = Direction { x: select(dx < 0, -1, 1), y: 0 };
        let vertical = Direction { x: 0, y: select(dy < 0, -1, 1) };
        let (dx, dy) = (dx.abs(), dy.abs());
        let steep = dy > dx;
        let (major, minor) = (dx.max(dy), dx.min(dy));
        let along = select(steep, vertical, horizontal);
        let across = select(steep, horizontal, vertical);
        Self { next: from, left: major as u32 + 1, error: 2 * minor - major, major, minor, along, across }
    }

    /// The pixel that comes next; after the end, one of no meaning.
    #[must_use]
    #[inline]
    pub fn position(&self) -> Point {
        self.next
    }

    /// Pixels that are still to come, 0 to 65,536.
    #[must_use]
    #[inline]
    pub fn pixels_left(&self) -> u32 {
        self.left
    }

    /// Bresenham's error term: the next step goes across if it is above 0. In units of half a pixel over the line's
    /// longer side, −2·major < error ≤ 2·minor.
    #[must_use]
    pub fn error(&self) -> i32 {
        self.error
    }

    /// Lengths of the line's longer and shorter side in steps.
    pub(crate) fn sides(&self) -> (i32, i32) {
        (self.major, self.minor)
    }

    /// What one step along and one across adds to a pixel's coordinates.
    pub(crate) fn directions(&self) -> (Direction, Direction) {
        (self.along, self.across)
    }
}

impl Iterator for Walk {
    type Item = Point;

    #[inline]
    fn next(&mut self) -> Option<Point> {
        self.left = self.left.checked_sub(1)?;
        let point = self.next;
        let mut advance = |by: Direction| {
            // Wraps only behind the last pixel.
            self.next = Point::new(self.next.x.wrapping_add(by.x), self.next.y.wrapping_add(by.y));
        };
        advance(self.along);
        if self.error > 0 {
            advance(self.across);
            self.error -= 2 * self.major;
        }
        self.error += 2 * self.minor;
        Some(point)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left as usize, Some(self.left as usize))
    }
}

impl ExactSizeIterator for Walk {}

impl core::iter::FusedIterator for Walk {}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels' order as letters.
    fn picture<const W: usize, const H: usize>(from: Point, to: Point) -> [[u8; W]; H] {
        let mut picture = [[b'.'; W]; H];
        for (point, letter) in Walk::new(from, to).zip(b'a'..) {
            picture[point.y as usize][point.x as usize] = letter;
        }
        picture
    }

    #[test]
    fn from_start_to_end_in_all_octants() {
        let shallow = [*b"ab.....", *b"..cde..", *b".....fg"];
        assert_eq!(picture(Point::new(0, 0), Point::new(6, 2)), shallow);
        let back = [*b"gf.....", *b"..edc..", *b".....ba"];
        assert_eq!(picture(Point::new(6, 2), Point::new(0, 0)), back);
        // Halfway at b and at d: on the start's side.
        let steep = [*b"..e", *b".d.", *b".c.", *b"b..", *b"a.."];
        assert_eq!(picture(Point::new(0, 4), Point::new(2, 0)), steep);
        assert_eq!(picture(Point::new(2, 0), Point::new(0, 2)), [*b"..a", *b".b.", *b"c.."]);
        assert_eq!(picture(Point::new(3, 0), Point::new(0, 0)), [*b"dcba"]);
        assert_eq!(picture(Point::new(1, 0), Point::new(1, 0)), [*b".a."]);
    }

    #[test]
    fn the_longest_lines_do_not_overflow() {
        let (low, high) = (i16::MIN, i16::MAX);
        for (from, to) in [
            (Point::new(low, low), Point::new(high, high)),
            (Point::new(high, low), Point::new(low, low + 1)),
            (Point::new(low, high), Point::new(high - 1, low)),
            (Point::new(0, low), Point::new(0, high)),
        ] {
            let mut walk = Walk::new(from, to);
            let length = walk.len();
            assert_eq!((walk.next(), walk.last()), (Some(from), Some(to)));
            assert!(length >= 65_535);
        }
    }
}
