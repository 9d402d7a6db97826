//! Demosaicing, curves, statistics, white balance.

use algos_nostd::color::balance::adaptation::{Space, in_rgb};
use algos_nostd::color::balance::gray_edge::{GrayEdge, Norm};
use algos_nostd::color::balance::gray_world::{GrayWorld, estimate};
use algos_nostd::color::balance::matrix::Matrix3;
use algos_nostd::color::balance::running::RunningWhite;
use algos_nostd::color::balance::white_patch::WhitePatch;
use algos_nostd::color::balance::{Gains, White};
use algos_nostd::color::curve::Curve;
use algos_nostd::color::demosaic::bilinear::Bilinear;
use algos_nostd::color::demosaic::malvar::Malvar;
use algos_nostd::color::histogram::Histogram;
use algos_nostd::color::pointwise::{PixelMap, Pointwise};
use algos_nostd::image::{Error, Image, Rgb};
use algos_nostd::pixel::bayer::{BayerOrder, mosaic_line};
use algos_nostd::pixel::{BitDepth, rgb888};

use crate::over::{over, over_bytes};
use crate::pixels::samples;
use crate::report::{Clock, Done, Exercise, Unit::Call, Unit::Pixel};
use crate::space::{HEIGHT, PIXELS, WIDTH, Workspace, gray_view, view};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise { name: "demosaic bilinear", unit: Pixel, run: bilinear },
    Exercise { name: "demosaic malvar", unit: Pixel, run: malvar },
    Exercise { name: "demosaic malvar 12 bits", unit: Pixel, run: malvar_deep },
    Exercise { name: "curve making gamma", unit: Call, run: make_gamma },
    Exercise { name: "curve making srgb", unit: Call, run: make_srgb },
    Exercise { name: "curve making through points", unit: Call, run: make_through },
    Exercise { name: "curve of gray", unit: Pixel, run: curve_gray },
    Exercise { name: "curve of rgb", unit: Pixel, run: curve_rgb },
    Exercise { name: "histogram of gray", unit: Pixel, run: histogram },
    Exercise { name: "white gray-world", unit: Pixel, run: gray_world },
    Exercise { name: "white patch", unit: Pixel, run: white_patch },
    Exercise { name: "white gray-edge l1", unit: Pixel, run: gray_edge_l1 },
    Exercise { name: "white gray-edge l2", unit: Pixel, run: gray_edge_l2 },
    Exercise { name: "white running mean", unit: Call, run: running },
    Exercise { name: "balance gains", unit: Pixel, run: gains },
    Exercise { name: "balance gray-world whole", unit: Pixel, run: balance },
    Exercise { name: "colour matrix", unit: Pixel, run: matrix },
    Exercise { name: "colour matrix of an adaptation", unit: Call, run: adaptation },
];

