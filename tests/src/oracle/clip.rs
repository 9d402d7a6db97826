//! Lines by rounding exact rationals, and clipping by leaving out pixels.

use algos_nostd::clip::{Point, Window};

/// The pixels of a line from the definition: at each step along the longer side, the pixel nearest to the ideal line,
/// and of two equally near ones that on the start's side.
#[must_use]
pub fn line(from: Point, to: Point) -> Vec<Point> {
    let (dx, dy) = (i64::from(to.x) - i64::from(from.x), i64::from(to.y) - i64::from(from.y));
    let steps = dx.abs().max(dy.abs());
    // Rounded to nearest, halves towards zero: the offset from the start shrinks.
    let at = |step: i64, side: i64| match steps {
        0 => 0,
        _ => side.signum() * (2 * step * side.abs() + steps - 1).div_euclid(2 * steps),
    };
    (0..=steps)
        .map(|step| {
            let (x, y) = (i64::from(from.x) + at(step, dx), i64::from(from.y) + at(step, dy));
            Point::new(i16::try_from(x).unwrap(), i16::try_from(y).unwrap())
        })
        .collect()
}

/// The pixels of a line that are in a window.
#[must_use]
pub fn clipped(from: Point, to: Point, window: &Window) -> Vec<Point> {
    line(from, to).into_iter().filter(|&point| window.contains(point)).collect()
}

/// The pixels of a line that are in a convex polygon: against edges parallel to an axis the pixel is judged, against
/// others the ideal point of its step. Exact: rationals over the number of steps.
#[must_use]
pub fn clipped_convex(from: Point, to: Point, corners: &[Point]) -> Vec<Point> {
    let (dx, dy) = (i128::from(to.x) - i128::from(from.x), i128::from(to.y) - i128::from(from.y));
    let steps = dx.abs().max(dy.abs()).max(1);
    let scaled = |point: Point| (i128::from(point.x) * steps, i128::from(point.y) * steps);
    let side = |a: Point, b: Point, (x, y): (i128, i128)| {
        let (ax, ay) = scaled(a);
        (i128::from(b.x) - i128::from(a.x)) * (y - ay) - (i128::from(b.y) - i128::from(a.y)) * (x - ax)
    };
    let edges = || corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| (a, b));
    let turn: i128 = edges()
        .flat_map(|(a, b)| corners.iter().map(move |&c| (a, b, c)))
        .map(|(a, b, c)| side(a, b, scaled(c)).signum())
        .sum();
    let pixels = line(from, to);
    (0..)
        .zip(&pixels)
        .filter(|&(step, &pixel)| {
            let (x, y) = scaled(from);
            let ideal = (x + step * dx, y + step * dy);
            edges().all(|(a, b)| {
                let judged = if a.x == b.x || a.y == b.y { scaled(pixel) } else { ideal };
                side(a, b, judged) * turn.signum() >= 0
            })
        })
        .map(|(_, &pixel)| pixel)
        .collect()
}

/// Twice the area of a polygon, signed.
#[must_use]
pub fn doubled_area(corners: &[Point]) -> i64 {
    corners
        .iter()
        .zip(corners.iter().cycle().skip(1))
        .map(|(a, b)| i64::from(a.x) * i64::from(b.y) - i64::from(b.x) * i64::from(a.y))
        .sum()
}
