//! Ramer–Douglas–Peucker over a curve that turns at every scale.

use crate::stopwatch::Stopwatch;
use algos_nostd::edges::{self, Point};
use anyhow::Result;
use imageproc::geometry::approximate_polygon_dp;
use imageproc::point::Point as PeerPoint;
use std::hint::black_box;

const POINTS: usize = 10_000;

/// Each step goes to a neighbour at random, or stays.
fn walk() -> Vec<Point> {
    let mut state = 1u32;
    let mut step = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) as i16 % 3 - 1
    };
    let mut at = Point { x: 5000, y: 5000 };
    let mut next = || {
        at = Point { x: at.x + step(), y: at.y + step() };
        at
    };
    (0..POINTS).map(|_| next()).collect()
}

/// Whole curve first, points kept after, as pairs of 32 bits: so that Python can give its peers the same curve.
fn written(curve: &[Point], kept: impl Iterator<Item = (i32, i32)>) -> Vec<u8> {
    let all = curve.iter().map(|point| (point.x.into(), point.y.into())).chain(kept);
    all.flat_map(|(x, y)| [x, y]).flat_map(i32::to_le_bytes).collect()
}

/// In place, on a copy that is made by the clock.
pub(crate) fn ours(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let curve = walk();
    let (mut points, mut memory) = (curve.clone(), vec![0; edges::simplify_memory(POINTS)]);
    let mut kept = Ok(0);
    stopwatch.time(|| {
        points.copy_from_slice(black_box(&curve));
        kept = edges::simplify(&mut points, 256, &mut memory);
    });
    points.truncate(kept?);
    Ok(written(&curve, points.iter().map(|point| (point.x.into(), point.y.into()))))
}

/// The same by imageproc.
pub(crate) fn imageproc(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let curve = walk();
    let points: Vec<_> =
        curve.iter().map(|point| PeerPoint::new(i32::from(point.x), i32::from(point.y))).collect();
    let mut kept = Vec::new();
    stopwatch.time(|| kept = approximate_polygon_dp(black_box(&points), 1.0, false));
    Ok(written(&curve, kept.iter().map(|point| (point.x, point.y))))
}
