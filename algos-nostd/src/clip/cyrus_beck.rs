use super::liang_barsky::bound;
use super::staircase::Staircase;
use super::{Point, Walk, Window};
use crate::image::Error;

/// A convex polygon to clip lines to, its edges included; the corners are borrowed.
#[derive(Clone, Copy, Debug)]
pub struct ConvexWindow<'a> {
    corners: &'a [Point],
    /// +1 or −1, so that `inside` is not above 0 for points within.
    orientation: i64,
}

/// What a point must not be beyond: `x·normal.0 + y·normal.1 ≤ limit` within the polygon.
#[derive(Clone, Copy, Debug)]
struct HalfPlane {
    normal: (i64, i64),
    limit: i64,
}

impl HalfPlane {
    /// Left of the line from `a` to `b`, or right of it, by `orientation`.
    fn new(a: Point, b: Point, orientation: i64) -> Self {
        let (ax, ay) = (i64::from(a.x), i64::from(a.y));
        let normal = ((i64::from(b.y) - ay) * orientation, (ax - i64::from(b.x)) * orientation);
        Self { normal, limit: normal.0 * ax + normal.1 * ay }
    }

    fn excess(&self, point: Point) -> i64 {
        i64::from(point.x) * self.normal.0 + i64::from(point.y) * self.normal.1 - self.limit
    }
}

impl<'a> ConvexWindow<'a> {
    /// From the corners in order, either way round. Corners may lie on the line between their neighbours.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are fewer than three corners, two neighbours are equal, a corner lies outside of
    /// an edge's line (the polygon is not convex), or all lie on one line.
    pub fn new(corners: &'a [Point]) -> Result<Self, Error> {
        let refused =
            |index: usize, allowed| Err(Error::Parameter { name: "corners", got: index as i64, allowed });
        if corners.len() < 3 {
            return refused(corners.len(), "three corners or more");
        }
        let mut orientation = 0;
        for (index, (a, b)) in edges(corners).enumerate() {
            if a == b {
                return refused(index, "corners (this index) that differ from the next one");
            }
            let plane = HalfPlane::new(a, b, 1);
            for &corner in corners {
                let side = -plane.excess(corner).signum();
                if side * orientation < 0 {
                    return refused(index, "corners of a convex polygon (see the edge from this index)");
                }
                orientation += side * i64::from(orientation == 0);
            }
        }
        if orientation == 0 {
            return refused(corners.len(), "corners that are not all on one line");
        }
        Ok(Self { corners, orientation })
    }

    fn half_planes(&self) -> impl Iterator<Item = HalfPlane> {
        let orientation = self.orientation;
        edges(self.corners).map(move |(a, b)| HalfPlane::new(a, b, orientation))
    }
}

/// Each corner with the next one, the last with the first.
fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// Clips a line to any convex window. Equals [`clip_line`](super::clip_line) where the window is a rectangle.
///
/// ```text
///        ╱╲            each edge is a half-plane with a normal n:
///  ■ ■  ╱  ╲           n·direction < 0: the line comes in through it,
///     ■■■■■ ╲          n·direction > 0: it goes out;
///       ╲  ■■■ ■ ■     the last way in and the first way out remain
///        ╲╱
/// ```
///
/// Reference: M. Cyrus and J. Beck, "Generalized two- and three-dimensional clipping", Computers & Graphics 3, 1978.
/// We deviate in the parameter, which is the step of Bresenham's algorithm. What is judged at a step:
///
/// - against an edge that is parallel to an axis, the pixel itself;
/// - against an oblique edge, the point of the ideal line (rational, compared exactly), because the staircase of
///   pixels may cross such an edge many times; a pixel that is lit lies within half a pixel of the window.
///
/// Cost: one division of 64 bits an edge. Memory: none.
#[must_use]
pub fn cyrus_beck(from: Point, to: Point, window: &ConvexWindow<'_>) -> Option<Walk> {
    // Only the octant is wanted here; the rectangle is of no account.
    let everything = Window { left: i16::MIN, top: i16::MIN, right: i16::MAX, bottom: i16::MAX };
    let line = Staircase::new(from, to, &everything);
    let (along, across) = line.directions();
    let (major, minor) = (i64::from(line.major.max(1)), i64::from(line.minor));
    let (mut first, mut last) = (0, i64::from(line.major));
    for plane in window.half_planes() {
        let dot = |x: i16, y: i16| plane.normal.0 * i64::from(x) + plane.normal.1 * i64::from(y);
        let (by_along, by_across) = (dot(along.x, along.y), dot(across.x, across.y));
        let room = -plane.excess(line.start);
        let (p, q) = if by_along != 0 {
            // The ideal point: start + t·(along + across·minor/major); times major it is whole. Where the edge is
            // parallel to `across`, the pixel's coordinate along is the ideal point's. Below 2⁵² in size.
            (by_along * major + by_across * minor, room * major)
        } else if by_across > 0 {
            // At most room/by_across across, which is whole, because the edge's own corner is a pixel.
            (2 * minor, (2 * room.div_euclid(by_across) + 1) * major)
        } else {
            // At least that many across.
            (-2 * minor, -(2 * -room.div_euclid(-by_across) - 1) * major - 1)
        };
        bound(p, q, &mut first, &mut last)?;
    }
    (first <= last).then(|| line.walk(line.stair_at(first as i32), last as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: i16, y: i16) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn windows_that_are_not_convex_are_refused_with_the_place() {
        let arrow = [point(0, 0), point(4, 0), point(2, 1), point(4, 4)];
        assert!(ConvexWindow::new(&arrow).is_err());
        let star = [point(0, -9), point(6, 8), point(-9, -3), point(9, -3), point(-6, 8)];
        assert!(ConvexWindow::new(&star).is_err());
        assert!(ConvexWindow::new(&[point(0, 0), point(1, 1), point(2, 2)]).is_err());
        assert!(ConvexWindow::new(&[point(0, 0), point(0, 0), point(2, 1)]).is_err());
        assert!(ConvexWindow::new(&[point(0, 0), point(2, 1)]).is_err());
        assert!(ConvexWindow::new(&[point(0, 0), point(2, 0), point(4, 0), point(2, 3)]).is_ok());
    }

    #[test]
    fn a_diamond_either_way_round() {
        let diamond = [point(0, -4), point(4, 0), point(0, 4), point(-4, 0)];
        let mut reversed = diamond;
        reversed.reverse();
        for corners in [diamond, reversed] {
            let window = ConvexWindow::new(&corners).unwrap();
            let level = cyrus_beck(point(-9, 1), point(9, 1), &window).unwrap();
            assert!(level.eq((-3..=3).map(|x| point(x, 1))), "edges are included");
            assert_eq!(cyrus_beck(point(-9, 0), point(0, -9), &window), None);
            let edge = cyrus_beck(point(-6, 2), point(2, -6), &window);
            assert!(edge.unwrap().eq((-4..=0).map(|x| point(x, -4 - x))));
        }
    }
}
