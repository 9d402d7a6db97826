//! NeuQuant: a line of neurons in colour space is pulled towards samples, neighbours along with the winner.
//!
//! ```text
//!   neurons   0──1──2──3──4──5──6──7      a string laid along the grays
//!                      ∙                  a sample: the nearest neuron goes towards it, and its neighbours on
//!             0──1──2──╲3╱──4──5──6──7    the string follow, less the farther; step and reach shrink
//! ```
//!
//! Reference: Dekker, "Kohonen Neural Networks for Optimal Colour Quantization", Network 5, 1994. A bias for neurons
//! that win seldom keeps all of them in use. The numbers are the paper's: 100 cycles, a step of 1/1024 units falling
//! by a thirtieth each cycle, a reach of an eighth of the string, β = 1/1024, γ = 1024.
//!
//! Deviation: samples are spread evenly over the histogram instead of stepping through the picture by a prime, so no
//! frame is held; colours carry six bits of fraction instead of
//! four and frequencies 26 instead of 16, which at 256 colours lost β's share to rounding.
//!
//! Cost: samples × palette distances. Memory: 4 bytes a weighted colour, a [`Neuron`] (20 bytes) a palette colour.

use super::palette::{WeightedColor, check_palette, lent, rounded};
use super::samples::Samples;
use crate::image::{Error, Rgb};

/// A colour on the string.
#[derive(Clone, Copy, Debug, Default)]
pub struct Neuron {
    /// Red, green and blue in 1/64 of a level.
    color: [i32; 3],
    /// How often it won of late, 2^26 being always.
    frequency: i32,
    /// In 2^-16 of a level.
    bias: i32,
}

impl Neuron {
    /// A place to be filled.
    pub const EMPTY: Self = Self { color: [0; 3], frequency: 0, bias: 0 };
}

const ONE: i32 = 1 << 26;
const CYCLES: usize = 100;
const STEP: i32 = 1 << 10;
/// Reach is kept in 1/64 of a neuron.
const REACH_FRACTION: i32 = 64;

/// Learns a palette of exactly `palette.len()` colours from `samples` samples (8192 is a good number).
///
/// Lent are `cumulative`, one for each weighted colour, and `neurons`, one for each palette colour.
///
/// # Errors
/// If the palette's length is not 1 to 256, `samples` is zero, a buffer is too short, or the colours stand for no
/// pixel or too many.
pub fn neuquant(
    colors: &[WeightedColor],
    samples: usize,
    cumulative: &mut [u32],
    neurons: &mut [Neuron],
    palette: &mut [Rgb],
) -> Result<(), Error> {
    check_palette(palette)?;
    if samples == 0 {
        return Err(Error::Parameter { name: "samples", got: 0, allowed: "at least 1" });
    }
    let neurons = lent("neurons", neurons, palette.len())?;
    let source = Samples::new(colors, cumulative)?;
    let count = neurons.len() as i32;
    for (index, neuron) in (0..).zip(neurons.iter_mut()) {
        *neuron = Neuron { color: [(index * 2 + 1) * 255 * 32 / count; 3], frequency: ONE / count, bias: 0 };
    }
    let (mut step, mut reach) = (STEP, (count / 8) * REACH_FRACTION);
    let cycle = samples.div_ceil(CYCLES);
    for (number, sample) in (1..).zip(source.take(samples)) {
        let sample = sample.map(|quarters| i32::from(quarters) * 16);
        let winner = contest(neurons, sample);
        pull(neurons, winner, sample, step, reach / REACH_FRACTION);
        if number % cycle == 0 {
            step -= step / 30;
            reach -= reach / 30;
        }
    }
    for (color, neuron) in palette.iter_mut().zip(neurons.iter()) {
        *color = rounded(neuron.color.map(|level| ((level + 8) / 16) as u16));
    }
    Ok(())
}

/// The neuron that wins the sample, by distance less bias; wins of the nearest are counted.
fn contest(neurons: &mut [Neuron], sample: [i32; 3]) -> usize {
    let (mut nearest, mut winner) = ((i32::MAX, 0), (i32::MAX, 0));
    for (index, neuron) in neurons.iter_mut().enumerate() {
        let distance: i32 = neuron.color.iter().zip(sample).map(|(a, b)| (a - b).abs()).sum();
        nearest = nearest.min((distance, index));
        winner = winner.min((distance - (neuron.bias >> 10), index));
        // β of the frequency is forgotten, and γ times as much added to the bias: βγ is one level.
        let forgotten = neuron.frequency >> 10;
        neuron.frequency -= forgotten;
        neuron.bias += forgotten;
    }
    if let Some(neuron) = neurons.get_mut(nearest.1) {
        neuron.frequency += ONE >> 10;
        neuron.bias -= ONE >> 10;
    }
    winner.1
}

/// Moves the winner by `step` / 2^10 of the way, and its neighbours within reach less and less.
fn pull(neurons: &mut [Neuron], winner: usize, sample: [i32; 3], step: i32, reach: i32) {
    let reach = if reach <= 1 { 0 } else { reach };
    let first = winner.saturating_sub((reach - 1).max(0) as usize);
    let last = winner + (reach - 1).max(0) as usize;
    for (index, neuron) in neurons.iter_mut().enumerate().take(last + 1).skip(first) {
        let away = index.abs_diff(winner) as i32;
        let power = if away == 0 { step } else { step * (reach * reach - away * away) / (reach * reach) };
        for (level, wanted) in neuron.color.iter_mut().zip(sample) {
            *level += power * (wanted - *level) / STEP;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_heap_gets_neurons() {
        let color = |r, g, b, count| WeightedColor::new(Rgb { r, g, b }, count);
        let colors = [color(250, 10, 10, 60), color(10, 240, 20, 30), color(0, 0, 200, 20)];
        let mut palette = [Rgb::default(); 8];
        neuquant(&colors, 4000, &mut [0; 3], &mut [Neuron::EMPTY; 8], &mut palette).unwrap();
        for heap in colors {
            let off = |color: &Rgb| super::super::palette::squared_distance(*color, heap.rounded());
            let nearest = palette.iter().map(off).min().unwrap();
            assert!(nearest <= 3 * 8 * 8, "{heap:?} {palette:?}");
        }
    }

    #[test]
    fn bad_parameters_are_refused() {
        let colors = [WeightedColor::new(Rgb::default(), 1)];
        let mut palette = [Rgb::default(); 2];
        assert!(neuquant(&colors, 0, &mut [0], &mut [Neuron::EMPTY; 2], &mut palette).is_err());
        assert!(neuquant(&colors, 9, &mut [0], &mut [Neuron::EMPTY; 1], &mut palette).is_err());
        assert!(neuquant(&colors, 9, &mut [], &mut [Neuron::EMPTY; 2], &mut palette).is_err());
        assert!(neuquant(&colors, 9, &mut [0], &mut [Neuron::EMPTY; 2], &mut []).is_err());
    }
}
