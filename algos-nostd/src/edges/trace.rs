//! From edge pixels to curves: chains of points, handed on piece by piece.
//!
//! ```text
//! # . . . #        0 . . . 0'
//! . # . # .        . 1 . 1' .       from every end to an end or to where another curve was met; that
//! . . # . .        . . 2 . .        pixel is on both, so that they stay joined. Then the rings.
//! . . # . .        . . 3 . .
//! ```
//!
//! Reference: the edge linking of the textbooks (R. Gonzalez and R. Woods, "Digital Image Processing", 10.2.7), in the order
//! of this file. A curve begins at a pixel with at most one neighbour; when there are no more, the rings that are left begin
//! anywhere. It goes on to a neighbour not yet taken: one that shares a side before one that shares a corner, and of
//! these the one that turns least. It ends where there is none, or joins a pixel that another curve has taken. Every
//! pixel is on a curve; only pixels where curves meet are on several. Meant for edges one pixel wide ([`super::canny`]'s, or [`super::thin`]'s).
//!
//! Memory: a second map, of the pixels not yet taken, and room for a piece of a curve. A curve longer than this room is
//! handed on in pieces, each of which begins with the last point of the one before.
//! Cost: one scan of the words for ends, one for rings, and about nine looks at bits a pixel.

use super::bits::{BitMap, BitMapMut, PIXELS_A_WORD, same_size, words_a_line};
use crate::image::Error;
use crate::image::Point;

/// A curve, or a piece of one.
#[derive(Debug)]
pub struct Curve<'a> {
    /// Its pixels, in order. The sink may change them: [`super::simplify`] does.
    pub points: &'a mut [Point],
    /// It goes on from the piece before, whose last point is its first.
    pub continued: bool,
    /// More of it follows.
    pub continues: bool,
    /// Its end is next to its beginning (of the first piece); the first point is then given again at the end.
    pub closed: bool,
}

