//! Quantization of a 640 × 480 picture: `cargo bench -p algos-nostd --features std --bench quantize`.
//!
//! The picture is made here, unless `CAMIF_PHOTO` names a file of 640 × 480 raw RGB; its path says nothing about its
//! quality, so peak signal-to-noise ratios are printed besides the times.

use std::hint::black_box;

use algos_nostd::image::{Image, ImageMut, Rgb};
use algos_nostd::lines::{LineFilter, run};
use algos_nostd::quantize::{
    Annealing, ApplyPalette, BLUE_NOISE, Bin, Cell, Cluster, ColorIndex, Cuboid, ExactMap, FloydSteinberg,
    Group, Histogram, InverseMap, KMeans, Learning, Moment, Nearest, Neuron, Node, Octree, Ordered, Probe,
    Span, WeightedColor, Wu, local_kmeans, median_cut, neuquant, popularity, spatial,
};
use criterion::{Criterion, criterion_group, criterion_main};

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Smooth shading, edges and fine noise: about as many colours as a photograph has.
fn synthesised() -> Vec<Rgb> {
    let mut random = 1u32;
    let pixel = |at: usize| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y, noise) = (at % WIDTH, at / WIDTH, (random >> 28) as usize);
        let disc = (x.abs_diff(300).pow(2) + y.abs_diff(200).pow(2)) / 500;
        let level = match (disc, x / 40 + y / 60) {
            (0..160, _) => [220 - disc + noise, 60 + disc / 2 + noise, 30 + x / 8 + noise],
            (_, tile) if tile % 3 == 0 => [40 + y / 4 + noise, 70 + x / 8 + noise, 100 + tile * 4 + noise],
            (_, tile) => [x / 4 + noise, 200 - y / 4 + noise, 20 + tile * 8 + noise],
        };
        let [r, g, b] = level.map(|level| level.min(255) as u8);
        Rgb { r, g, b }
    };
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

fn picture() -> Vec<Rgb> {
    let Some(path) = std::env::var_os("CAMIF_PHOTO") else { return synthesised() };
    let bytes = std::fs::read(path).expect("CAMIF_PHOTO names a readable file");
    assert_eq!(bytes.len(), WIDTH * HEIGHT * 3, "CAMIF_PHOTO holds 640 × 480 raw RGB");
    bytes.chunks_exact(3).map(|level| Rgb { r: level[0], g: level[1], b: level[2] }).collect()
}

