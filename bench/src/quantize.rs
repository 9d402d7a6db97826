//! Palettes and indices: ours by the recipes of [`algos_nostd::quantize`], and quantette's.

use crate::stopwatch::Stopwatch;
use crate::{HEIGHT, WIDTH, rgb_pixels};
use algos_nostd::image::{Error, Image, ImageMut, Rgb};
use algos_nostd::lines::{LineFilter, run};
use algos_nostd::quantize::{
    ApplyPalette, Bin, Cell, Cluster, Cuboid, ExactMap, FloydSteinberg, Group, Histogram, InverseMap, KMeans,
    Moment, Nearest, Probe, WeightedColor, Wu,
};
use anyhow::Result;
use quantette::color_map::IndexedColorMap;
use quantette::deps::palette::Srgb;
use quantette::wu::{BinnerU8x3, WuU8x3};
use quantette::{ImageBuf, PaletteSize, Pipeline, QuantizeMethod};
use std::hint::black_box;

/// Iterations of k-means where quality counts.
const ITERATIONS: usize = 5;

/// All memory that is lent, kept from frame to frame as a firmware would.
struct Memory {
    bins: Vec<Bin>,
    list: Vec<WeightedColor>,
    moments: Vec<Moment>,
    cuboids: Vec<Cuboid>,
    clusters: Vec<Cluster>,
    probes: Vec<Probe>,
    table: Vec<u32>,
    cells: Vec<Cell>,
    groups: Vec<Group>,
    line: Vec<u8>,
    errors: Vec<[i16; 3]>,
    indices: Vec<u8>,
}

impl Memory {
    fn new() -> Self {
        Self {
            bins: vec![Bin::EMPTY; Histogram::<6>::bins()],
            list: vec![WeightedColor::EMPTY; Histogram::<6>::bins()],
            moments: vec![Moment::EMPTY; Wu::<5>::moments()],
            cuboids: vec![Cuboid::EMPTY; 256],
            clusters: vec![Cluster::EMPTY; 256],
            probes: vec![Probe::EMPTY; 256],
            table: vec![0; InverseMap::<5>::cells()],
            cells: vec![Cell::EMPTY; ExactMap::<5>::cells()],
            groups: vec![Group::EMPTY; 4096],
            line: vec![0; WIDTH],
            errors: vec![[0; 3]; WIDTH],
            indices: vec![0; WIDTH * HEIGHT],
        }
    }

    /// Histogram, Wu and iterations of k-means.
    fn palette<const BITS: u32>(
        &mut self,
        pixels: &[Rgb],
        colors: usize,
        iterations: usize,
    ) -> Result<Vec<Rgb>, Error> {
        let mut histogram = Histogram::<BITS>::new(&mut self.bins)?;
        for line in Image::new(pixels, WIDTH, HEIGHT)?.rows() {
            histogram.add(line)?;
        }
        let list = histogram.weighted_colors(&mut self.list)?;
        let mut palette = vec![Rgb::default(); colors];
        let made = Wu::<5>::new(&mut self.moments, &mut self.cuboids)?.palette(list, &mut palette)?;
        palette.truncate(made);
        if iterations > 0 {
            let mut kmeans = KMeans::new(&mut self.clusters, &mut self.probes);
            kmeans.refine(list, &mut palette, iterations)?;
        }
        Ok(palette)
    }

    fn fast(&mut self, pixels: &[Rgb]) -> Result<Vec<Rgb>, Error> {
        let palette = self.palette::<5>(pixels, 16, 0)?;
        let map = InverseMap::<5>::new(Nearest::new(&palette, &mut self.probes)?, &mut self.table)?;
        apply(pixels, ApplyPalette::new(WIDTH, map, &mut self.line)?, &mut self.indices)?;
        Ok(palette)
    }

    fn quality(&mut self, pixels: &[Rgb], colors: usize) -> Result<Vec<Rgb>, Error> {
        let palette = self.palette::<6>(pixels, colors, ITERATIONS)?;
        let map = ExactMap::<5>::new(&palette, &mut self.cells, &mut self.groups)?;
        apply(pixels, ApplyPalette::new(WIDTH, map, &mut self.line)?, &mut self.indices)?;
        Ok(palette)
    }

