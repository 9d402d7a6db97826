use super::pixel::fill_span;
use crate::clip::Point;
use crate::image::{Error, ImageMut};

/// Which parts of a polygon that crosses itself are inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillRule {
    /// What a ray to the outside leaves over an odd number of sides: overlaps are holes.
    EvenOdd,
    /// What the sides go round at least once in sum, to the right counting against to the left: overlaps are filled.
    NonZero,
}

/// A side of a polygon; memory for [`fill_polygon`] to lend.
#[derive(Clone, Copy, Debug, Default)]
pub struct Edge {
    /// The first line that it crosses, and the one behind the last.
    top: i32,
    end: i32,
    /// The first column on or right of the side in the current line.
    x: i32,
    /// How far right of the side that column is, in 1/`height` pixels: 0 to `height` − 1.
    excess: i32,
    /// What `x` and `excess` change by from line to line: whole pixels and the rest.
    slope: i32,
    slope_rest: i32,
    height: i32,
    /// +1 downwards, −1 upwards.
    winding: i32,
}

impl Edge {
    /// Memory to lend.
    pub const EMPTY: Self =
        Self { top: 0, end: 0, x: 0, excess: 0, slope: 0, slope_rest: 0, height: 0, winding: 0 };
}

/// Sides that polygons with so many corners in all have at most: the length of [`fill_polygon`]'s `edges`.
#[must_use]
pub const fn polygon_edges(corners: usize) -> usize {
    corners
}

/// Fills polygons line by line, all contours as one shape: holes are contours within contours.
///
/// ```text
///        ╱╲              the active edges of a line, from left to right:
///  ──── ╱──╲──╱╲──       fill from the first to the second,
///      ╱    ╲╱  ╲        from the third to the fourth …
/// ```
///
/// A pixel is inside if its centre is; of those on a side, the ones on left and upper sides are inside, so polygons
/// that share a side neither overlap nor leave a gap. Exact: sides are followed in whole numbers.
///
/// Reference: Foley, van Dam et al., "Computer Graphics: Principles and Practice", 3.6, after C. Wylie et al., 1967.
/// We deviate in holding both the edge table and the active edges in one lent slice: finished, active, to come.
///
/// Cost: two divisions a side, sorting, then additions for each side in each line, and the spans. Memory: `edges`, one
/// for each side that is not level and meets the picture's lines.
///
/// # Errors
/// [`Error::BufferLength`] if `edges` is too short; nothing is drawn then.
pub fn fill_polygon<P: Copy>(
    image: &mut ImageMut<'_, P>,
    contours: &[&[Point]],
    rule: FillRule,
    color: P,
    edges: &mut [Edge],
) -> Result<(), Error> {
    let lines = i32::try_from(image.height()).unwrap_or(i32::MAX);
    let sides = || {
        let pairs = contours.iter().flat_map(|corners| {
            corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&from, &to)| (from, to))
        });
        pairs.filter_map(|(from, to)| Edge::new(from, to, lines))
    };
    let (expected, got) = (sides().count(), edges.len());
    let Some(edges) = edges.get_mut(..expected) else {
        return Err(Error::BufferLength { name: "edges", expected, got });
    };
    for (place, edge) in edges.iter_mut().zip(sides()) {
        *place = edge;
    }
    edges.sort_unstable_by_key(|edge| edge.top);
    // From here on: edges[..finished], edges[finished..begun] active, edges[begun..] to come.
    let (mut finished, mut begun) = (0, 0);
    let mut y = edges.first().map_or(lines, |edge| edge.top);
    while y < lines {
        while edges.get(begun).is_some_and(|edge| edge.top <= y) {
            begun += 1;
        }
        finished = retire(edges, finished, begun, y);
        let Some(active) = edges.get_mut(finished..begun) else { return Ok(()) };
        if active.is_empty() {
            // Straight on to the next one, if there is any.
            match edges.get(begun) {
                Some(edge) => y = edge.top,
                None => return Ok(()),
            }
            continue;
        }
        sort_by_column(active);
        let mut winding = 0;
        for pair in active.windows(2) {
            let [left, right] = pair else { continue };
            winding += match rule {
                FillRule::EvenOdd => 1,
                FillRule::NonZero => left.winding,
            };
            let inside = match rule {
                FillRule::EvenOdd => winding % 2 != 0,
                FillRule::NonZero => winding != 0,
            };
            if inside && left.x < right.x {
                fill_span(image, (left.x, right.x - 1), y, color);
            }
        }
        active.iter_mut().for_each(Edge::step);
        y += 1;
    }
    Ok(())
}

