//! Edges from the definitions: floating point, whole pictures, one pixel at a time.

use std::collections::VecDeque;

/// A picture of anything, `width` a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plane<T> {
    /// The pixels, line after line.
    pub pixels: Vec<T>,
    /// Pixels a line.
    pub width: usize,
}

impl<T: Copy> Plane<T> {
    /// Lines.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// The pixel at a place, if it is inside.
    pub fn get(&self, x: i64, y: i64) -> Option<T> {
        let inside = (0..self.width as i64).contains(&x) && (0..self.height() as i64).contains(&y);
        inside.then(|| self.pixels[y as usize * self.width + x as usize])
    }

    /// The pixel at a place, or the nearest one inside.
    pub fn nearest(&self, x: i64, y: i64) -> T {
        let (x, y) = (x.clamp(0, self.width as i64 - 1), y.clamp(0, self.height() as i64 - 1));
        self.pixels[y as usize * self.width + x as usize]
    }

    /// Another picture of the same size, made place by place.
    pub fn map<U>(&self, make: impl Fn(i64, i64) -> U) -> Plane<U> {
        let places = (0..self.pixels.len()).map(|i| ((i % self.width) as i64, (i / self.width) as i64));
        Plane { pixels: places.map(|(x, y)| make(x, y)).collect(), width: self.width }
    }
}

/// A kernel of odd sides laid over every pixel, the picture replicated beyond its edges; no division.
pub fn correlate(picture: &Plane<f64>, kernel: &[&[i32]]) -> Plane<f64> {
    let (up, left) = (kernel.len() as i64 / 2, kernel[0].len() as i64 / 2);
    picture.map(|x, y| {
        let mut sum = 0.0;
        for (j, row) in kernel.iter().enumerate() {
            for (i, &weight) in row.iter().enumerate() {
                sum += f64::from(weight) * picture.nearest(x + i as i64 - left, y + j as i64 - up);
            }
        }
        sum
    })
}

/// The 5 × 5 Gaussian of σ = 1.4, times 159.
pub const GAUSSIAN_5: [&[i32]; 5] =
    [&[2, 4, 5, 4, 2], &[4, 9, 12, 9, 4], &[5, 12, 15, 12, 5], &[4, 9, 12, 9, 4], &[2, 4, 5, 4, 2]];
/// The 3 × 3 Gaussian, times 16.
pub const GAUSSIAN_3: [&[i32]; 3] = [&[1, 2, 1], &[2, 4, 2], &[1, 2, 1]];
/// Sobel's x kernel.
pub const SOBEL_X: [&[i32]; 3] = [&[-1, 0, 1], &[-2, 0, 2], &[-1, 0, 1]];
/// Sobel's y kernel.
pub const SOBEL_Y: [&[i32]; 3] = [&[-1, -2, -1], &[0, 0, 0], &[1, 2, 1]];

/// A picture of bytes as floating point.
pub fn float(picture: &Plane<u8>) -> Plane<f64> {
    picture.map(|x, y| f64::from(picture.nearest(x, y)))
}

/// Canny by the textbook. `kernel` is the smoothing and its sum the divisor; nothing is rounded.
pub fn canny(picture: &Plane<u8>, kernel: &[&[i32]], l2: bool, low: f64, high: f64) -> Plane<bool> {
    let divisor = f64::from(kernel.iter().flat_map(|row| row.iter()).sum::<i32>());
    let smooth = correlate(&float(picture), kernel);
    // Sums of whole numbers so far; the division comes last so that equal magnitudes stay equal.
    let (gx, gy) = (correlate(&smooth, &SOBEL_X), correlate(&smooth, &SOBEL_Y));
    let magnitude = smooth.map(|x, y| {
        let (x, y) = (gx.nearest(x, y), gy.nearest(x, y));
        (if l2 { (x * x + y * y).sqrt() } else { x.abs() + y.abs() }) / divisor
    });
    let crest = |x: i64, y: i64| {
        // The angle in sectors of 45°, rounded: 0 ─, 1 ╲, 2 │, 3 ╱ (y downwards).
        let angle = gy.nearest(x, y).atan2(gx.nearest(x, y)).to_degrees();
        let (dx, dy) =
            [(1, 0), (1, 1), (0, 1), (-1, 1)][((angle / 45.0).round() as i64).rem_euclid(4) as usize];
        // The neighbour that comes first in reading order must be lower, the other not higher.
        let (first, second) = if (dy, dx) > (0, 0) { ((-dx, -dy), (dx, dy)) } else { ((dx, dy), (-dx, -dy)) };
        let at = |(dx, dy): (i64, i64)| magnitude.get(x + dx, y + dy).unwrap_or(0.0);
        at((0, 0)) > at(first) && at((0, 0)) >= at(second)
    };
    let candidates = magnitude.map(|x, y| magnitude.nearest(x, y) > low && crest(x, y));
    let strong = magnitude.map(|x, y| magnitude.nearest(x, y) > high && candidates.nearest(x, y));
    hysteresis(&candidates, &strong)
}