/// Peak signal-to-noise ratio in decibels.
fn ratio(pixels: &[Rgb], palette: &[Rgb], indices: &[u8]) -> f64 {
    let square = |a: u8, b: u8| f64::from(a.abs_diff(b)).powi(2);
    let error = |(pixel, index): (&Rgb, &u8)| {
        let color = palette[usize::from(*index)];
        square(pixel.r, color.r) + square(pixel.g, color.g) + square(pixel.b, color.b)
    };
    let mean = pixels.iter().zip(indices).map(error).sum::<f64>() / (3 * pixels.len()) as f64;
    10.0 * (255.0 * 255.0 / mean).log10()
}

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
    pixels: Vec<Rgb>,
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
            pixels: vec![Rgb::default(); WIDTH],
            errors: vec![[0; 3]; WIDTH],
            indices: vec![0; WIDTH * HEIGHT],
        }
    }

    fn view(pixels: &[Rgb]) -> Image<'_, Rgb> {
        Image::new(pixels, WIDTH, HEIGHT).unwrap()
    }

    fn count<const BITS: u32>(&mut self, pixels: &[Rgb]) -> usize {
        let mut histogram = Histogram::<BITS>::new(&mut self.bins).unwrap();
        Self::view(pixels).rows().for_each(|line| histogram.add(line).unwrap());
        histogram.weighted_colors(&mut self.list).unwrap().len()
    }

    /// Histogram, Wu and some iterations of k-means.
    fn palette<const BITS: u32>(&mut self, pixels: &[Rgb], colors: usize, iterations: usize) -> Vec<Rgb> {
        let length = self.count::<BITS>(pixels);
        let list = &self.list[..length];
        let mut palette = vec![Rgb::default(); colors];
        let mut wu = Wu::<5>::new(&mut self.moments, &mut self.cuboids).unwrap();
        let made = wu.palette(list, &mut palette).unwrap();
        palette.truncate(made);
        KMeans::new(&mut self.clusters, &mut self.probes).refine(list, &mut palette, iterations).unwrap();
        palette
    }

    fn fast(&mut self, pixels: &[Rgb], palette: &[Rgb]) {
        let nearest = Nearest::new(palette, &mut self.probes).unwrap();
        let map = InverseMap::<5>::new(nearest, &mut self.table).unwrap();
        apply(pixels, ApplyPalette::new(WIDTH, map, &mut self.line).unwrap(), &mut self.indices);
    }

    fn exact(&mut self, pixels: &[Rgb], palette: &[Rgb]) {
        let map = ExactMap::<5>::new(palette, &mut self.cells, &mut self.groups).unwrap();
        apply(pixels, ApplyPalette::new(WIDTH, map, &mut self.line).unwrap(), &mut self.indices);
    }

    fn diffuse(&mut self, pixels: &[Rgb], palette: &[Rgb]) {
        let nearest = Nearest::new(palette, &mut self.probes).unwrap();
        let map = InverseMap::<5>::new(nearest, &mut self.table).unwrap();
        let filter = FloydSteinberg::new(WIDTH, map, &mut self.line, &mut self.errors).unwrap();
        apply(pixels, filter, &mut self.indices);
    }

    fn ordered(&mut self, pixels: &[Rgb], palette: &[Rgb]) {
        let spread = Ordered::<InverseMap<'_, 5>>::spread_of(palette);
        let nearest = Nearest::new(palette, &mut self.probes).unwrap();
        let map = InverseMap::<5>::new(nearest, &mut self.table).unwrap();
        let filter = Ordered::new(WIDTH, BLUE_NOISE, spread, map, &mut self.pixels, &mut self.line).unwrap();
        apply(pixels, filter, &mut self.indices);
    }

    fn search(&mut self, pixels: &[Rgb], palette: &[Rgb]) {
        let nearest = Nearest::new(palette, &mut self.probes).unwrap();
        assert_eq!(nearest.palette().len(), palette.len());
        apply(pixels, ApplyPalette::new(WIDTH, nearest, &mut self.line).unwrap(), &mut self.indices);
    }
}

fn apply(pixels: &[Rgb], mut filter: impl LineFilter<Input = Rgb, Output = u8>, indices: &mut [u8]) {
    let output = &mut ImageMut::new(indices, WIDTH, HEIGHT).unwrap();
    run(&mut filter, Memory::view(black_box(pixels)), output).unwrap();
}

/// From pixels to indices, and the steps alone.
fn whole(criterion: &mut Criterion) {
    let (pixels, mut memory) = (picture(), Memory::new());
    let mut group = criterion.benchmark_group("quantize");
    for colors in [16, 256] {
        let palette = memory.palette::<5>(&pixels, colors, 0);
        memory.fast(&pixels, &palette);
        println!("{colors} colours, fast: {:.2} dB", ratio(&pixels, &palette, &memory.indices));
        group.bench_function(format!("fast/{colors}"), |bencher| {
            bencher.iter(|| {
                let palette = memory.palette::<5>(&pixels, colors, 0);
                memory.fast(&pixels, &palette);
            });
        });
        let palette = memory.palette::<6>(&pixels, colors, 5);
        memory.exact(&pixels, &palette);
        println!("{colors} colours, quality: {:.2} dB", ratio(&pixels, &palette, &memory.indices));
        group.bench_function(format!("quality/{colors}"), |bencher| {
            bencher.iter(|| {
                let palette = memory.palette::<6>(&pixels, colors, 5);
                memory.exact(&pixels, &palette);
            });
        });
        group.bench_function(format!("map/inverse/{colors}"), |b| b.iter(|| memory.fast(&pixels, &palette)));
        group.bench_function(format!("map/exact/{colors}"), |b| b.iter(|| memory.exact(&pixels, &palette)));
        group
            .bench_function(format!("map/nearest/{colors}"), |b| b.iter(|| memory.search(&pixels, &palette)));
        group.bench_function(format!("floyd-steinberg/{colors}"), |b| {
            b.iter(|| memory.diffuse(&pixels, &palette));
        });
        group.bench_function(format!("ordered/{colors}"), |b| b.iter(|| memory.ordered(&pixels, &palette)));
    }
    group.bench_function("histogram/5", |b| b.iter(|| memory.count::<5>(&pixels)));
}

