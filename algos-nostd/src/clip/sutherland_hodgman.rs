use super::{Point, Window};
use crate::image::Error;

/// Points that clipping a polygon of `points` corners may make: each edge of the window may cut off half of the
/// corners and put two in the place of each.
#[must_use]
pub const fn clipped_polygon_capacity(points: usize) -> usize {
    let mut capacity = points;
    let mut edge = 0;
    while edge < 4 {
        capacity = capacity.saturating_add(capacity / 2);
        edge += 1;
    }
    capacity
}

/// Clips a polygon to a window. Returns the corners of what is left in `clipped`, or an empty slice.
///
/// ```text
///      ╱╲                       ╱╲                 out → in: the crossing and the corner
///   ┌─╱──╲───┐                 ╱──╲  (top)         in → in:  the corner
///   │╱    ╲  │   one edge      ╱    ╲              in → out: the crossing
///   ╱      ╲ │   after the     │      ╲            out → out: nothing
///  ╱└───────╲┘   other         └───────╲
/// ```
///
/// The four edges are stages of one pipeline, each with its first and its last corner, so nothing is stored between
/// them. Crossings travel in fixed point (1/65,536 pixel) and are rounded once, at the end, to the nearest pixel
/// (halves down and to the right), so no rounding adds to another. As in the original, a concave polygon that is cut
/// into several parts stays one polygon, its parts joined by edges along the window's sides.
///
/// Reference: I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping", Communications of the ACM 17 (1), 1974.
///
/// Cost: one division of 64 bits a crossing. Memory: `clipped`, [`clipped_polygon_capacity`] points at most.
///
/// # Errors
/// [`Error::BufferLength`] with the number of points needed if `clipped` is too short for them.
pub fn sutherland_hodgman<'a>(
    corners: &[Point],
    window: &Window,
    clipped: &'a mut [Point],
) -> Result<&'a [Point], Error> {
    let fixed = |value: i16| i64::from(value) << FRACTION_BITS;
    let edge = |vertical, limit, sign| Stage { vertical, limit: fixed(limit), sign, ends: None };
    let mut pipeline = Pipeline {
        stages: [
            edge(true, window.left, 1),
            edge(true, window.right, -1),
            edge(false, window.top, 1),
            edge(false, window.bottom, -1),
        ],
        clipped,
        made: 0,
        ends: None,
    };
    for &corner in corners {
        pipeline.push(0, Corner { x: fixed(corner.x), y: fixed(corner.y) });
    }
    for stage in 0..4 {
        pipeline.close(stage);
    }
    let Pipeline { clipped, mut made, ends, .. } = pipeline;
    // The polygon is closed: its last corner must not repeat the first.
    if made > 1 && ends.is_some_and(|(first, latest)| first == latest) {
        made -= 1;
    }
    let got = clipped.len();
    clipped.get(..made).ok_or(Error::BufferLength { name: "clipped", expected: made, got })
}

const FRACTION_BITS: u32 = 16;

/// A corner in 1/65,536 pixels.
#[derive(Clone, Copy)]
struct Corner {
    x: i64,
    y: i64,
}

/// One edge of the window, and what it remembers of the polygon that passes.
struct Stage {
    vertical: bool,
    limit: i64,
    /// +1 if inside is above the limit, −1 if below.
    sign: i64,
    /// The first corner that came, and the latest one.
    ends: Option<(Corner, Corner)>,
}

impl Stage {
    /// How far inside a corner is; outside if below 0.
    fn depth(&self, corner: Corner) -> i64 {
        (if self.vertical { corner.x } else { corner.y } - self.limit) * self.sign
    }

    /// Where the side from `a` to `b` crosses the edge; the two lie on different sides of it.
    fn crossing(&self, a: Corner, b: Corner) -> Corner {
        let (before, after) = (self.depth(a), self.depth(b));
        // Differences are below 2³³: their product may pass 2⁶⁴, so it is taken in 128 bits. Rounded to nearest.
        let between = |from: i64, to: i64| {
            let (part, whole) = (i128::from(before.abs()), i128::from((before - after).abs()).max(1));
            from + ((2 * i128::from(to - from) * part + whole).div_euclid(2 * whole)) as i64
        };
        if self.vertical {
            Corner { x: self.limit, y: between(a.y, b.y) }
        } else {
            Corner { x: between(a.x, b.x), y: self.limit }
        }
    }
}

