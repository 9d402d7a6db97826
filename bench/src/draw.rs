//! Lines, clips and fills on a gray frame, ours and the peers'. Colours alternate, so that a repetition finds work.

use crate::stopwatch::Stopwatch;
use crate::{HEIGHT, WIDTH};
use algos_nostd::clip::{Walk, clip_line, clip_lines};
use algos_nostd::draw::{PendingRun, Point, Window, draw_line, flood_fill as fill};
use algos_nostd::image::ImageMut;
use anyhow::{Context, Result};
use clipline::Clip;
use image::{GrayImage, Luma};
use std::collections::HashSet;
use std::hint::black_box;

const DRAWN: usize = 10_000;
const CLIPPED: usize = 100_000;
const MIDDLE: (u16, u16) = (WIDTH as u16 / 2, HEIGHT as u16 / 2);

/// Segments with ends anywhere in a rectangle `scan` times the frame's size about its middle; the same each time.
fn segments(count: usize, scan: i32) -> Vec<(Point, Point)> {
    let mut state = 42u64;
    let mut below = |limit: i32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % limit as u64) as i32
    };
    let mut coordinate = |size: usize| (below(size as i32 * scan) - (scan - 1) * size as i32 / 2) as i16;
    let mut point = || Point::new(coordinate(WIDTH), coordinate(HEIGHT));
    (0..count).map(|_| (point(), point())).collect()
}

fn frame() -> Vec<u8> {
    vec![0; WIDTH * HEIGHT]
}

fn clip() -> Result<Clip<i16>> {
    Clip::<i16>::from_size(WIDTH as u16, HEIGHT as u16).context("a clip of the frame's size")
}

/// 10,000 lines.
pub(crate) fn lines<const SCAN: i32>(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let (segments, mut pixels, mut color) = (segments(DRAWN, SCAN), frame(), 0);
    let mut image = ImageMut::new(&mut pixels, WIDTH, HEIGHT)?;
    stopwatch.time(|| {
        color ^= 255;
        for &(from, to) in black_box(&segments) {
            draw_line(&mut image, from, to, color);
        }
    });
    Ok(pixels)
}

/// The same, clipped by clipline and plotted as its documentation does it. The result is their [`agreement`].
pub(crate) fn clipline_lines<const SCAN: i32>(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let (segments, mut pixels, mut color) = (segments(DRAWN, SCAN), frame(), 0);
    let clip = clip()?;
    stopwatch.time(|| {
        color ^= 255;
        for &(from, to) in black_box(&segments) {
            let line = clip.line_b_proj(from.x, from.y, to.x, to.y).into_iter().flatten();
            line.for_each(|(x, y)| plot(&mut pixels, x, y, color));
        }
        black_box(&mut pixels);
    });
    let window = Window::of_mut(&ImageMut::new(&mut pixels, WIDTH, HEIGHT)?);
    Ok(agreement(&segments, &window, &clip))
}

#[allow(unsafe_code, reason = "the peer's own recipe for plotting, and its fastest: the clip is the proof")]
fn plot(pixels: &mut [u8], x: u16, y: u16, color: u8) {
    let at = usize::from(y) * WIDTH + usize::from(x);
    debug_assert!(at < pixels.len());
    // SAFETY: the line was clipped to the frame's width and height.
    unsafe { *pixels.get_unchecked_mut(at) = color };
}

/// How many lines are the same in both, how many differ only where the true line lies half way between two pixels, and
/// how many differ otherwise; 32 bits each. A line's last pixel does not count, since clipline leaves it out.
fn agreement(segments: &[(Point, Point)], window: &Window, clip: &Clip<i16>) -> Vec<u8> {
    let mut counts = [0u32; 3];
    for &(from, to) in segments {
        let ours: HashSet<_> =
            clip_line(from, to, window).into_iter().flatten().filter(|&at| at != to).collect();
        let theirs = clip.line_b_proj(from.x, from.y, to.x, to.y).into_iter().flatten();
        let theirs: HashSet<_> = theirs.map(|(x, y)| Point::new(x as i16, y as i16)).collect();
        let half_way = |&at: &Point| is_half_way(from, to, at);
        let class = match &ours ^ &theirs {
            differing if differing.is_empty() => 0,
            differing if differing.iter().all(half_way) => 1,
            _ => 2,
        };
        counts[class] += 1;
    }
    counts.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// Whether a line passes just half way between a pixel and the next one across.
fn is_half_way(from: Point, to: Point, at: Point) -> bool {
    let offset = |at: Point| [i32::from(at.x) - i32::from(from.x), i32::from(at.y) - i32::from(from.y)];
    let (whole, at) = (offset(to), offset(at));
    let major = usize::from(whole[1].abs() > whole[0].abs());
    // Off by half a pixel: |at − line| = 1/2, times twice the longer side.
    (2 * at[1 - major] * whole[major] - 2 * at[major] * whole[1 - major]).abs() == whole[major].abs()
}

/// 100,000 clips, many at once.
pub(crate) fn clips(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let segments = segments(CLIPPED, 3);
    let window = Window::of_mut(&ImageMut::new(&mut frame(), WIDTH, HEIGHT)?);
    let mut seen = 0u32;
    stopwatch.time(|| {
        seen = 0;
        clip_lines(black_box(&segments), &window, |_, walk| {
            black_box::<&Walk>(&walk);
            seen += 1;
        });
    });
    Ok(seen.to_le_bytes().to_vec())
}

/// The same, one after the other.
pub(crate) fn clips_one_by_one(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let segments = segments(CLIPPED, 3);
    let window = Window::of_mut(&ImageMut::new(&mut frame(), WIDTH, HEIGHT)?);
    let mut seen = 0u32;
    stopwatch.time(|| {
        let walks = black_box(&segments).iter().filter_map(|&(from, to)| clip_line(from, to, &window));
        seen = walks.inspect(|walk| _ = black_box(walk)).count() as u32;
    });
    Ok(seen.to_le_bytes().to_vec())
}

/// The same by clipline.
pub(crate) fn clipline_clips(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let (segments, clip) = (segments(CLIPPED, 3), clip()?);
    let mut seen = 0u32;
    stopwatch.time(|| {
        let lines = black_box(&segments)
            .iter()
            .filter_map(|&(from, to)| clip.line_b_proj(from.x, from.y, to.x, to.y));
        seen = lines.inspect(|line| _ = black_box(line)).count() as u32;
    });
    Ok(seen.to_le_bytes().to_vec())
}

/// A frame of one colour, from its middle, by spans.
pub(crate) fn flood_fill(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let (mut pixels, mut color) = (frame(), 0);
    let mut pending = [PendingRun::default(); 64];
    let seed = Point::new(MIDDLE.0 as i16, MIDDLE.1 as i16);
    let mut image = ImageMut::new(&mut pixels, WIDTH, HEIGHT)?;
    stopwatch.time(|| {
        color ^= 255;
        black_box(fill(&mut image, seed, color, &mut pending));
    });
    Ok(pixels)
}

/// The same by imageproc.
pub(crate) fn imageproc_flood_fill(_: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let (mut image, mut color) = (GrayImage::new(WIDTH as u32, HEIGHT as u32), 0);
    stopwatch.time(|| {
        color ^= 255;
        imageproc::drawing::flood_fill_mut(&mut image, MIDDLE.0.into(), MIDDLE.1.into(), Luma([color]));
        black_box(&mut image);
    });
    Ok(image.into_raw())
}
