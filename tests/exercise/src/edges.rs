//! Gradients, Canny, and what follows an edge map.

use algos_nostd::edges::gradient::{CentralDifference, Operator, Prewitt, Roberts, Scharr, Sobel};
use algos_nostd::edges::measure::{Components, L1, L2, Measure, Saturated, Sector4, Sector8, SquaredL2};
use algos_nostd::edges::smooth::{self, NoSmoothing};
use algos_nostd::edges::{
    BitMap, BitMapMut, CannyConfig, CannyLines, CannySmoothing, GradientFilter, Norm, Thinning, Thresholds,
    ZeroCrossings, canny, grow, simplify, thin, trace, unpack,
};
use algos_nostd::image::Error;
use algos_nostd::lines::LineFilter;

use crate::over::{over, over_bytes};
use crate::report::{Clock, Done, Exercise, Unit::Pixel, Unit::Point};
use crate::space::{HEIGHT, PIXELS, Random, WIDTH, Workspace, gray_view};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise { name: "sobel components", unit: Pixel, run: components },
    Exercise { name: "sobel l1", unit: Pixel, run: magnitude::<Sobel, L1> },
    Exercise { name: "sobel l2", unit: Pixel, run: magnitude::<Sobel, L2> },
    Exercise { name: "sobel l1 saturated", unit: Pixel, run: byte::<Sobel, Saturated<L1>> },
    Exercise { name: "sobel l2 squared", unit: Pixel, run: squared },
    Exercise { name: "sobel direction of four", unit: Pixel, run: byte::<Sobel, Sector4> },
    Exercise { name: "sobel direction of eight", unit: Pixel, run: byte::<Sobel, Sector8> },
    Exercise { name: "scharr l1", unit: Pixel, run: magnitude::<Scharr, L1> },
    Exercise { name: "prewitt l1", unit: Pixel, run: magnitude::<Prewitt, L1> },
    Exercise { name: "roberts l1", unit: Pixel, run: magnitude::<Roberts, L1> },
    Exercise { name: "central difference l1", unit: Pixel, run: magnitude::<CentralDifference, L1> },
    Exercise { name: "canny l1", unit: Pixel, run: |s, c| whole(s, c, CannySmoothing::None, Norm::L1) },
    Exercise {
        name: "gaussian 3x3 and canny l1",
        unit: Pixel,
        run: |s, c| whole(s, c, CannySmoothing::Gaussian3, Norm::L1),
    },
    Exercise {
        name: "gaussian 3x3 and canny l2",
        unit: Pixel,
        run: |s, c| whole(s, c, CannySmoothing::Gaussian3, Norm::L2),
    },
    Exercise {
        name: "gaussian 5x5 and canny l2",
        unit: Pixel,
        run: |s, c| whole(s, c, CannySmoothing::Gaussian5, Norm::L2),
    },
    Exercise { name: "canny by lines, without hysteresis", unit: Pixel, run: by_lines },
    Exercise { name: "zero crossings", unit: Pixel, run: crossings },
    Exercise { name: "hysteresis", unit: Pixel, run: hysteresis },
    Exercise { name: "unpack a bit map", unit: Pixel, run: unpacked },
    Exercise { name: "thin zhang-suen", unit: Pixel, run: |s, c| thinned(s, c, Thinning::ZhangSuen) },
    Exercise { name: "thin guo-hall", unit: Pixel, run: |s, c| thinned(s, c, Thinning::GuoHall) },
    Exercise { name: "thin four sides", unit: Pixel, run: |s, c| thinned(s, c, Thinning::FourSides) },
    Exercise { name: "trace", unit: Pixel, run: traced },
    Exercise { name: "simplify", unit: Point, run: simplified },
];

fn components(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let line = &mut [Default::default(); WIDTH];
    let filter = GradientFilter::<Sobel, Components>::new(WIDTH, &mut space.memory, line);
    over(filter, gray_view(&space.gray)?, &mut space.gradients, clock)?;
    Ok(Done::of(PIXELS, |results| {
        for gradient in &space.gradients {
            results.bytes(&gradient.x.to_le_bytes());
            results.bytes(&gradient.y.to_le_bytes());
        }
    }))
}

fn magnitude<O: Operator, M: Measure<Output = u16>>(
    space: &mut Workspace,
    clock: &mut dyn Clock,
) -> Result<Done, Error> {
    let filter = GradientFilter::<O, M>::new(WIDTH, &mut space.memory, &mut space.half_line);
    over(filter, gray_view(&space.gray)?, &mut space.halves, clock)?;
    Ok(Done::of(PIXELS, |results| space.halves.iter().for_each(|half| results.bytes(&half.to_le_bytes()))))
}

