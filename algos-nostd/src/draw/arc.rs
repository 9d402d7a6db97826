use super::circle::each_of_circle;
use super::ellipse::each_of_ellipse;
use super::pixel::put;
use crate::clip::Point;
use crate::image::{Error, ImageMut};

/// The part of a turn between two rays from a centre, both included, clockwise on the screen (from x to y).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sweep {
    start: Point,
    end: Point,
}

impl Sweep {
    /// From the ray through `start` to the ray through `end`, both as offsets from the centre in any unit. If they are
    /// the same ray, the whole turn.
    ///
    /// # Errors
    /// [`Error::Parameter`] if one of them is (0, 0), which is no direction.
    pub fn new(start: Point, end: Point) -> Result<Self, Error> {
        for (name, ray) in [("start", start), ("end", end)] {
            if ray == Point::new(0, 0) {
                return Err(Error::Parameter { name, got: 0, allowed: "other than (0, 0)" });
            }
        }
        Ok(Self { start, end })
    }

    /// Whether a pixel at this offset from the centre is on one of the rays or between them.
    #[must_use]
    pub fn contains(&self, x: i32, y: i32) -> bool {
        // Above 0 if b is clockwise of a, by less than half a turn. Exact: 17 by 16 bits.
        let turn = |a: (i64, i64), b: (i64, i64)| a.0 * b.1 - a.1 * b.0;
        let wide = |point: Point| (i64::from(point.x), i64::from(point.y));
        let (start, end, at) = (wide(self.start), wide(self.end), (i64::from(x), i64::from(y)));
        let opening = turn(start, end);
        let opposite = opening == 0 && start.0 * end.0 + start.1 * end.1 < 0;
        if opening > 0 || opposite {
            turn(start, at) >= 0 && turn(at, end) >= 0
        } else {
            // More than half a turn: not strictly within the rest. Nothing is within an empty rest.
            !(turn(end, at) > 0 && turn(at, start) > 0)
        }
    }
}

/// Draws the pixels of [`draw_circle`](super::draw_circle) that are in a sweep.
///
/// ```text
///  . . ■ ■ start   Pixels are judged by the sides of the two rays that they are on, in
///  . ■ . ╱         products of whole numbers: no angle, no sine.
///  ■ . ┼───
///  . ■ . ╲
///  . . ■ ■ end of the rest
/// ```
///
/// Cost: four products a pixel. Memory: none.
pub fn draw_arc<P: Copy>(image: &mut ImageMut<'_, P>, center: Point, radius: u16, sweep: Sweep, color: P) {
    each_of_circle(radius, |x, y| {
        if sweep.contains(x, y) {
            put(image, i32::from(center.x) + x, i32::from(center.y) + y, color);
        }
    });
}

/// Draws the pixels of [`draw_ellipse`](super::draw_ellipse) that are in a sweep. The rays are those on the screen, not
/// those of the circle that the ellipse was drawn out from.
///
/// Cost: four products a pixel. Memory: none.
pub fn draw_elliptic_arc<P: Copy>(
    image: &mut ImageMut<'_, P>,
    center: Point,
    radii: (u16, u16),
    sweep: Sweep,
    color: P,
) {
    each_of_ellipse(radii, |x, y| {
        if sweep.contains(x, y) {
            put(image, i32::from(center.x) + x, i32::from(center.y) + y, color);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::super::picture::{Picture, draw};
    use super::*;

    fn sweep(start: (i16, i16), end: (i16, i16)) -> Sweep {
        Sweep::new(Point::new(start.0, start.1), Point::new(end.0, end.1)).unwrap()
    }

    #[test]
    fn a_quarter_and_the_rest() {
        let expected: Picture<7, 7> = [
            *b"..ooo..", //
            *b".o...o.",
            *b"o.....o",
            *b"o.....#",
            *b"o.....#",
            *b".o...#.",
            *b"..o##..",
        ];
        let drawn = draw(|image| {
            draw_arc(image, Point::new(3, 3), 3, sweep((0, 9), (9, 0)), b'o');
            draw_arc(image, Point::new(3, 3), 3, sweep((9, 0), (0, 9)), b'#');
        });
        assert_eq!(drawn, expected);
    }

    #[test]
    fn half_and_whole_turns() {
        let half: Picture<7, 3> = [*b".......", *b"#.....#", *b".#####."];
        let drawn = draw(|image| {
            draw_elliptic_arc(image, Point::new(3, 1), (3, 1), sweep((1, 0), (-5, 0)), b'#');
        });
        assert_eq!(drawn, half);
        assert!((-9..9).all(|x| sweep((2, 3), (4, 6)).contains(x, 7)));
        assert!(Sweep::new(Point::new(0, 0), Point::new(1, 0)).is_err());
    }
}