    fn diffuse(&mut self, pixels: &[Rgb], palette: &[Rgb]) -> Result<(), Error> {
        let map = InverseMap::<5>::new(Nearest::new(palette, &mut self.probes)?, &mut self.table)?;
        let filter = FloydSteinberg::new(WIDTH, map, &mut self.line, &mut self.errors)?;
        apply(pixels, filter, &mut self.indices)
    }
}

fn apply(
    pixels: &[Rgb],
    mut filter: impl LineFilter<Input = Rgb, Output = u8>,
    indices: &mut [u8],
) -> Result<(), Error> {
    let input = Image::new(black_box(pixels), WIDTH, HEIGHT)?;
    run(&mut filter, input, &mut ImageMut::new(indices, WIDTH, HEIGHT)?)
}

/// Colours of the palette in 16 bits, the colours, the indices.
fn written(palette: impl ExactSizeIterator<Item = [u8; 3]>, indices: &[u8]) -> Vec<u8> {
    let mut bytes = (palette.len() as u16).to_le_bytes().to_vec();
    bytes.extend(palette.flatten());
    bytes.extend(indices);
    bytes
}

/// 16 colours by Wu, pixels by a table: palette and indices.
pub(crate) fn fast(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    both(bytes, stopwatch, Memory::fast)
}

/// By Wu and k-means, pixels to the nearest: palette and indices.
pub(crate) fn quality<const COLORS: usize>(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    both(bytes, stopwatch, |memory, pixels| memory.quality(pixels, COLORS))
}

fn both(
    bytes: &[u8],
    stopwatch: &mut Stopwatch,
    mut quantize: impl FnMut(&mut Memory, &[Rgb]) -> Result<Vec<Rgb>, Error>,
) -> Result<Vec<u8>> {
    let (pixels, mut memory) = (rgb_pixels(bytes)?, Memory::new());
    let mut palette = Ok(Vec::new());
    stopwatch.time(|| palette = quantize(&mut memory, pixels));
    Ok(written(palette?.iter().map(|color| [color.r, color.g, color.b]), &memory.indices))
}

/// Dithering to a palette that is ready when the clock starts: the fast one.
pub(crate) fn floyd_steinberg<const COLORS: usize>(
    bytes: &[u8],
    stopwatch: &mut Stopwatch,
) -> Result<Vec<u8>> {
    let (pixels, mut memory) = (rgb_pixels(bytes)?, Memory::new());
    let palette = memory.palette::<5>(pixels, COLORS, 0)?;
    let mut done = Ok(());
    stopwatch.time(|| done = done.and(memory.diffuse(pixels, &palette)));
    done?;
    Ok(written(palette.iter().map(|color| [color.r, color.g, color.b]), &memory.indices))
}

/// quantette's Wu in 8-bit sRGB with its own table: palette and indices.
pub(crate) fn quantette_wu(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let pixels = srgb(bytes)?;
    let mut made = Ok((Vec::new(), Vec::new()));
    stopwatch.time(|| {
        made = WuU8x3::run_slice(black_box(&pixels), BinnerU8x3::rgb()).map(|wu| {
            let map = wu.color_map(PaletteSize::from_u8_clamped(16));
            let indices = map.map_to_indices(&pixels);
            (map.into_palette().into_vec(), indices)
        });
    });
    let (palette, indices) = made?;
    Ok(written(palette.iter().map(|color| [color.red, color.green, color.blue]), &indices))
}

/// quantette's Wu as its front door has it, in Oklab: palette and indices.
pub(crate) fn quantette_pipeline(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let pixels = srgb(bytes)?;
    let image = ImageBuf::new(WIDTH as u32, HEIGHT as u32, pixels)?;
    let pipeline = Pipeline::new()
        .palette_size(PaletteSize::from_u8_clamped(16))
        .quantize_method(QuantizeMethod::Wu)
        .ditherer(None);
    let mut made = (Vec::new(), Vec::new());
    stopwatch.time(|| {
        let input = pipeline.clone().input_image(black_box(image.as_ref()));
        made = input.output_srgb8_indexed_image().into_parts();
    });
    Ok(written(made.0.iter().map(|color| [color.red, color.green, color.blue]), &made.1))
}

fn srgb(bytes: &[u8]) -> Result<Vec<Srgb<u8>>> {
    Ok(rgb_pixels(bytes)?.iter().map(|pixel| Srgb::new(pixel.r, pixel.g, pixel.b)).collect())
}