/// What candidates can be reached from strong pixels over the eight neighbours: a flood.
pub fn hysteresis(candidates: &Plane<bool>, strong: &Plane<bool>) -> Plane<bool> {
    let mut reached = strong.clone();
    let mut queue: VecDeque<(i64, i64)> = VecDeque::new();
    let width = strong.width as i64;
    queue.extend(
        (0..strong.pixels.len()).filter(|&i| strong.pixels[i]).map(|i| (i as i64 % width, i as i64 / width)),
    );
    while let Some((x, y)) = queue.pop_front() {
        for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
            let (x, y) = (x + dx, y + dy);
            if candidates.get(x, y) == Some(true) && reached.get(x, y) == Some(false) {
                reached.pixels[(y * width + x) as usize] = true;
                queue.push_back((x, y));
            }
        }
    }
    reached
}

/// The agreement of two maps, pixel by pixel: F1, the harmonic mean of precision and recall. Two empty maps agree.
pub fn agreement(one: &Plane<bool>, other: &Plane<bool>) -> f64 {
    let count = |plane: &Plane<bool>| plane.pixels.iter().filter(|&&set| set).count();
    let both = one.pixels.iter().zip(&other.pixels).filter(|(one, other)| **one && **other).count();
    let sum = count(one) + count(other);
    if sum == 0 { 1.0 } else { 2.0 * both as f64 / sum as f64 }
}

/// Ramer–Douglas–Peucker as it is defined, with exact comparisons: the places of the points kept.
pub fn simplify(points: &[(i16, i16)], tolerance_256: u32) -> Vec<usize> {
    fn recurse(points: &[(i16, i16)], from: usize, to: usize, tolerance: i128, kept: &mut Vec<usize>) {
        let place = |i: usize| (i128::from(points[i].0), i128::from(points[i].1));
        let ((ax, ay), (bx, by)) = (place(from), place(to));
        let squared_length = (bx - ax).pow(2) + (by - ay).pow(2);
        // Squared distance times squared length; squared distance alone if the ends are one.
        let far = |i: usize| {
            let (px, py) = place(i);
            if squared_length == 0 {
                (px - ax).pow(2) + (py - ay).pow(2)
            } else {
                ((bx - ax) * (py - ay) - (by - ay) * (px - ax)).pow(2)
            }
        };
        let farthest = (from + 1..to).rev().max_by_key(|&i| far(i)); // of equals the last looked at: the first point
        if let Some(split) = farthest
            && far(split) * 65536 > tolerance * tolerance * squared_length.max(1)
        {
            recurse(points, from, split, tolerance, kept);
            kept.push(split);
            recurse(points, split, to, tolerance, kept);
        }
    }
    let mut kept = Vec::new();
    if let Some(last) = points.len().checked_sub(1) {
        kept.push(0);
        recurse(points, 0, last, tolerance_256.into(), &mut kept);
        if last > 0 {
            kept.push(last);
        }
    }
    kept
}

/// The eight neighbours of a pixel, clockwise from the one above.
fn ring(map: &Plane<bool>, x: i64, y: i64) -> [bool; 8] {
    [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)]
        .map(|(dx, dy)| map.get(x + dx, y + dy) == Some(true))
}

