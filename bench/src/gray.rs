//! Gray pictures: filters, gradients, edges.

use crate::stopwatch::Stopwatch;
use crate::{HEIGHT, WIDTH, gray_pixels};
use algos_nostd::edges::gradient::Sobel;
use algos_nostd::edges::measure::L1;
use algos_nostd::edges::{self, BitMapMut, CannyConfig, GradientFilter};
use algos_nostd::filter::{Bilateral, Gaussian5, Median3, Neighbourhood, RowKernel, Unsharp};
use algos_nostd::image::{Image, ImageMut};
use algos_nostd::lines::run;
use anyhow::Result;
use std::hint::black_box;

/// The 5 × 5 kernel for σ = 1.4.
pub(crate) fn gaussian(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    filter(bytes, stopwatch, Gaussian5)
}

/// 3 × 3.
pub(crate) fn median(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    filter(bytes, stopwatch, Median3)
}

/// Diameter 5, σ 2 pixels and 25 levels.
pub(crate) fn bilateral(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let mut table = vec![0; Bilateral::<5>::table()];
    filter(bytes, stopwatch, Bilateral::<5>::new(2000, 25_000, &mut table)?)
}

/// All of the difference from a Gaussian of 5 × 5 with σ = 1.4.
pub(crate) fn unsharp(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    filter(bytes, stopwatch, Unsharp::<5>::new(100, 1400, 0)?)
}

fn filter<K: RowKernel<N>, const N: usize>(
    bytes: &[u8],
    stopwatch: &mut Stopwatch,
    kernel: K,
) -> Result<Vec<u8>> {
    let input = Image::new(gray_pixels(bytes)?, WIDTH, HEIGHT)?;
    let mut made = vec![0; WIDTH * HEIGHT];
    let mut memory = vec![0; Neighbourhood::<K, N>::memory(WIDTH)];
    let mut filter = Neighbourhood::new(kernel, WIDTH, &mut memory)?;
    let mut output = ImageMut::new(&mut made, WIDTH, HEIGHT)?;
    let mut done = Ok(());
    stopwatch.time(|| done = done.and(run(&mut filter, black_box(input), &mut output)));
    done?;
    Ok(made)
}

/// |x| + |y| in 16 bits.
pub(crate) fn sobel(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let input = Image::new(gray_pixels(bytes)?, WIDTH, HEIGHT)?;
    let mut made = vec![0u16; WIDTH * HEIGHT];
    let mut memory = vec![0; GradientFilter::<Sobel, L1>::memory(WIDTH)];
    let mut line = vec![0; WIDTH];
    let mut filter = GradientFilter::<Sobel, L1>::new(WIDTH, &mut memory, &mut line)?;
    let mut output = ImageMut::new(&mut made, WIDTH, HEIGHT)?;
    let mut done = Ok(());
    stopwatch.time(|| done = done.and(run(&mut filter, black_box(input), &mut output)));
    done?;
    Ok(made.iter().flat_map(|magnitude| magnitude.to_le_bytes()).collect())
}

/// Gaussian 5 × 5, L2, 50 and 150; one bit a pixel, written as bytes of 0 and 255.
pub(crate) fn canny(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let input = Image::new(gray_pixels(bytes)?, WIDTH, HEIGHT)?;
    let config = CannyConfig::default();
    let mut memory = vec![0; edges::canny_memory(WIDTH, HEIGHT, config.smoothing)];
    let mut words = vec![0; edges::words_a_map(WIDTH, HEIGHT)];
    let mut map = BitMapMut::new(&mut words, WIDTH, HEIGHT)?;
    let mut done = Ok(());
    stopwatch.time(|| done = done.and(edges::canny(black_box(input), &config, &mut memory, &mut map)));
    done?;
    let mut made = vec![0; WIDTH * HEIGHT];
    for (words, bytes) in words.chunks(edges::words_a_line(WIDTH)).zip(made.chunks_mut(WIDTH)) {
        edges::unpack(words, bytes);
    }
    Ok(made)
}