/// Steps to the eight neighbours, clockwise from the right.
const STEPS: [(i16, i16); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Traces all curves of a map of edges. `rest` is a map of the same size whose content does not matter; `room` has
/// place for two points or more.
///
/// # Errors
/// [`Error::SizeMismatch`] if the maps differ in size, [`Error::Parameter`] if a side is longer than 32,767 pixels,
/// [`Error::BufferLength`] if `room` is shorter than two points.
pub fn trace(
    edges: BitMap<'_>,
    rest: &mut BitMapMut<'_>,
    room: &mut [Point],
    sink: &mut impl FnMut(Curve<'_>),
) -> Result<(), Error> {
    let side = edges.width().max(edges.height());
    if side > i16::MAX as usize {
        let got = i64::try_from(side).unwrap_or(i64::MAX);
        return Err(Error::Parameter { name: "side", got, allowed: "at most 32767 pixels" });
    }
    if room.len() < 2 {
        return Err(Error::BufferLength { name: "room", expected: 2, got: room.len() });
    }
    same_size((edges.width(), edges.height()), (rest.width(), rest.height()))?;
    rest.copy_from(edges)?;
    rest.clear_past_width();
    let mut tracer = Tracer { edges, rest: rest.reborrow(), room };
    tracer.scan(true, sink);
    tracer.scan(false, sink);
    Ok(())
}

struct Tracer<'a> {
    edges: BitMap<'a>,
    rest: BitMapMut<'a>,
    room: &'a mut [Point],
}

impl Tracer<'_> {
    /// Traces from every pixel left, or only from the ends of curves.
    fn scan(&mut self, only_ends: bool, sink: &mut impl FnMut(Curve<'_>)) {
        let columns = words_a_line(self.edges.width());
        for index in 0..self.edges.words().len() {
            let mut seen = 0;
            loop {
                // Tracing takes pixels of this word, too.
                let word = self.rest.as_map().words().get(index).map_or(0, |word| word & !seen);
                if word == 0 {
                    break;
                }
                let bit = word.trailing_zeros();
                seen |= 1 << bit;
                let x = (index % columns * PIXELS_A_WORD) as i16 + bit as i16;
                let point = Point { x, y: (index / columns) as i16 };
                if !only_ends || self.neighbours(point) <= 1 {
                    self.follow(point, sink);
                }
            }
        }
    }

    fn neighbours(&self, point: Point) -> usize {
        STEPS.iter().filter(|&&step| is_set(self.edges, moved(point, step))).count()
    }

    /// Follows a curve from a pixel to its end.
    fn follow(&mut self, start: Point, sink: &mut impl FnMut(Curve<'_>)) {
        let mut length = 0;
        let mut continued = false;
        // A ring's remainder that begins beside a curve already taken begins on it.
        if let Some(joint) = self.taken_beside(start, None) {
            self.room[0] = joint;
            length = 1;
        }
        let first = if length > 0 { self.room[0] } else { start };
        let joined = length > 0;
        let (mut point, mut heading, mut before) = (start, None, None);
        let mut taken = 0usize;
        loop {
            self.rest.set(point.x as usize, point.y as usize, false);
            self.append(point, &mut length, &mut continued, sink);
            taken += 1;
            match self.next(point, heading) {
                Some(step) => {
                    before = Some(point);
                    point = moved(point, STEPS[step]);
                    heading = Some(step);
                }
                None => break,
            }
        }
        let closed = !joined && taken > 2 && touches(point, first);
        if closed {
            self.append(first, &mut length, &mut continued, sink);
        } else if taken > 1
            && let Some(joint) = self.taken_beside(point, before)
        {
            self.append(joint, &mut length, &mut continued, sink);
        }
        let points = &mut self.room[..length];
        sink(Curve { points, continued, continues: false, closed });
    }

    /// Adds a point, after handing on the piece if the room is full.
    fn append(
        &mut self,
        point: Point,
        length: &mut usize,
        continued: &mut bool,
        sink: &mut impl FnMut(Curve<'_>),
    ) {
        if *length == self.room.len() {
            let last = self.room[*length - 1];
            let points = &mut *self.room;
            sink(Curve { points, continued: *continued, continues: true, closed: false });
            self.room[0] = last;
            (*length, *continued) = (1, true);
        }
        self.room[*length] = point;
        *length += 1;
    }

    /// The step to the neighbour not yet taken that comes next.
    fn next(&self, point: Point, heading: Option<usize>) -> Option<usize> {
        let rest = self.rest.as_map();
        let free = |step: &usize| is_set(rest, moved(point, STEPS[*step]));
        let turn = |step: &usize| {
            let turn = heading.map_or(0, |heading| (step + 8 - heading) % 8);
            turn.min(8 - turn)
        };
        // Even steps go over a side, odd ones over a corner.
        (0..8).filter(free).min_by_key(|step| (step % 2, turn(step)))
    }

    /// A neighbouring edge pixel that has been taken, and is not where the curve has just been or next to that.
    fn taken_beside(&self, point: Point, before: Option<Point>) -> Option<Point> {
        let rest = self.rest.as_map();
        let candidates = (0..8).map(|step| (step % 2, moved(point, STEPS[step])));
        candidates
            .filter(|&(_, place)| is_set(self.edges, place) && !is_set(rest, place))
            .filter(|&(_, place)| before.is_none_or(|before| place != before && !touches(place, before)))
            .min_by_key(|&(corner, _)| corner)
            .map(|(_, place)| place)
    }
}

/// The point a step further; outside the map no pixel is set, and the map ends before `i16` does.
fn moved(point: Point, (dx, dy): (i16, i16)) -> Point {
    Point { x: point.x.saturating_add(dx), y: point.y.saturating_add(dy) }
}

fn is_set(map: BitMap<'_>, point: Point) -> bool {
    match (usize::try_from(point.x), usize::try_from(point.y)) {
        (Ok(x), Ok(y)) => map.get(x, y),
        _ => false,
    }
}

/// Whether two points are neighbours, or one.
fn touches(one: Point, other: Point) -> bool {
    one.x.abs_diff(other.x) <= 1 && one.y.abs_diff(other.y) <= 1
}

#[cfg(test)]
mod tests {
    use super::super::bits::tests::draw;
    use super::*;

    /// The curves of a drawing, each as its points and whether it is closed, its pieces put together.
    fn curves(picture: &[&str], room: usize) -> Vec<(Vec<(i16, i16)>, bool)> {
        let (words, width, height) = draw(picture);
        let mut rest = vec![u32::MAX; words.len()];
        let mut room = vec![Point::default(); room];
        let mut made: Vec<(Vec<(i16, i16)>, bool)> = Vec::new();
        let mut open = false;
        let mut sink = |curve: Curve<'_>| {
            assert_eq!(curve.continued, open);
            let points = curve.points.iter().map(|point| (point.x, point.y));
            if curve.continued {
                let last = made.last_mut().unwrap();
                assert_eq!(last.0.last().copied(), points.clone().next(), "pieces overlap by a point");
                last.0.extend(points.skip(1));
                last.1 |= curve.closed;
            } else {
                made.push((points.collect(), curve.closed));
            }
            open = curve.continues;
        };
        let map = BitMap::new(&words, width, height).unwrap();
        trace(map, &mut BitMapMut::new(&mut rest, width, height).unwrap(), &mut room, &mut sink).unwrap();
        assert!(!open);
        assert!(rest.iter().all(|&word| word == 0), "every pixel was taken");
        made
    }

    #[test]
    fn a_line_goes_from_end_to_end() {
        let line = [(0, 0), (1, 0), (2, 1), (3, 2), (3, 3)];
        for room in [2, 3, 4, 99] {
            assert_eq!(curves(&["##..", "..#.", "...#", "...#"], room), [(line.to_vec(), false)]);
        }
    }

    #[test]
    fn a_ring_is_closed() {
        for room in [2, 99] {
            let made = curves(&[".##.", "#..#", ".##."], room);
            assert_eq!(made, [(vec![(1, 0), (2, 0), (3, 1), (2, 2), (1, 2), (0, 1), (1, 0)], true)]);
        }
    }

    #[test]
    fn branches_stay_joined() {
        let made = curves(&["#...#", ".#.#.", "..#..", "..#.."], 99);
        assert_eq!(
            made,
            [(vec![(0, 0), (1, 1), (2, 2), (2, 3)], false), (vec![(4, 0), (3, 1), (2, 2)], false)]
        );
    }

    #[test]
    fn a_ring_crossed_by_a_line_is_whole() {
        let picture = ["..#..", "..#..", ".#.#.", "#...#", ".#.#.", "..#.."];
        let made = curves(&picture, 99);
        let mut pixels: Vec<_> = made.iter().flat_map(|(points, _)| points.clone()).collect();
        pixels.sort_unstable();
        pixels.dedup();
        assert_eq!(pixels.len(), picture.concat().matches('#').count());
    }

    #[test]
    fn a_pixel_is_a_curve() {
        assert_eq!(curves(&["#.#"], 2), [(vec![(0, 0)], false), (vec![(2, 0)], false)]);
    }

    #[test]
    fn bad_sizes_are_refused() {
        let words = [0; 2];
        let mut rest = [0; 2];
        let map = BitMap::new(&words, 3, 2).unwrap();
        let mut traced = |width, height, room: &mut [Point]| {
            trace(map, &mut BitMapMut::new(&mut rest, width, height).unwrap(), room, &mut |_| {}).unwrap_err()
        };
        let mut room = [Point::default(); 2];
        assert_eq!(traced(2, 2, &mut room), Error::SizeMismatch { expected: (3, 2), got: (2, 2) });
        assert_eq!(traced(3, 2, &mut room[..1]), Error::BufferLength { name: "room", expected: 2, got: 1 });
    }
}
