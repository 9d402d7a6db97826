//! Fewer points for the same curve: Ramer–Douglas–Peucker.
//!
//! ```text
//!        ·  c  ·                     c
//!      ·         ·                ╱     ╲            c is farthest from the chord a b, and farther than ε:
//!    a             ·  ·  b      a          ╲ · · b    kept, and both halves are looked at in the same way
//! ```
//!
//! Reference: U. Ramer, Computer Graphics and Image Processing 1(3), 1972; D. Douglas and T. Peucker, Cartographica 10(2),
//! 1973. The distance is that to the line through both ends (to the point, where they are one).
//!
//! Exact, in integers. The distance of `p` from the chord is `|cross| / length`, so of a chord's points the farthest is the
//! one of the greatest cross product, and `distance > ε` is `cross² > ε² · length²`. Of equally far points the first is taken.
//!
//! Where we deviate: not recursive. The longer half waits on a stack while the shorter one is done, so at most as many
//! halves wait as the number of points has bits, and a small fixed stack always suffices. What is kept is noted in a bit a
//! point, lent by the caller, and the points move together at the end.
//!
//! Cost: `n log n` cross products for usual curves, `n²` for the worst.

use crate::image::{Error, Point};

/// Halves that can wait: each is at least as long as all that is done before it.
const STACK: usize = usize::BITS as usize;

/// Words of memory that [`simplify`] takes for a curve of so many points.
#[must_use]
pub const fn simplify_memory(points: usize) -> usize {
    points.div_ceil(32)
}

/// Leaves out points such that none of them is farther than `tolerance` (in 1/256 pixel) from the line between
/// those kept before and after it. The ends stay. The points kept move to the front; returns how many they are.
///
/// For a closed curve give its first point again at the end.
///
/// # Errors
/// [`Error::BufferLength`] if `memory` is shorter than [`simplify_memory`]; the points are then as they were.
pub fn simplify(points: &mut [Point], tolerance: u32, memory: &mut [u32]) -> Result<usize, Error> {
    let (expected, got) = (simplify_memory(points.len()), memory.len());
    let keep = memory.get_mut(..expected).ok_or(Error::BufferLength { name: "memory", expected, got })?;
    if points.len() < 3 {
        return Ok(points.len());
    }
    keep.fill(0);
    let last = points.len() - 1;
    keep[0] |= 1;
    keep[last / 32] |= 1 << (last % 32);
    mark(points, tolerance, keep);
    let mut kept = 0;
    for index in 0..points.len() {
        if keep[index / 32] >> (index % 32) & 1 != 0 {
            points[kept] = points[index];
            kept += 1;
        }
    }
    Ok(kept)
}

/// Sets the bits of the inner points that are kept.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2")))]
fn mark(points: &[Point], tolerance: u32, keep: &mut [u32]) {
    let narrow = is_narrow(points);
    let mut stack = [(0, 0); STACK];
    let mut waiting = 0;
    let (mut from, mut to) = (0, points.len() - 1);
    loop {
        match farthest(&points[from..=to], tolerance, narrow) {
            Some(place) => {
                let split = from + place;
                keep[split / 32] |= 1 << (split % 32);
                let (before, after) = ((from, split), (split, to));
                let (shorter, longer) =
                    if split - from < to - split { (before, after) } else { (after, before) };
                stack[waiting % STACK] = longer;
                waiting += 1;
                (from, to) = shorter;
            }
            None if waiting == 0 => return,
            None => {
                waiting -= 1;
                (from, to) = stack[waiting % STACK];
            }
        }
    }
}

/// Whether all points lie in a square of sides below 2¹⁵: twice the area of a triangle between them, which is what a cross
/// product is, then fits 32 bits with room to spare.
fn is_narrow(points: &[Point]) -> bool {
    let (mut low, mut high) = (Point { x: i16::MAX, y: i16::MAX }, Point { x: i16::MIN, y: i16::MIN });
    for point in points {
        low = Point { x: low.x.min(point.x), y: low.y.min(point.y) };
        high = Point { x: high.x.max(point.x), y: high.y.max(point.y) };
    }
    high.x.checked_sub(low.x).is_some() && high.y.checked_sub(low.y).is_some()
}

