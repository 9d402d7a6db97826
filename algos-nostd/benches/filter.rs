//! Filters over a VGA frame of gray: `cargo bench -p algos-nostd --features std --bench filter`.
//!
//! The picture is synthesised; `CAMIF_BENCH_GRAY` may name a file of 640 × 480 bytes instead, such as a photograph.

#![allow(missing_docs, reason = "criterion's macro makes public functions")]

use algos_nostd::filter::{
    Bilateral, Channels, Convolution, Gaussian, Gaussian3, Gaussian5, Mask, Mean, Median3, Median3Filter,
    Median5, Morphology, Neighbourhood, Operation, RowKernel, Separable, Unsharp,
};
use algos_nostd::image::{Image, ImageMut, Rgb};
use algos_nostd::lines::run;
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Gradients with edges across them and noise on top: something to do for every branch, were there any.
fn picture() -> Vec<u8> {
    if let Some(path) = std::env::var_os("CAMIF_BENCH_GRAY") {
        let pixels = std::fs::read(&path).expect("a readable file of raw gray pixels");
        assert_eq!(pixels.len(), WIDTH * HEIGHT, "a file of 640 × 480 bytes");
        return pixels;
    }
    let mut state = 1u32;
    let pixel = |index: usize| {
        let (x, y) = (index % WIDTH, index / WIDTH);
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let edge = if (x / 40 + y / 40) % 2 == 0 { 64 } else { 0 };
        ((x + y) / 8 + edge + (state >> 28) as usize) as u8
    };
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

fn over_gray<K: RowKernel<N>, const N: usize>(criterion: &mut Criterion, name: &str, kernel: K) {
    let (pixels, mut made) = (picture(), vec![0; WIDTH * HEIGHT]);
    let mut memory = vec![0; Neighbourhood::<K, N>::memory(WIDTH)];
    let mut filter = Neighbourhood::new(kernel, WIDTH, &mut memory).expect("a fitting kernel");
    criterion.bench_function(name, |bencher| {
        bencher.iter(|| {
            let input = Image::new(black_box(&pixels), WIDTH, HEIGHT).expect("a frame");
            let mut output = ImageMut::new(&mut made, WIDTH, HEIGHT).expect("a frame");
            run(&mut filter, input, &mut output).expect("frames of one size");
        });
    });
}

fn over_colour(criterion: &mut Criterion) {
    let pixels: Vec<Rgb> = picture().iter().map(|&gray| Rgb::new(gray, gray / 2, 255 - gray)).collect();
    let mut made = vec![Rgb::default(); WIDTH * HEIGHT];
    let mut memory = vec![[0; Median3Filter::memory(WIDTH)]; 3];
    let mut lines = vec![Rgb::default(); Channels::<Median3Filter>::memory(WIDTH)];
    let [red, green, blue] = &mut memory[..] else { unreachable!("three were made") };
    let filters =
        [red, green, blue].map(|memory| Neighbourhood::new(Median3, WIDTH, memory).expect("enough memory"));
    let mut filter = Channels::new(filters, WIDTH, &mut lines).expect("enough memory");
    criterion.bench_function("median 3 × 3 of RGB", |bencher| {
        bencher.iter(|| {
            let input = Image::new(black_box(&pixels), WIDTH, HEIGHT).expect("a frame");
            let mut output = ImageMut::new(&mut made, WIDTH, HEIGHT).expect("a frame");
            run(&mut filter, input, &mut output).expect("frames of one size");
        });
    });
}

fn filters(criterion: &mut Criterion) {
    over_gray(criterion, "gaussian 3 × 3", Gaussian3);
    over_gray(criterion, "gaussian 5 × 5 σ 1.4", Gaussian5);
    over_gray(criterion, "gaussian 7 × 7", Gaussian::SEVEN);
    over_gray(criterion, "gaussian 15 × 15 σ 2.5", Gaussian::<15>::new(2500).expect("a σ in range"));
    let mut columns = vec![0; Mean::<15>::columns(WIDTH)];
    over_gray(criterion, "box 15 × 15", Mean::<15>::new(WIDTH, &mut columns).expect("enough columns"));
    over_gray(
        criterion,
        "convolution 3 × 3",
        Convolution::new([[1, 2, 1]; 3], 12, 0).expect("small weights"),
    );
    over_gray(
        criterion,
        "separable 5 × 5",
        Separable::new([1, 4, 6, 4, 1], [1, 4, 6, 4, 1], 256, 0).expect("small weights"),
    );
    over_gray(criterion, "median 3 × 3", Median3);
    over_gray(criterion, "median 5 × 5", Median5);
    let mut table = vec![0; Bilateral::<5>::table()];
    over_gray(
        criterion,
        "bilateral d = 5",
        Bilateral::<5>::new(2000, 25_000, &mut table).expect("σ in range"),
    );
    let erosion = Morphology::<3, 3>::new(Operation::Erode, Mask::Rectangle).expect("odd sides");
    over_gray(criterion, "erosion 3 × 3", erosion);
    let erosion = Morphology::<15, 15>::new(Operation::Erode, Mask::Rectangle).expect("odd sides");
    over_gray(criterion, "erosion 15 × 15", erosion);
    over_gray(criterion, "unsharp 5 × 5", Unsharp::<5>::new(150, 1400, 3).expect("parameters in range"));
    over_colour(criterion);
}

criterion_group!(benches, filters);
criterion_main!(benches);
