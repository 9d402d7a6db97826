use algos_nostd::image::{Error, Rgb};
use algos_nostd::quantize::{
    Bin, Cluster, Cuboid, Histogram, KMeans, Learning, Moment, Neuron, Node, Octree, Probe, Span, Uniform,
    WeightedColor, Wu, local_kmeans, median_cut, neuquant, popularity,
};

use crate::pipeline::arguments::Arguments;
use crate::pipeline::picture::Frame;

/// Bits of the histogram of a channel, and of Wu's grid: the library's recipe for quality.
const HISTOGRAM_BITS: u32 = 6;
const GRID_BITS: u32 = 5;
/// Samples that NeuQuant learns from: the library's advice.
const SAMPLES: usize = 8192;
/// Levels of the octree.
const DEPTH: usize = 6;
/// Iterations of the method `k-means` where none are asked for: the library's recipe for quality.
const ITERATIONS: usize = 5;

/// The palette of a picture by the stage's values: up to `colors`, or as many as the fixed and the uniform one have.
pub(super) fn palette(arguments: &Arguments<'_>, frame: &Frame<Rgb>) -> Result<Vec<Rgb>, Error> {
    let method = arguments.word("method");
    let mut colors = counted(frame)?;
    let mut palette = vec![Rgb::default(); arguments.integer("colors")];
    let mut iterations: usize = arguments.integer("iterations");
    let made = match method {
        "fixed" => {
            let fixed = arguments.colors("palette");
            if fixed.is_empty() {
                return Err(Error::Parameter {
                    name: "palette",
                    got: 0,
                    allowed: "at least one colour for `fixed`",
                });
            }
            return Ok(fixed.to_vec());
        }
        "uniform" => return uniform(arguments),
        "popularity" => popularity(&mut colors, &mut palette)?,
        "median-cut" => {
            let mut spans = vec![Span::EMPTY; palette.len()];
            median_cut(&mut colors, &mut spans, &mut palette)?
        }
        "octree" => {
            let mut nodes = vec![Node::EMPTY; Octree::nodes(palette.len(), DEPTH)];
            let mut octree = Octree::new(palette.len(), DEPTH, &mut nodes)?;
            frame.rows().try_for_each(|row| octree.add(row))?;
            octree.palette(&mut palette)?
        }
        "neuquant" => {
            let mut cumulative = vec![0; colors.len()];
            let mut neurons = vec![Neuron::EMPTY; palette.len()];
            neuquant(&colors, SAMPLES, &mut cumulative, &mut neurons, &mut palette)?;
            palette.len()
        }
        "local-k-means" => return local(arguments, &colors, palette),
        _ => {
            if method == "k-means" && iterations == 0 {
                iterations = ITERATIONS;
            }
            wu(&colors, &mut palette)?
        }
    };
    palette.truncate(made);
    if iterations > 0 {
        let mut clusters = vec![Cluster::EMPTY; palette.len()];
        let mut probes = vec![Probe::EMPTY; palette.len()];
        KMeans::new(&mut clusters, &mut probes).refine(&colors, &mut palette, iterations)?;
    }
    Ok(palette)
}

/// The colours of a picture with their numbers of pixels.
fn counted(frame: &Frame<Rgb>) -> Result<Vec<WeightedColor>, Error> {
    let mut bins = vec![Bin::EMPTY; Histogram::<HISTOGRAM_BITS>::bins()];
    let mut histogram = Histogram::<HISTOGRAM_BITS>::new(&mut bins)?;
    frame.rows().try_for_each(|row| histogram.add(row))?;
    let mut colors = vec![WeightedColor::EMPTY; histogram.occupied()];
    histogram.weighted_colors(&mut colors)?;
    Ok(colors)
}

fn wu(colors: &[WeightedColor], palette: &mut [Rgb]) -> Result<usize, Error> {
    let mut moments = vec![Moment::EMPTY; Wu::<GRID_BITS>::moments()];
    let mut cuboids = vec![Cuboid::EMPTY; palette.len()];
    Wu::<GRID_BITS>::new(&mut moments, &mut cuboids)?.palette(colors, palette)
}

fn uniform(arguments: &Arguments<'_>) -> Result<Vec<Rgb>, Error> {
    let levels = arguments.whole::<u8, 3>("levels");
    let count = levels.iter().map(|&level| usize::from(level)).product();
    let mut palette = vec![Rgb::default(); count];
    Uniform::new(levels, &mut palette)?;
    Ok(palette)
}

/// Starts from Wu's palette behind the reserved colours.
fn local(
    arguments: &Arguments<'_>,
    colors: &[WeightedColor],
    mut palette: Vec<Rgb>,
) -> Result<Vec<Rgb>, Error> {
    let fixed = arguments.colors("palette");
    let reserved = fixed.len();
    if reserved > palette.len() {
        let got = reserved as i64;
        return Err(Error::Parameter {
            name: "palette",
            got,
            allowed: "at most `colors` colours, which are reserved",
        });
    }
    let (kept, free) = palette.split_at_mut(reserved);
    kept.copy_from_slice(fixed);
    let made = if free.is_empty() { 0 } else { wu(colors, free)? };
    palette.truncate(reserved + made);
    let mut cumulative = vec![0; colors.len()];
    let mut centers = vec![[0; 3]; palette.len()];
    let learning = Learning { reserved, ..Learning::default() };
    local_kmeans(colors, learning, &mut cumulative, &mut centers, &mut palette)?;
    Ok(palette)
}