/// Passes of a deletion rule, in turn, each seeing the map as it was before the pass, until a round changes nothing.
fn thin(map: &Plane<bool>, passes: &[&dyn Fn([bool; 8]) -> bool]) -> Plane<bool> {
    let mut map = map.clone();
    loop {
        let before = map.clone();
        for goes in passes {
            map = map.map(|x, y| map.nearest(x, y) && !goes(ring(&map, x, y)));
        }
        if map == before {
            return map;
        }
    }
}

/// Zhang and Suen's thinning; their P2 to P9 are `ring[0]` to `ring[7]`.
pub fn zhang_suen(map: &Plane<bool>) -> Plane<bool> {
    let both = |p: [bool; 8]| {
        let neighbours = p.iter().filter(|&&set| set).count();
        let rises = (0..8).filter(|&i| !p[i] && p[(i + 1) % 8]).count();
        (2..=6).contains(&neighbours) && rises == 1
    };
    let first = |p: [bool; 8]| both(p) && !(p[0] && p[2] && p[4]) && !(p[2] && p[4] && p[6]);
    let second = |p: [bool; 8]| both(p) && !(p[0] && p[2] && p[6]) && !(p[0] && p[4] && p[6]);
    thin(map, &[&first, &second])
}

/// Guo and Hall's thinning; their p1 is the upper left neighbour, then clockwise.
pub fn guo_hall(map: &Plane<bool>) -> Plane<bool> {
    let both = |ring: [bool; 8]| {
        let p = |i: usize| ring[(i + 6) % 8]; // p(1) = upper left = ring[7]
        let figures = (1..=4).filter(|&k| !p(2 * k) && (p(2 * k + 1) || p(2 * k + 2))).count();
        let first = (1..=4).filter(|&k| p(2 * k - 1) || p(2 * k)).count();
        let second = (1..=4).filter(|&k| p(2 * k) || p(2 * k + 1)).count();
        figures == 1 && (2..=3).contains(&first.min(second))
    };
    let first = |q: [bool; 8]| both(q) && !((q[0] || q[1] || !q[3]) && q[2]);
    let second = |q: [bool; 8]| both(q) && !((q[4] || q[5] || !q[7]) && q[6]);
    thin(map, &[&first, &second])
}

/// Rosenfeld's thinning, a side at a time: bare on that side, simple, and no end.
pub fn four_sides(map: &Plane<bool>) -> Plane<bool> {
    // Simple: the neighbours set are one figure of eight-connected pixels, and a side neighbour is not set.
    let simple = |p: [bool; 8]| {
        let place =
            |i: usize| [(0i32, -1i32), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)][i];
        let set: Vec<_> = (0..8).filter(|&i| p[i]).map(place).collect();
        let mut figure: Vec<_> = set.first().copied().into_iter().collect();
        let mut seen = 0;
        while seen < figure.len() {
            let (x, y) = figure[seen];
            for &(u, v) in &set {
                if (x - u).abs() <= 1 && (y - v).abs() <= 1 && !figure.contains(&(u, v)) {
                    figure.push((u, v));
                }
            }
            seen += 1;
        }
        set.len() >= 2 && figure.len() == set.len() && !(p[0] && p[2] && p[4] && p[6])
    };
    let [north, south, west, east] =
        [0, 4, 6, 2].map(|side: usize| move |p: [bool; 8]| simple(p) && !p[side]);
    thin(map, &[&north, &south, &west, &east])
}

/// Marr and Hildreth's edges of a smoothed picture (not divided by `scale`), as `algos_nostd` states the rule.
pub fn zero_crossings(smooth: &Plane<f64>, scale: f64, threshold: f64) -> Plane<bool> {
    let laplacian = correlate(smooth, &[&[1, 1, 1], &[1, -8, 1], &[1, 1, 1]]);
    let crosses = |one: f64, other: f64| one * other < 0.0 && (one - other).abs() > threshold * scale;
    smooth.map(|x, y| {
        let pixel = laplacian.nearest(x, y);
        [(1, 0), (0, 1)].iter().any(|&(dx, dy)| {
            let (before, after) = (laplacian.nearest(x - dx, y - dy), laplacian.nearest(x + dx, y + dy));
            (crosses(pixel, before) && pixel.abs() < before.abs())
                || (crosses(pixel, after) && pixel.abs() <= after.abs())
                || (pixel == 0.0 && crosses(before, after))
        })
    })
}