/// The palette makers on the same weighted colours.
fn makers(criterion: &mut Criterion) {
    let (pixels, mut memory) = (picture(), Memory::new());
    let length = memory.count::<5>(&pixels);
    let list = memory.list[..length].to_vec();
    let mut group = criterion.benchmark_group("palette");
    let mut cumulative = vec![0; length];
    for colors in [16, 256] {
        let mut palette = memory.palette::<5>(&pixels, colors, 0);
        let start = palette.clone();
        let report = |name: &str, palette: &[Rgb]| {
            let mut memory = Memory::new();
            memory.exact(&pixels, palette);
            println!("{name}/{colors}: {:.2} dB", ratio(&pixels, palette, &memory.indices));
        };
        let mut scratch = list.clone();
        group.bench_function(format!("popularity/{colors}"), |bencher| {
            bencher.iter(|| popularity(black_box(&mut scratch), &mut palette).unwrap());
        });
        report("popularity", &palette);
        let mut spans = vec![Span::EMPTY; colors];
        group.bench_function(format!("median-cut/{colors}"), |bencher| {
            bencher.iter(|| median_cut(black_box(&mut scratch), &mut spans, &mut palette).unwrap());
        });
        report("median-cut", &palette);
        group.bench_function(format!("wu/{colors}"), |bencher| {
            let mut wu = Wu::<5>::new(&mut memory.moments, &mut memory.cuboids).unwrap();
            bencher.iter(|| wu.palette(black_box(&list), &mut palette).unwrap());
        });
        report("wu", &palette);
        group.bench_function(format!("kmeans-5/{colors}"), |bencher| {
            let mut kmeans = KMeans::new(&mut memory.clusters, &mut memory.probes);
            bencher.iter(|| {
                palette.copy_from_slice(&start);
                kmeans.refine(black_box(&list), &mut palette, 5).unwrap()
            });
        });
        report("kmeans-5", &palette);
        let mut nodes = vec![Node::EMPTY; Octree::nodes(colors, 6)];
        let mut made = 0;
        group.bench_function(format!("octree/{colors}"), |bencher| {
            bencher.iter(|| {
                let mut tree = Octree::new(colors, 6, &mut nodes).unwrap();
                tree.add_weighted(black_box(&list)).unwrap();
                made = tree.palette(&mut palette).unwrap();
            });
        });
        report("octree", &palette[..made]);
        let mut centers = vec![[0; 3]; colors];
        group.bench_function(format!("local-kmeans/{colors}"), |bencher| {
            bencher.iter(|| {
                popularity(&mut scratch, &mut palette).unwrap();
                local_kmeans(&list, Learning::default(), &mut cumulative, &mut centers, &mut palette).unwrap()
            });
        });
        report("local-kmeans", &palette);
        let mut neurons = vec![Neuron::EMPTY; colors];
        group.bench_function(format!("neuquant/{colors}"), |bencher| {
            bencher.iter(|| {
                neuquant(black_box(&list), 8192, &mut cumulative, &mut neurons, &mut palette).unwrap();
            });
        });
        report("neuquant", &palette);
    }
    let mut palette = memory.palette::<5>(&pixels, 16, 0);
    let mut errors = vec![[0; 3]; WIDTH * HEIGHT];
    group.sample_size(10).bench_function("spatial-fixed/16", |bencher| {
        let annealing = Annealing { fixed: true, ..Annealing::default() };
        bencher.iter(|| {
            let output = &mut ImageMut::new(&mut memory.indices, WIDTH, HEIGHT).unwrap();
            spatial(Memory::view(&pixels), annealing, &mut errors, &mut palette, output).unwrap();
        });
    });
}

criterion_group!(benches, whole, makers);
criterion_main!(benches);