impl Edge {
    /// The side from one corner to the next, from the first of the picture's lines that it crosses; `None` if there
    /// is none. A side crosses the lines from its upper end on to before its lower end.
    fn new(from: Point, to: Point, lines: i32) -> Option<Self> {
        let (upper, lower, winding) = if from.y <= to.y { (from, to, 1) } else { (to, from, -1) };
        let (x, y) = (i32::from(upper.x), i32::from(upper.y));
        let (width, height) = (i32::from(lower.x) - x, i32::from(lower.y) - y);
        let (top, end) = (y.max(0), (y + height).min(lines));
        if top >= end {
            return None;
        }
        // From the upper end to line `top`: a whole number of pixels to the right, and what that is too far.
        let passed = i64::from(width) * i64::from(top - y);
        let columns = -(-passed).div_euclid(i64::from(height));
        Some(Self {
            top,
            end,
            x: x + columns as i32,
            excess: (columns * i64::from(height) - passed) as i32,
            slope: width.div_euclid(height),
            slope_rest: width.rem_euclid(height),
            height,
            winding,
        })
    }

    fn step(&mut self) {
        self.x += self.slope;
        self.excess -= self.slope_rest;
        if self.excess < 0 {
            self.x += 1;
            self.excess += self.height;
        }
    }
}

/// Moves active edges that end before line `y` to the finished ones; returns how many these are now.
fn retire(edges: &mut [Edge], active: usize, begun: usize, y: i32) -> usize {
    let mut finished = active;
    for index in active..begun {
        if edges.get(index).is_some_and(|edge| edge.end <= y) {
            edges.swap(index, finished);
            finished += 1;
        }
    }
    finished
}

/// By insertion, because from line to line the order hardly changes.
fn sort_by_column(edges: &mut [Edge]) {
    for sorted in 1..edges.len() {
        let mut index = sorted;
        while index > 0 && edges[index].x < edges[index - 1].x {
            edges.swap(index, index - 1);
            index -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::{Picture, draw};
    use super::*;

    fn points<const N: usize>(points: [(i16, i16); N]) -> [Point; N] {
        points.map(|(x, y)| Point::new(x, y))
    }

    fn filled<const W: usize, const H: usize>(contours: &[&[Point]], rule: FillRule) -> Picture<W, H> {
        draw(|image| {
            let mut edges = [Edge::default(); polygon_edges(12)];
            fill_polygon(image, contours, rule, b'#', &mut edges).unwrap();
        })
    }

    #[test]
    fn a_star_by_both_rules() {
        let star = points([(5, 0), (8, 9), (0, 3), (10, 3), (2, 9)]);
        let drawn: Picture<11, 9> = filled(&[&star], FillRule::EvenOdd);
        assert_eq!(
            drawn,
            [
                *b"...........", //
                *b".....#.....",
                *b".....#.....",
                *b"####..####.",
                *b"..##...##..",
                *b"...#...#...",
                *b"...#..#....",
                *b"...##.##...",
                *b"...#...#...",
            ]
        );
        let solid: Picture<11, 9> = filled(&[&star], FillRule::NonZero);
        assert_eq!(
            solid,
            [
                *b"...........", //
                *b".....#.....",
                *b".....#.....",
                *b"##########.",
                *b"..#######..",
                *b"...#####...",
                *b"...####....",
                *b"...##.##...",
                *b"...#...#...",
            ]
        );
    }

    #[test]
    fn neighbours_share_no_pixel_and_leave_none() {
        let (a, b, c, d) = ((-3, -2), (9, 1), (8, 9), (1, 7));
        let whole: Picture<9, 9> = filled(&[&points([a, b, c, d])], FillRule::NonZero);
        let half: Picture<9, 9> = filled(&[&points([a, b, c])], FillRule::NonZero);
        let rest: Picture<9, 9> = filled(&[&points([a, c, d])], FillRule::NonZero);
        for (index, pixel) in whole.as_flattened().iter().enumerate() {
            let parts = [half.as_flattened()[index], rest.as_flattened()[index]];
            assert_eq!(parts.iter().filter(|&&part| part == b'#').count(), usize::from(*pixel == b'#'));
        }
    }

    #[test]
    fn contours_within_contours_are_holes() {
        let (outer, inner) =
            (points([(0, 0), (6, 0), (6, 4), (0, 4)]), points([(2, 1), (2, 3), (4, 3), (4, 1)]));
        let expected: Picture<7, 5> = [*b"######.", *b"##..##.", *b"##..##.", *b"######.", *b"......."];
        for rule in [FillRule::EvenOdd, FillRule::NonZero] {
            assert_eq!(filled(&[&outer, &inner], rule), expected);
        }
    }

    #[test]
    fn too_few_edges_draw_nothing() {
        let triangle = points([(0, 0), (4, 0), (2, 4)]);
        let untouched: Picture<5, 5> = draw(|image| {
            let result = fill_polygon(image, &[&triangle], FillRule::EvenOdd, b'#', &mut [Edge::default()]);
            assert_eq!(result, Err(Error::BufferLength { name: "edges", expected: 2, got: 1 }));
        });
        assert_eq!(untouched, [*b"....."; 5]);
    }
}
