//! Palettes made and applied.

use algos_nostd::image::{Error, Image, ImageMut, Rgb};
use algos_nostd::pixel::rgb888;
use algos_nostd::quantize::{
    Annealing, ApplyPalette, BAYER_8, BLUE_NOISE, ColorIndex, ExactMap, FloydSteinberg, Histogram,
    InverseMap, KMeans, Learning, Nearest, Octree, Ordered, Tile, Uniform, Wu, local_kmeans, median_cut,
    neuquant, popularity, spatial,
};

use crate::over::over_bytes;
use crate::report::{Clock, Done, Exercise, Unit::Color, Unit::Pixel};
use crate::space::{BITS, COLORS, PIXELS, WIDTH, Workspace, view};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise { name: "histogram of colours", unit: Pixel, run: counted },
    Exercise { name: "palette popularity", unit: Color, run: by_popularity },
    Exercise { name: "palette median cut", unit: Color, run: by_median_cut },
    Exercise { name: "palette wu", unit: Color, run: by_wu },
    Exercise { name: "palette octree", unit: Pixel, run: by_octree },
    Exercise { name: "palette k-means, 5 rounds", unit: Color, run: by_kmeans },
    Exercise { name: "palette local k-means", unit: Color, run: by_local_kmeans },
    Exercise { name: "palette neuquant", unit: Color, run: by_neuquant },
    Exercise { name: "palette uniform, applied", unit: Pixel, run: uniform },
    Exercise { name: "apply by search", unit: Pixel, run: searched },
    Exercise { name: "apply by inverse map", unit: Pixel, run: mapped },
    Exercise { name: "apply by exact map", unit: Pixel, run: mapped_exactly },
    Exercise { name: "dither floyd-steinberg", unit: Pixel, run: diffused },
    Exercise { name: "dither bayer 8x8", unit: Pixel, run: |s, c| ordered(s, c, BAYER_8) },
    Exercise { name: "dither blue noise", unit: Pixel, run: |s, c| ordered(s, c, BLUE_NOISE) },
    Exercise { name: "spatial quantization, a 16th", unit: Pixel, run: annealed },
    Exercise { name: "16 colours from pixels to indices", unit: Pixel, run: from_pixels_to_indices },
];

/// Counts the picture's colours into `space.colors`; returns how many there are.
fn count(space: &mut Workspace, clock: &mut dyn Clock) -> Result<usize, Error> {
    clock.start();
    let mut histogram = Histogram::<BITS>::new(&mut space.bins)?;
    histogram.clear();
    for line in space.picture.chunks_exact(WIDTH) {
        histogram.add(line)?;
    }
    let count = histogram.weighted_colors(&mut space.colors)?.len();
    clock.stop();
    Ok(count)
}

fn counted(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let count = count(space, clock)?;
    Ok(Done::of(PIXELS, |results| {
        for color in &space.colors[..count] {
            results.numbers(color.quarters().map(i64::from));
            results.numbers([i64::from(color.count())]);
        }
    }))
}

/// The first colours of `space.palette`.
fn palette_done(units: usize, palette: &[Rgb]) -> Done {
    Done::new(units, rgb888::as_bytes(palette))
}

fn by_popularity(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let count = count(space, &mut ())?;
    clock.start();
    let made = popularity(&mut space.colors[..count], &mut space.palette)?;
    clock.stop();
    Ok(palette_done(count, &space.palette[..made]))
}

fn by_median_cut(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let count = count(space, &mut ())?;
    clock.start();
    let made = median_cut(&mut space.colors[..count], &mut space.spans, &mut space.palette)?;
    clock.stop();
    Ok(palette_done(count, &space.palette[..made]))
}

fn by_wu(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let count = count(space, &mut ())?;
    clock.start();
    let mut wu = Wu::<BITS>::new(&mut space.moments, &mut space.cuboids)?;
    let made = wu.palette(&space.colors[..count], &mut space.palette)?;
    clock.stop();
    Ok(palette_done(count, &space.palette[..made]))
}

fn by_octree(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    clock.start();
    let mut tree = Octree::new(COLORS, 6, &mut space.nodes)?;
    for line in space.picture.chunks_exact(WIDTH) {
        tree.add(line)?;
    }
    let made = tree.palette(&mut space.palette)?;
    clock.stop();
    Ok(palette_done(PIXELS, &space.palette[..made]))
}

fn by_kmeans(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let done = by_wu(space, &mut ())?;
    clock.start();
    let mut kmeans = KMeans::new(&mut space.clusters, &mut space.probes);
    kmeans.refine(&space.colors[..done.units as usize], &mut space.palette, 5)?;
    clock.stop();
    Ok(palette_done(done.units as usize, &space.palette))
}

