use super::staircase::Staircase;
use super::{Point, Walk, Window};

/// Clips a line to a window by four inequalities. Equals [`clip_line`](super::clip_line).
///
/// ```text
///  p·t ≤ q for each side        t ├───▶ first side left behind (p < 0): t ≥ q/p
///                                 ◀───┤ first side run into    (p > 0): t ≤ q/p
/// ```
///
/// Reference: Y.-D. Liang and B. A. Barsky, "A new concept and method for line clipping", ACM Transactions on
/// Graphics 3 (1), 1984. We deviate in the parameter: it is the step of Bresenham's algorithm, a whole number, and the
/// inequalities are those of the pixels that are lit, so the bounds are rounded inwards and are then exact.
///
/// Cost: one division of 64 bits a side that is not parallel to the line. Memory: none.
#[must_use]
pub fn liang_barsky(from: Point, to: Point, window: &Window) -> Option<Walk> {
    let line = Staircase::new(from, to, window);
    // A single pixel has no direction; any will do, as it takes no step.
    let (major, minor) = (i64::from(line.major.max(1)), i64::from(line.minor));
    let along = (i64::from(line.along_range.0), i64::from(line.along_range.1));
    let across = (i64::from(line.across_range.0), i64::from(line.across_range.1));
    let sides = [
        (-1, -along.0),
        (1, along.1),
        // On or behind pixel k across: 2·t·minor > (2k − 1)·major. Not beyond it: 2·t·minor ≤ (2k + 1)·major.
        (-2 * minor, -(2 * across.0 - 1) * major - 1),
        (2 * minor, (2 * across.1 + 1) * major),
    ];
    let (mut first, mut last) = (0, i64::from(line.major));
    for (p, q) in sides {
        bound(p, q, &mut first, &mut last)?;
    }
    // Between 0 and `major`, so back in 32 bits.
    (first <= last).then(|| line.walk(line.stair_at(first as i32), last as i32))
}

/// Narrows the whole numbers t from `first` to `last` to those with p·t ≤ q; `None` if p = 0 and there are none.
#[inline]
pub(super) fn bound(p: i64, q: i64, first: &mut i64, last: &mut i64) -> Option<()> {
    match p {
        0 if q < 0 => return None,
        0 => {}
        // div_euclid rounds down for a positive divisor: −floor(q / −p) is the quotient q/p rounded up.
        ..0 => *first = (*first).max(-q.div_euclid(-p)),
        1.. => *last = (*last).min(q.div_euclid(p)),
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_inwards() {
        let narrowed = |p, q| {
            let (mut first, mut last) = (-100, 100);
            bound(p, q, &mut first, &mut last).map(|()| (first, last))
        };
        assert_eq!(narrowed(3, 7), Some((-100, 2)));
        assert_eq!(narrowed(3, -7), Some((-100, -3)));
        assert_eq!(narrowed(-3, 7), Some((-2, 100)));
        assert_eq!(narrowed(-3, -7), Some((3, 100)));
        assert_eq!(narrowed(0, 0), Some((-100, 100)));
        assert_eq!(narrowed(0, -1), None);
    }

    #[test]
    fn the_part_in_the_window_and_no_more() {
        let window = Window::new(Point::new(10, -5), Point::new(20, 5)).unwrap();
        let (from, to) = (Point::new(30, 9), Point::new(3, -6));
        let clipped = liang_barsky(from, to, &window).unwrap();
        assert!(clipped.eq(Walk::new(from, to).filter(|&point| window.contains(point))));
    }
}