/// The place of the first of the points farthest from the line through the first and the last, if it is farther than
/// the tolerance.
#[inline(always)]
fn farthest(points: &[Point], tolerance: u32, narrow: bool) -> Option<usize> {
    let [first, inner @ .., last] = points else { return None };
    if inner.is_empty() {
        return None;
    }
    let (dx, dy) = (i64::from(last.x) - i64::from(first.x), i64::from(last.y) - i64::from(first.y));
    let squared_length = (dx * dx + dy * dy) as u64;
    let tolerance = u128::from(u64::from(tolerance).pow(2));
    if squared_length == 0 {
        let (place, square) = greatest(inner, |point| {
            let (x, y) = (i64::from(point.x) - i64::from(first.x), i64::from(point.y) - i64::from(first.y));
            (x * x + y * y) as u64
        })?;
        return (u128::from(square) << 16 > tolerance).then_some(place + 1);
    }
    let (place, cross) = if narrow {
        greatest_narrow(inner, *first, dx as i32, dy as i32)?
    } else {
        greatest(inner, |point| {
            let (x, y) = (i64::from(point.x) - i64::from(first.x), i64::from(point.y) - i64::from(first.y));
            (dx * y - dy * x).unsigned_abs()
        })?
    };
    // At most (2¹⁶ − 1)², twice the area of the largest triangle: its square times 2¹⁶ needs more than 64 bits.
    (u128::from(cross).pow(2) << 16 > tolerance * u128::from(squared_length)).then_some(place + 1)
}

fn greatest(points: &[Point], measure: impl Fn(&Point) -> u64) -> Option<(usize, u64)> {
    let mut best = None;
    for (place, measured) in points.iter().map(measure).enumerate() {
        if best.is_none_or(|(_, greatest)| measured > greatest) {
            best = Some((place, measured));
        }
    }
    best
}

/// The same for cross products that fit 32 bits, a few at a time.
#[inline(always)]
fn greatest_narrow(points: &[Point], first: Point, dx: i32, dy: i32) -> Option<(usize, u64)> {
    const BLOCK: usize = 64;
    /// Not worth a vector.
    const SHORT: usize = 16;
    let (mut best, mut greatest) = (0, 0);
    if points.len() < SHORT {
        for (place, point) in points.iter().enumerate() {
            let measured = cross(*point, first, dx, dy);
            best = if measured > greatest { place } else { best };
            greatest = measured.max(greatest);
        }
        return Some((best, u64::from(greatest)));
    }
    // First how much and in which block, then where: two loops that vector units take.
    for (block, points) in points.chunks(BLOCK).enumerate() {
        let mut most = 0;
        for point in points {
            most = cross(*point, first, dx, dy).max(most);
        }
        if most > greatest {
            (best, greatest) = (block * BLOCK, most);
        }
    }
    let mut place = BLOCK as u32;
    for (index, point) in points.get(best..)?.iter().take(BLOCK).enumerate() {
        let here = if cross(*point, first, dx, dy) == greatest { index as u32 } else { BLOCK as u32 };
        place = here.min(place);
    }
    Some((best + place as usize, u64::from(greatest)))
}

#[inline(always)]
fn cross(point: Point, first: Point, dx: i32, dy: i32) -> u32 {
    let (x, y) = (i32::from(point.x) - i32::from(first.x), i32::from(point.y) - i32::from(first.y));
    (dx * y - dy * x).unsigned_abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn simplified(points: &[(i16, i16)], tolerance: u32) -> Vec<(i16, i16)> {
        let mut points: Vec<Point> = points.iter().map(|&(x, y)| Point { x, y }).collect();
        let mut memory = vec![u32::MAX; simplify_memory(points.len())];
        let kept = simplify(&mut points, tolerance, &mut memory).unwrap();
        points[..kept].iter().map(|point| (point.x, point.y)).collect()
    }

    #[test]
    fn corners_stay_and_straights_go() {
        let square = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)];
        assert_eq!(simplified(&square, 128), [(0, 0), (2, 0), (2, 2), (0, 2), (0, 0)]);
        assert_eq!(simplified(&square, 10 * 256), [(0, 0), (0, 0)]);
        assert_eq!(
            simplified(&[(0, 0), (5, 1), (10, 0)], 256),
            [(0, 0), (10, 0)],
            "not farther than one pixel"
        );
        assert_eq!(simplified(&[(0, 0), (5, 1), (10, 0)], 255), [(0, 0), (5, 1), (10, 0)]);
    }

    #[test]
    fn short_curves_are_left_alone() {
        assert_eq!(simplified(&[], 1), []);
        assert_eq!(simplified(&[(3, 4)], 1), [(3, 4)]);
        assert_eq!(simplified(&[(3, 4), (3, 4)], 1), [(3, 4), (3, 4)]);
        assert_eq!(simplified(&[(3, 4), (3, 4), (3, 4)], 0), [(3, 4), (3, 4)]);
    }

    #[test]
    fn the_ends_of_the_range_do_not_overflow() {
        let (low, high) = (i16::MIN, i16::MAX);
        let points = [(low, low), (high, low), (high, high), (low, high), (low, low)];
        assert_eq!(simplified(&points, u32::MAX), [(low, low), (low, low)]);
        assert_eq!(simplified(&points, 256), points);
        assert_eq!(simplified(&[(0, 0), (high, 0), (high, high)], 0).len(), 3);
    }

    #[test]
    fn short_memory_is_refused() {
        let error = simplify(&mut [Point::default(); 33], 1, &mut [0]).unwrap_err();
        assert_eq!(error, Error::BufferLength { name: "memory", expected: 2, got: 1 });
    }
}
