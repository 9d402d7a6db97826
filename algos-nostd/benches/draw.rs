//! Drawing and clipping at 640 × 480: lines inside and over-scanned, clips, fills, compositing.
//!
//! `cargo bench -p algos-nostd --bench draw`

use std::hint::black_box;

use algos_nostd::clip::{
    Walk, clip_line, clip_lines, cohen_sutherland, liang_barsky, nicholl_lee_nicholl, nine_regions,
};
use algos_nostd::draw::{
    Edge, FillRule, Operator, PendingRun, Point, Premultiplied, Rgba, Window, composite, draw_line,
    draw_line_gupta_sproull, draw_line_runs, draw_line_thick, draw_line_wu, fill_circle, fill_polygon,
    flood_fill, flood_fill_queue, flood_fill_stack, flood_fill_walk,
};
use algos_nostd::image::{Image, ImageMut};
use criterion::{Criterion, criterion_group, criterion_main};

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Segments with ends anywhere in a rectangle `scan` times the picture's size about its middle; the same each time.
fn segments(count: usize, scan: i32) -> Vec<(Point, Point)> {
    let mut state = 42u64;
    let mut below = |limit: i32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % limit as u64) as i32
    };
    let mut point = || {
        let coordinate = |at: i32, size: i32| (at - (scan - 1) * size / 2) as i16;
        let (width, height) = (WIDTH as i32, HEIGHT as i32);
        Point::new(coordinate(below(width * scan), width), coordinate(below(height * scan), height))
    };
    (0..count).map(|_| (point(), point())).collect()
}

type Draw = fn(&mut ImageMut<'_, u8>, Point, Point);
type Clip = fn(Point, Point, &Window) -> Option<Walk>;
type Fill = fn(&mut ImageMut<'_, u8>, u8, &mut [PendingRun], &mut [Point]) -> usize;

fn lines(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("10,000 lines");
    let mut pixels = vec![0u8; WIDTH * HEIGHT];
    let drawers: [(&str, Draw); 5] = [
        ("bresenham", |image, from, to| draw_line(image, from, to, 255)),
        ("runs", |image, from, to| draw_line_runs(image, from, to, 255)),
        ("thick 3", |image, from, to| draw_line_thick(image, from, to, 3, 255)),
        ("wu", |image, from, to| draw_line_wu(image, from, to, 255)),
        ("gupta-sproull", |image, from, to| draw_line_gupta_sproull(image, from, to, 255)),
    ];
    for (place, scan) in [("inside", 1), ("over-scanned", 3)] {
        let segments = segments(10_000, scan);
        for (name, draw) in drawers {
            group.bench_function(format!("{name}/{place}"), |bencher| {
                bencher.iter(|| {
                    let mut image = ImageMut::new(black_box(&mut pixels), WIDTH, HEIGHT).unwrap();
                    for &(from, to) in &segments {
                        draw(&mut image, from, to);
                    }
                });
            });
        }
    }
    group.finish();
}

fn clips(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("100,000 clips");
    let last = Point::new(WIDTH as i16 - 1, HEIGHT as i16 - 1);
    let window = Window::new(Point::new(0, 0), last).unwrap();
    let clippers: [(&str, Clip); 5] = [
        ("clip_line", clip_line),
        ("cohen-sutherland", cohen_sutherland),
        ("liang-barsky", liang_barsky),
        ("nicholl-lee-nicholl", nicholl_lee_nicholl),
        ("nine-regions", nine_regions),
    ];
    for (place, scan) in [("inside", 1), ("over-scanned", 3), ("far", 20)] {
        let segments = segments(100_000, scan);
        group.bench_function(format!("clip_lines/{place}"), |bencher| {
            bencher.iter(|| {
                let mut seen = 0;
                clip_lines(&segments, &window, |_, walk| {
                    black_box(&walk);
                    seen += 1;
                });
                seen
            });
        });
        for (name, clip) in clippers {
            group.bench_function(format!("{name}/{place}"), |bencher| {
                bencher.iter(|| {
                    let walks = segments.iter().filter_map(|&(from, to)| clip(from, to, &window));
                    walks.inspect(|walk| _ = black_box(walk)).count()
                });
            });
        }
    }
    group.finish();
}

fn fills(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fill 640x480");
    let mut pixels = vec![0u8; WIDTH * HEIGHT];
    let mut runs = [PendingRun::default(); 64];
    let mut points = vec![Point::default(); WIDTH * HEIGHT];
    const SEED: Point = Point::new(320, 240);
    let fills: [(&str, Fill); 4] = [
        ("span", |image, color, runs, _| flood_fill(image, SEED, color, runs)),
        ("stack", |image, color, _, points| flood_fill_stack(image, SEED, color, points)),
        ("queue", |image, color, _, points| flood_fill_queue(image, SEED, color, points)),
        ("walk", |image, color, _, _| flood_fill_walk(image, SEED, color)),
    ];
    for (name, fill) in fills {
        let mut color = 0u8;
        pixels.fill(0);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                color ^= 1;
                let mut image = ImageMut::new(&mut pixels, WIDTH, HEIGHT).unwrap();
                fill(&mut image, black_box(color), &mut runs, &mut points)
            });
        });
    }
    group.bench_function("circle", |bencher| {
        let mut image = ImageMut::new(&mut pixels, WIDTH, HEIGHT).unwrap();
        bencher.iter(|| fill_circle(&mut image, SEED, black_box(240), 7));
    });
    let star = [(320, 0), (500, 470), (20, 170), (620, 170), (140, 470)].map(|(x, y)| Point::new(x, y));
    group.bench_function("star", |bencher| {
        let mut image = ImageMut::new(&mut pixels, WIDTH, HEIGHT).unwrap();
        let mut edges = [Edge::default(); 5];
        bencher.iter(|| fill_polygon(&mut image, &[black_box(&star)], FillRule::NonZero, 7, &mut edges));
    });
    group.finish();
}

fn layers(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("composite 640x480");
    let pixel = |index: usize| {
        let [r, g, b, a] = (index as u32).wrapping_mul(2_654_435_761).to_le_bytes();
        Premultiplied::from_straight(Rgba { r, g, b, a })
    };
    let source: Vec<_> = (0..WIDTH * HEIGHT).map(pixel).collect();
    let mut destination: Vec<_> = source.iter().rev().copied().collect();
    for operator in [Operator::SourceOver, Operator::Xor, Operator::Plus] {
        group.bench_function(operator.name(), |bencher| {
            let source = Image::new(&source, WIDTH, HEIGHT).unwrap();
            let mut destination = ImageMut::new(&mut destination, WIDTH, HEIGHT).unwrap();
            bencher.iter(|| composite(black_box(operator), source, &mut destination));
        });
    }
    group.finish();
}

criterion_group!(benches, lines, clips, fills, layers);
criterion_main!(benches);
