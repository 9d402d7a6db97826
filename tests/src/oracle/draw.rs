//! Drawing from the definitions: points in polygons, breadth-first filling, compositing in floating point.

use algos_nostd::draw::{Operator, Point};

/// Whether a pixel's centre is inside of closed contours, by counting the sides that a ray to the left crosses: in
/// all, and downwards less upwards. A side runs from its upper end to before its lower end and counts if it is left of
/// the centre or goes through it.
#[must_use]
pub fn crossings(contours: &[&[Point]], x: i64, y: i64) -> (i64, i64) {
    let (mut count, mut winding) = (0, 0);
    for contour in contours {
        for (a, b) in contour.iter().zip(contour.iter().cycle().skip(1)) {
            let (upper, lower, direction) = if a.y <= b.y { (a, b, 1) } else { (b, a, -1) };
            let (ux, uy) = (i64::from(upper.x), i64::from(upper.y));
            let (lx, ly) = (i64::from(lower.x), i64::from(lower.y));
            if uy <= y && y < ly && (lx - ux) * (y - uy) <= (x - ux) * (ly - uy) {
                count += 1;
                winding += direction;
            }
        }
    }
    (count, winding)
}

/// The pixels joined to a seed over pixels that equal it: breadth first, in memory as large as need be.
#[must_use]
pub fn joined<P: PartialEq>(pixels: &[P], width: usize, seed: (usize, usize)) -> Vec<bool> {
    let height = pixels.len() / width;
    let mut found = vec![false; pixels.len()];
    let mut waiting = std::collections::VecDeque::from([seed]);
    found[seed.1 * width + seed.0] = true;
    while let Some((x, y)) = waiting.pop_front() {
        let steps = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
        for (x, y) in steps.into_iter().filter(|&(x, y)| x < width && y < height) {
            let index = y * width + x;
            if !found[index] && pixels[index] == pixels[seed.1 * width + seed.0] {
                found[index] = true;
                waiting.push_back((x, y));
            }
        }
    }
    found
}

/// Porter and Duff's table, in fractions: what source and destination are multiplied by.
#[must_use]
pub fn factors(operator: Operator, source: f64, destination: f64) -> (f64, f64) {
    match operator {
        Operator::Clear => (0.0, 0.0),
        Operator::Source => (1.0, 0.0),
        Operator::Destination => (0.0, 1.0),
        Operator::SourceOver => (1.0, 1.0 - source),
        Operator::DestinationOver => (1.0 - destination, 1.0),
        Operator::SourceIn => (destination, 0.0),
        Operator::DestinationIn => (0.0, source),
        Operator::SourceOut => (1.0 - destination, 0.0),
        Operator::DestinationOut => (0.0, 1.0 - source),
        Operator::SourceAtop => (destination, 1.0 - source),
        Operator::DestinationAtop => (1.0 - destination, source),
        Operator::Xor => (1.0 - destination, 1.0 - source),
        Operator::Plus => (1.0, 1.0),
    }
}

/// A premultiplied colour and alpha on another one, in fractions of one.
#[must_use]
pub fn premultiplied(operator: Operator, source: (f64, f64), destination: (f64, f64)) -> (f64, f64) {
    let (fs, fd) = factors(operator, source.1, destination.1);
    ((source.0 * fs + destination.0 * fd).min(1.0), (source.1 * fs + destination.1 * fd).min(1.0))
}

/// Distance of a pixel from the endless line through two points, signed, and how far along it is, both in pixels.
#[must_use]
pub fn from_line(from: Point, to: Point, x: f64, y: f64) -> (f64, f64) {
    let (dx, dy) = (f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y));
    let (x, y) = (x - f64::from(from.x), y - f64::from(from.y));
    let length = dx.hypot(dy);
    ((dx * y - dy * x) / length, (dx * x + dy * y) / length)
}

/// The volume of a cone of radius 1 and volume 1 over a strip of width 1 whose middle is `distance` away, by summing
/// columns.
#[must_use]
pub fn cone_over_strip(distance: f64) -> f64 {
    const STEPS: i32 = 400;
    let step = 2.0 / f64::from(STEPS);
    let middle = |index: i32| (f64::from(index) + 0.5) * step - 1.0;
    let mut volume = 0.0;
    for x in (0..STEPS).map(middle).filter(|x| (x - distance).abs() <= 0.5) {
        for y in (0..STEPS).map(middle) {
            volume += (1.0 - x.hypot(y)).max(0.0) * step * step;
        }
    }
    volume * 3.0 / std::f64::consts::PI
}
