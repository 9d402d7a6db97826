//! Colour at VGA: `cargo bench -p algos-nostd --features std --bench color`.
//!
//! The picture is made up, unless `CAMIF_BENCH_RGB` names a file of 640 × 480 raw RGB.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use algos_nostd::color::balance::matrix::Matrix3;
use algos_nostd::color::balance::{Gains, gray_world};
use algos_nostd::color::demosaic::bilinear::Bilinear;
use algos_nostd::color::demosaic::malvar::{self, Malvar};
use algos_nostd::color::pointwise::PixelMap;
use algos_nostd::image::{Image, ImageMut, Rgb};
use algos_nostd::lines::run;
use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::{BitDepth, gray8, rgb888};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Slopes of colour under a grain of noise.
fn picture() -> Vec<Rgb> {
    if let Ok(path) = std::env::var("CAMIF_BENCH_RGB") {
        let bytes = std::fs::read(&path).expect("CAMIF_BENCH_RGB names a readable file");
        let pixels = rgb888::as_pixels(&bytes).to_vec();
        assert_eq!(pixels.len(), WIDTH * HEIGHT, "{path} holds 640 × 480 pixels of raw RGB");
        return pixels;
    }
    let mut noise = 1u32;
    (0..WIDTH * HEIGHT)
        .map(|at| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let grain = (noise >> 28) as usize;
            let (x, y) = (at % WIDTH, at / WIDTH);
            Rgb::new((x * 220 / WIDTH + grain) as u8, (y * 240 / HEIGHT + grain) as u8, ((x ^ y) & 127) as u8)
        })
        .collect()
}

fn color(criterion: &mut Criterion) {
    let source = picture();
    let mut pixels = source.clone();
    let mut vga = criterion.benchmark_group("vga");

    vga.bench_function("gray-world estimate and apply", |bencher| {
        bencher.iter(|| {
            let white = gray_world::estimate(Image::new(black_box(&source), WIDTH, HEIGHT).unwrap());
            let gains = Gains::neutralizing(white).unwrap();
            gains.apply_line(black_box(&mut pixels));
        });
    });

    let usual = [[17_000, -5_000, -2_000], [-2_500, 15_000, -2_500], [-500, -5_500, 16_000]];
    let strong = [[24_000, -9_000, -5_000], [-6_000, 23_000, -7_000], [1_000, -12_000, 21_000]];
    for (name, rows) in [("matrix 3x3", usual), ("matrix 3x3, large coefficients", strong)] {
        let matrix = Matrix3::from_ten_thousandths(rows).unwrap();
        vga.bench_function(name, |bencher| bencher.iter(|| matrix.apply_line(black_box(&mut pixels))));
        vga.bench_function(format!("{name}, line by line"), |bencher| {
            bencher.iter(|| {
                let mut image = ImageMut::new(black_box(&mut pixels), WIDTH, HEIGHT).unwrap();
                image.rows_mut().for_each(|row| matrix.apply_line(row));
            });
        });
    }

    let mut gray = vec![0; WIDTH * HEIGHT];
    vga.bench_function("gray", |bencher| {
        bencher.iter(|| gray8::encode_line(black_box(&source), black_box(&mut gray)).unwrap());
    });

    let (mut line, mut window) = (vec![Rgb::default(); WIDTH], vec![0; malvar::window(WIDTH)]);
    let mosaic = Image::new(&gray, WIDTH, HEIGHT).unwrap();
    vga.bench_function("demosaic, bilinear", |bencher| {
        let mut filter = Bilinear::new(BayerOrder::Rggb, BitDepth::Bits8, &mut window, &mut line).unwrap();
        bencher.iter(|| {
            let mut out = ImageMut::new(&mut pixels, WIDTH, HEIGHT).unwrap();
            run(&mut filter, black_box(mosaic), &mut out).unwrap();
        });
    });
    vga.bench_function("demosaic, Malvar–He–Cutler", |bencher| {
        let mut filter = Malvar::new(BayerOrder::Rggb, BitDepth::Bits8, &mut window, &mut line).unwrap();
        bencher.iter(|| {
            let mut out = ImageMut::new(&mut pixels, WIDTH, HEIGHT).unwrap();
            run(&mut filter, black_box(mosaic), &mut out).unwrap();
        });
    });
    vga.finish();
}

criterion_group!(benches, color);
criterion_main!(benches);