fn byte<O: Operator, M: Measure<Output = u8>>(
    space: &mut Workspace,
    clock: &mut dyn Clock,
) -> Result<Done, Error> {
    let line = &mut space.byte_line[..WIDTH];
    let filter = GradientFilter::<O, M>::new(WIDTH, &mut space.memory, line);
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

fn squared(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let line = &mut space.word_memory[..WIDTH];
    let filter = GradientFilter::<Sobel, SquaredL2>::new(WIDTH, &mut space.memory, line);
    over(filter, gray_view(&space.gray)?, &mut space.words, clock)?;
    Ok(Done::of(PIXELS, |results| space.words.iter().for_each(|word| results.bytes(&word.to_le_bytes()))))
}

/// Canny's usual thresholds, by these measures.
const fn thresholds(norm: Norm) -> Thresholds {
    Thresholds { low: 50, high: 150, norm }
}

fn map_done(units: usize, words: &[u32]) -> Done {
    Done::of(units, |results| words.iter().for_each(|word| results.bytes(&word.to_le_bytes())))
}

fn whole(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    smoothing: CannySmoothing,
    norm: Norm,
) -> Result<Done, Error> {
    let config = CannyConfig { smoothing, thresholds: thresholds(norm) };
    let mut map = BitMapMut::new(&mut space.edges, WIDTH, HEIGHT)?;
    let input = gray_view(&space.gray)?;
    clock.start();
    let result = canny(input, &config, &mut space.word_memory, &mut map);
    clock.stop();
    result?;
    Ok(map_done(PIXELS, &space.edges))
}

/// What stays within a window of lines: candidates and strong pixels.
fn by_lines(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let mut filter =
        CannyLines::<smooth::Gaussian5>::new(WIDTH, thresholds(Norm::L2), &mut space.word_memory)?;
    let mut rows = space.marks.chunks_exact_mut(WIDTH.div_ceil(32));
    let mut keep = |line: &[_]| {
        if let Some(row) = rows.next() {
            row.copy_from_slice(line);
        }
    };
    clock.start();
    for line in gray_view(&space.gray)?.rows() {
        filter.push(line, &mut keep)?;
    }
    filter.finish(&mut keep);
    clock.stop();
    Ok(Done::of(PIXELS, |results| {
        for marks in &space.marks {
            results.bytes(&marks.candidates.to_le_bytes());
            results.bytes(&marks.strong.to_le_bytes());
        }
    }))
}

fn crossings(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let mut filter = ZeroCrossings::<NoSmoothing>::new(WIDTH, 40, &mut space.word_memory)?;
    let mut rows = space.edges.chunks_exact_mut(WIDTH.div_ceil(32));
    let mut keep = |line: &[u32]| {
        if let Some(row) = rows.next() {
            row.copy_from_slice(line);
        }
    };
    clock.start();
    for line in gray_view(&space.gray)?.rows() {
        filter.push(line, &mut keep)?;
    }
    filter.finish(&mut keep);
    clock.stop();
    Ok(map_done(PIXELS, &space.edges))
}

fn hysteresis(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    by_lines(space, &mut ())?;
    for ((candidates, strong), marks) in space.map.iter_mut().zip(&mut space.edges).zip(&space.marks) {
        (*candidates, *strong) = (marks.candidates, marks.strong);
    }
    let mut strong = BitMapMut::new(&mut space.edges, WIDTH, HEIGHT)?;
    let candidates = BitMap::new(&space.map, WIDTH, HEIGHT)?;
    clock.start();
    let result = grow(candidates, &mut strong);
    clock.stop();
    result?;
    Ok(map_done(PIXELS, &space.edges))
}

/// Canny's edges in `space.edges`.
fn make_edges(space: &mut Workspace) -> Result<(), Error> {
    whole(space, &mut (), CannySmoothing::Gaussian3, Norm::L1).map(|_| ())
}

fn unpacked(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    make_edges(space)?;
    let bytes = &mut space.bytes[..PIXELS];
    clock.start();
    for (words, bytes) in space.edges.chunks_exact(WIDTH.div_ceil(32)).zip(bytes.chunks_exact_mut(WIDTH)) {
        unpack(words, bytes);
    }
    clock.stop();
    Ok(Done::new(PIXELS, bytes))
}

/// What is dark in the picture, down to its lines.
fn thinned(space: &mut Workspace, clock: &mut dyn Clock, thinning: Thinning) -> Result<Done, Error> {
    let mut map = BitMapMut::new(&mut space.edges, WIDTH, HEIGHT)?;
    map.clear();
    for (at, &level) in space.gray.iter().enumerate() {
        map.set(at % WIDTH, at / WIDTH, level < 80);
    }
    clock.start();
    let passes = thin(&mut map, thinning, &mut space.word_memory);
    clock.stop();
    passes?;
    Ok(map_done(PIXELS, &space.edges))
}

fn traced(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    make_edges(space)?;
    let edges = BitMap::new(&space.edges, WIDTH, HEIGHT)?;
    let mut rest = BitMapMut::new(&mut space.map, WIDTH, HEIGHT)?;
    let (mut curves, mut sum) = (0, 0);
    clock.start();
    let result = trace(edges, &mut rest, &mut space.points, &mut |curve| {
        curves += 1;
        for point in &*curve.points {
            sum = i64::wrapping_add(sum * 31, i64::from(point.x) << 16 | i64::from(point.y)) & 0xFFFF_FFFF;
        }
    });
    clock.stop();
    result?;
    Ok(Done::of(PIXELS, |results| results.numbers([curves, sum])))
}

/// A curve that turns at every scale: each step goes to a neighbour at random.
fn simplified(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let points = &mut space.points[..4096];
    let (mut random, mut x, mut y) = (Random(1), 5000, 5000);
    for point in &mut *points {
        x += random.below(3) as i16 - 1;
        y += random.below(3) as i16 - 1;
        *point = algos_nostd::edges::Point::new(x, y);
    }
    clock.start();
    let kept = simplify(points, 256, &mut space.word_memory);
    clock.stop();
    let kept = points[..kept?].iter().flat_map(|point| [i64::from(point.x), i64::from(point.y)]);
    Ok(Done::of(4096, |results| results.numbers(kept)))
}