fn by_local_kmeans(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let count = count(space, &mut ())?;
    let colors = &mut space.scratch[..count];
    colors.copy_from_slice(&space.colors[..count]);
    popularity(colors, &mut space.palette)?;
    let learning = Learning { samples: 4096, ..Learning::default() };
    let cumulative = &mut space.cumulative[..count];
    clock.start();
    local_kmeans(&space.colors[..count], learning, cumulative, &mut space.centers, &mut space.palette)?;
    clock.stop();
    Ok(palette_done(count, &space.palette))
}

fn by_neuquant(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let count = count(space, &mut ())?;
    let cumulative = &mut space.cumulative[..count];
    clock.start();
    neuquant(&space.colors[..count], 4096, cumulative, &mut space.neurons, &mut space.palette)?;
    clock.stop();
    Ok(palette_done(count, &space.palette))
}

fn uniform(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let colors = Uniform::new([2, 4, 2], &mut space.palette)?;
    let filter = ApplyPalette::new(WIDTH, colors, &mut space.byte_line);
    over_bytes(filter, view(&space.picture)?, &mut space.bytes, clock)
}

fn searched(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    by_wu(space, &mut ())?;
    let nearest = Nearest::new(&space.palette, &mut space.probes)?;
    let filter = ApplyPalette::new(WIDTH, nearest, &mut space.byte_line);
    over_bytes(filter, view(&space.picture)?, &mut space.bytes, clock)
}

fn mapped(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    by_wu(space, &mut ())?;
    let nearest = Nearest::new(&space.palette, &mut space.probes)?;
    let map = InverseMap::<BITS>::new(nearest, &mut space.table)?;
    let filter = ApplyPalette::new(WIDTH, map, &mut space.byte_line);
    over_bytes(filter, view(&space.picture)?, &mut space.bytes, clock)
}

fn mapped_exactly(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    by_wu(space, &mut ())?;
    let map = ExactMap::<BITS>::new(&space.palette, &mut space.cells, &mut space.groups)?;
    let filter = ApplyPalette::new(WIDTH, map, &mut space.byte_line);
    over_bytes(filter, view(&space.picture)?, &mut space.bytes, clock)
}

fn diffused(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    by_wu(space, &mut ())?;
    let nearest = Nearest::new(&space.palette, &mut space.probes)?;
    let map = InverseMap::<BITS>::new(nearest, &mut space.table)?;
    let filter = FloydSteinberg::new(WIDTH, map, &mut space.byte_line, &mut space.errors);
    over_bytes(filter, view(&space.picture)?, &mut space.bytes, clock)
}

fn ordered(space: &mut Workspace, clock: &mut dyn Clock, tile: Tile<'static>) -> Result<Done, Error> {
    by_wu(space, &mut ())?;
    let spread = Ordered::<InverseMap<'_, BITS>>::spread_of(&space.palette);
    let nearest = Nearest::new(&space.palette, &mut space.probes)?;
    let map = InverseMap::<BITS>::new(nearest, &mut space.table)?;
    let filter = Ordered::new(WIDTH, tile, spread, map, &mut space.line, &mut space.byte_line);
    over_bytes(filter, view(&space.picture)?, &mut space.bytes, clock)
}

/// The middle of the picture: it takes memory and time as no other.
fn annealed(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let (width, height) = (80, 60);
    by_wu(space, &mut ())?;
    let whole: Image<'_, Rgb> = view(&space.picture)?;
    let part = whole.crop(120, 90, width, height).ok_or(Error::ZeroSize { width, height })?;
    let indices = &mut space.bytes[..width * height];
    clock.start();
    let mut out = ImageMut::new(indices, width, height)?;
    spatial(part, Annealing::default(), &mut space.errors, &mut space.palette, &mut out)?;
    clock.stop();
    Ok(Done::of(width * height, |results| {
        results.bytes(&space.bytes[..width * height]);
        results.bytes(rgb888::as_bytes(&space.palette));
    }))
}

/// All that a frame takes: the histogram, Wu's palette, its inverse map, and the indices.
fn from_pixels_to_indices(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    clock.start();
    by_wu(space, &mut ())?;
    let nearest = Nearest::new(&space.palette, &mut space.probes)?;
    let mut map = InverseMap::<BITS>::new(nearest, &mut space.table)?;
    let lines = space.picture.chunks_exact(WIDTH).zip(space.bytes.chunks_exact_mut(WIDTH));
    for (pixels, indices) in lines {
        for (pixel, index) in pixels.iter().zip(indices) {
            *index = map.index(*pixel);
        }
    }
    clock.stop();
    Ok(Done::new(PIXELS, &space.bytes[..PIXELS]))
}