struct Pipeline<'a> {
    stages: [Stage; 4],
    clipped: &'a mut [Point],
    /// Corners that came out, those that did not fit included.
    made: usize,
    /// The first and the latest of them.
    ends: Option<(Point, Point)>,
}

impl Pipeline<'_> {
    /// Hands a corner to a stage, or behind the last one to the output. At most four calls deep.
    fn push(&mut self, index: usize, corner: Corner) {
        let Some(stage) = self.stages.get_mut(index) else {
            let rounded = |value: i64| ((value + (1 << (FRACTION_BITS - 1))) >> FRACTION_BITS) as i16;
            let point = Point::new(rounded(corner.x), rounded(corner.y));
            // A corner on an edge of the window is a crossing as well; once is enough.
            if self.ends.is_none_or(|(_, latest)| latest != point) {
                if let Some(place) = self.clipped.get_mut(self.made) {
                    *place = point;
                }
                self.made += 1;
                self.ends = Some((self.ends.map_or(point, |(first, _)| first), point));
            }
            return;
        };
        let latest = stage.ends.map(|(_, latest)| latest);
        stage.ends = Some((stage.ends.map_or(corner, |(first, _)| first), corner));
        let inside = stage.depth(corner) >= 0;
        let crossing = latest.and_then(|latest| stage.crossing_between(latest, corner));
        if let Some(crossing) = crossing {
            self.push(index + 1, crossing);
        }
        if inside {
            self.push(index + 1, corner);
        }
    }

    /// The polygon's last side, back to the first corner.
    fn close(&mut self, index: usize) {
        if let Some(stage) = self.stages.get(index)
            && let Some((first, latest)) = stage.ends
            && let Some(crossing) = stage.crossing_between(latest, first)
        {
            self.push(index + 1, crossing);
        }
    }
}

impl Stage {
    /// The crossing, if one of the corners is inside and the other one is not.
    fn crossing_between(&self, a: Corner, b: Corner) -> Option<Corner> {
        ((self.depth(a) >= 0) != (self.depth(b) >= 0)).then(|| self.crossing(a, b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window() -> Window {
        Window::new(Point::new(0, 0), Point::new(10, 10)).unwrap()
    }

    fn points<const N: usize>(points: [(i16, i16); N]) -> [Point; N] {
        points.map(|(x, y)| Point::new(x, y))
    }

    #[test]
    fn a_triangle_over_a_side() {
        let mut clipped = [Point::default(); clipped_polygon_capacity(3)];
        let corners = points([(5, -5), (15, 5), (5, 5)]);
        let clipped = sutherland_hodgman(&corners, &window(), &mut clipped).unwrap();
        assert_eq!(clipped, points([(10, 0), (10, 5), (5, 5), (5, 0)]));
    }

    #[test]
    fn all_inside_all_outside_and_all_around() {
        let mut memory = [Point::default(); 32];
        let inside = points([(1, 1), (9, 2), (4, 8)]);
        assert_eq!(sutherland_hodgman(&inside, &window(), &mut memory).unwrap(), inside);
        let outside = points([(-9, 1), (-1, 2), (-4, 8)]);
        assert_eq!(sutherland_hodgman(&outside, &window(), &mut memory).unwrap(), []);
        let (low, high) = (i16::MIN, i16::MAX);
        let around = points([(low, low), (high, low), (high, high), (low, high)]);
        let whole = sutherland_hodgman(&around, &window(), &mut memory).unwrap();
        assert_eq!(whole, points([(10, 0), (10, 10), (0, 10), (0, 0)]));
        assert_eq!(sutherland_hodgman(&[], &window(), &mut memory).unwrap(), []);
    }

    #[test]
    fn too_little_room_says_how_much_is_needed() {
        let corners = points([(5, -5), (15, 5), (5, 5)]);
        let error = sutherland_hodgman(&corners, &window(), &mut [Point::default(); 3]).unwrap_err();
        assert_eq!(error, Error::BufferLength { name: "clipped", expected: 4, got: 3 });
    }
}