fn bilinear(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    mosaic(space)?;
    let input = Image::new(&space.bytes[..PIXELS], WIDTH, HEIGHT)?;
    let line = &mut space.line[..WIDTH];
    let filter = Bilinear::new(BayerOrder::Rggb, BitDepth::Bits8, &mut space.memory, line);
    over(filter, input, &mut space.pixels, clock)?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn malvar(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    mosaic(space)?;
    let input = Image::new(&space.bytes[..PIXELS], WIDTH, HEIGHT)?;
    let line = &mut space.line[..WIDTH];
    let filter = Malvar::new(BayerOrder::Rggb, BitDepth::Bits8, &mut space.memory, line);
    over(filter, input, &mut space.pixels, clock)?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn malvar_deep(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    samples(space, &mut (), BitDepth::Bits12)?;
    let input = Image::new(&space.halves[..], WIDTH, HEIGHT)?;
    let line = &mut space.line[..WIDTH];
    let filter = Malvar::new(BayerOrder::Rggb, BitDepth::Bits12, &mut space.half_memory, line);
    over(filter, input, &mut space.pixels, clock)?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

/// Samples of 8 bits in `space.bytes`.
fn mosaic(space: &mut Workspace) -> Result<(), Error> {
    let lines = space.picture.chunks_exact(WIDTH).zip(space.bytes.chunks_exact_mut(WIDTH));
    for (y, (pixels, samples)) in lines.enumerate() {
        mosaic_line(pixels, samples, BayerOrder::Rggb, y)?;
    }
    Ok(())
}

fn make_gamma(_: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    clock.start();
    let curve = Curve::gamma(2200)?;
    clock.stop();
    Ok(Done::new(1, curve.table()))
}

fn make_srgb(_: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    clock.start();
    let (linear, back) = (Curve::srgb_to_linear(), Curve::linear_to_srgb());
    clock.stop();
    Ok(Done::of(2, |results| {
        results.bytes(linear.table());
        results.bytes(back.table());
    }))
}

fn make_through(_: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    clock.start();
    let curve = Curve::through(&[(0, 0), (64, 40), (128, 150), (255, 255)])?;
    clock.stop();
    Ok(Done::new(1, curve.table()))
}

fn curve_gray(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let filter = Pointwise::new(Curve::gamma(2200)?, &mut space.byte_line[..WIDTH]);
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

/// A map of pixels over the picture, a line at a time.
fn pointwise(space: &mut Workspace, clock: &mut dyn Clock, map: impl PixelMap<Rgb>) -> Result<Done, Error> {
    let filter = Pointwise::new(map, &mut space.line[..WIDTH]);
    over(filter, view(&space.picture)?, &mut space.pixels, clock)?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn curve_rgb(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    pointwise(space, clock, Curve::linear_to_srgb())
}

fn histogram(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let mut histogram = Histogram::new();
    clock.start();
    space.gray.chunks_exact(WIDTH).for_each(|line| histogram.push(line));
    clock.stop();
    Ok(Done::of(PIXELS, |results| {
        results.numbers(histogram.bins().iter().map(|&bin| i64::from(bin)));
        results.numbers(histogram.quantile(9, 10).map(i64::from));
        results.numbers(histogram.mean_q8().map(i64::from));
    }))
}

fn white(units: usize, white: Option<White>) -> Done {
    let levels = white.map_or([-1; 3], |white| [white.r, white.g, white.b].map(i64::from));
    Done::of(units, |results| results.numbers(levels))
}

fn gray_world(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let mut world = GrayWorld::new();
    clock.start();
    space.picture.chunks_exact(WIDTH).for_each(|line| world.push(line));
    let found = world.finish();
    clock.stop();
    Ok(white(PIXELS, found))
}

fn white_patch(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let mut patch = WhitePatch::new(10)?;
    clock.start();
    space.picture.chunks_exact(WIDTH).for_each(|line| patch.push(line));
    let found = patch.finish();
    clock.stop();
    Ok(white(PIXELS, found))
}

fn gray_edge_l1(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    gray_edge(space, clock, Norm::L1)
}

fn gray_edge_l2(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    gray_edge(space, clock, Norm::L2)
}

fn gray_edge(space: &mut Workspace, clock: &mut dyn Clock, norm: Norm) -> Result<Done, Error> {
    let mut edge = GrayEdge::new(norm, &mut space.line[..WIDTH])?;
    clock.start();
    for line in space.picture.chunks_exact(WIDTH) {
        edge.push(line)?;
    }
    let found = edge.finish();
    clock.stop();
    Ok(white(PIXELS, found))
}

fn running(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    const CALLS: usize = 64;
    let mut running = RunningWhite::new(32, 20)?;
    clock.start();
    for pixel in &space.picture[..CALLS] {
        running.update(White::of(*pixel));
    }
    clock.stop();
    Ok(white(CALLS, running.white()))
}

fn gains(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let white = estimate(view(&space.picture)?);
    pointwise(space, clock, Gains::neutralizing(white)?)
}

/// Estimate and correction, as two passes over a frame.
fn balance(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    space.pixels.copy_from_slice(&space.picture);
    clock.start();
    let gains = Gains::neutralizing(estimate(view(&space.pixels)?))?;
    space.pixels.chunks_exact_mut(WIDTH).for_each(|line| gains.apply_line(line));
    clock.stop();
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn matrix(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let rows = [[17_000, -5_000, -2_000], [-2_500, 15_000, -2_500], [-500, -5_500, 16_000]];
    pointwise(space, clock, Matrix3::from_ten_thousandths(rows)?)
}

fn adaptation(_: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let (from, to) = (White { r: 40_000, g: 36_000, b: 28_000 }, White { r: 33_000, g: 33_000, b: 33_000 });
    let mut made = [Matrix3::IDENTITY; Space::ALL.len()];
    clock.start();
    for (matrix, space) in made.iter_mut().zip(Space::ALL) {
        *matrix = in_rgb(space, from, to)?;
    }
    clock.stop();
    let coefficients = made.iter().flat_map(|matrix| matrix.to_q12()).flatten();
    Ok(Done::of(made.len(), |results| results.numbers(coefficients.map(i64::from))))
}
