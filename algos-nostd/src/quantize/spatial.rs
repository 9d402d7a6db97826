//! Spatial colour quantization: palette and dithering found together, for an eye that sees a little blurred.
//!
//! ```text
//!   picture ──────────────────────────► x       energy: Σ | blur(q − x) |²
//!   each pixel: for its neighbours' error, ─► q      over all pixels, with blur = 1 2 1 ⊗ 1 2 1
//!   the mixture of palette colours that is best            16
//!   each colour: the mean of what its pixels would want
//!   ─► again, with less and less mixture, until each pixel has one colour
//! ```
//!
//! Reference: Puzicha, Held, Ketterer, Buhmann and Fellner, "On Spatial Quantization of Color Images", 1998. The
//! energy is theirs: what blurring leaves of the error. With everything else fixed, a pixel's energy is its distance
//! to a target, the pixel less its neighbours' errors weighted by the blur with itself (5 × 5). Mean-field annealing
//! gives each palette colour the probability exp(−distance² / temperature).
//!
//! Deviations: they keep a probability for each pixel and colour; the targets need only each pixel's mean colour, and
//! nothing else is kept, so memory does not grow with the palette. The palette's linear system is replaced by a step
//! towards the mean of targets after each sweep. There is no coarse-to-fine pyramid: one starts from a palette (any other
//! method's).
//!
//! Cost: about palette × 10 + 100 operations a pixel and sweep: by far the slowest of all, and meant for small
//! pictures and few colours. Memory: 6 bytes a pixel: it cannot be bounded by lines, since every sweep changes all
//! pixels; a large picture can be cut into tiles ([`Image::crop`]) under one palette with `fixed`.

use super::palette::{MOST_COLORS, check_palette, lent};
use crate::image::{Error, Image, ImageMut, Rgb};

/// How to anneal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Annealing {
    /// First temperature, in squared levels, 1 to 65 535: the squared distance at which another colour is 1/e as
    /// likely.
    pub temperature: u32,
    /// Sweeps in which the temperature falls by half each, 0 to 32; two sweeps without mixture follow.
    pub sweeps: u32,
    /// The palette stays as it is; only pixels change.
    pub fixed: bool,
}

impl Default for Annealing {
    fn default() -> Self {
        Self { temperature: 2048, sweeps: 12, fixed: false }
    }
}

/// The blur with itself: 1 4 6 4 1 ⊗ 1 4 6 4 1.
const WEIGHTS: [i32; 5] = [1, 4, 6, 4, 1];
/// Its middle.
const OWN: i32 = 36;
/// Its sum.
const ALL: i32 = 256;
/// Levels are kept in sixteenths.
const FRACTION: i32 = 16;

/// 2^(−x/16) in 1/65536, x from 0 to 255.
const LIKELIHOOD: [u32; 256] = {
    // 2^(−1/16) in 2^-32.
    const RATIO: u64 = 4_112_874_773;
    let mut table = [0; 256];
    let (mut x, mut value) = (0, 1u64 << 32);
    while x < 256 {
        table[x] = (value >> 16) as u32;
        value = (value * RATIO) >> 32;
        x += 1;
    }
    table
};

/// Pixels' errors, in sixteenths of a level.
#[derive(Debug)]
struct Errors<'a> {
    errors: &'a mut [[i16; 3]],
    width: usize,
    height: usize,
}

impl Errors<'_> {
    /// Weighted errors of the neighbours, over the pixel's own weight: what its target is below the pixel.
    fn of_neighbours(&self, x: usize, y: usize) -> [i32; 3] {
        let mut sum = [0; 3];
        for line in y.saturating_sub(2)..(y + 3).min(self.height) {
            for column in x.saturating_sub(2)..(x + 3).min(self.width) {
                let weight = WEIGHTS[line + 2 - y] * WEIGHTS[column + 2 - x];
                let error = self.errors[line * self.width + column];
                for (sum, error) in sum.iter_mut().zip(error) {
                    *sum += weight * i32::from(error);
                }
            }
        }
        let own = self.errors[y * self.width + x].map(i32::from);
        [0, 1, 2].map(|channel| (sum[channel] - OWN * own[channel]) / OWN)
    }
}

/// What a sweep learns about a palette colour: weight and weighted targets of the pixels that have it.
type Wish = (u64, [i64; 3]);

/// Dithers `picture` to `palette`, which it improves unless told not to, and writes the indices.
///
/// Lent is `errors`, one for each pixel.
///
/// # Errors
/// If the palette's length is not 1 to 256, a parameter is out of its range, `errors` is too short, or `indices` is
/// not of the picture's size.
pub fn spatial(
    picture: Image<'_, Rgb>,
    annealing: Annealing,
    errors: &mut [[i16; 3]],
    palette: &mut [Rgb],
    indices: &mut ImageMut<'_, u8>,
) -> Result<(), Error> {
    check_palette(palette)?;
    let Annealing { temperature, sweeps, fixed } = annealing;
    if !(1..=65_535).contains(&temperature) {
        let allowed = "1 to 65535 squared levels";
        return Err(Error::Parameter { name: "temperature", got: temperature.into(), allowed });
    }
    if sweeps > 32 {
        return Err(Error::Parameter { name: "sweeps", got: sweeps.into(), allowed: "0 to 32" });
    }
    let (expected, got) = ((picture.width(), picture.height()), (indices.width(), indices.height()));
    if expected != got {
        return Err(Error::SizeMismatch { expected, got });
    }
    let errors = lent("errors", errors, expected.0.saturating_mul(expected.1))?;
    errors.fill([0; 3]);
    let mut errors = Errors { errors, width: expected.0, height: expected.1 };
    let mut colors = [[0i32; 3]; MOST_COLORS];
    for (color, from) in colors.iter_mut().zip(palette.iter()) {
        *color = [from.r, from.g, from.b].map(|level| i32::from(level) * FRACTION);
    }
    let colors = &mut colors[..palette.len()];
    let mut halved = temperature;
    for _ in 0..sweeps {
        let wishes = sweep(picture, &mut errors, colors, Some(halved.max(1)), indices);
        if !fixed {
            improve(colors, &wishes);
        }
        halved /= 2;
    }
    if !fixed {
        let wishes = sweep(picture, &mut errors, colors, None, indices);
        improve(colors, &wishes);
        for (color, from) in palette.iter_mut().zip(colors.iter_mut()) {
            let [r, g, b] = from.map(|level| ((level + FRACTION / 2) / FRACTION) as u8);
            *color = Rgb { r, g, b };
            *from = [r, g, b].map(|level| i32::from(level) * FRACTION);
        }
    } else {
        sweep(picture, &mut errors, colors, None, indices);
    }
    sweep(picture, &mut errors, colors, None, indices);
    Ok(())
}

/// Moves each colour towards the mean of its pixels' targets, `OWN` / `ALL` of the way.
///
/// Targets hold the other pixels still, but those of the same colour move along: all the way would overshoot. The
/// energy's matrix has no negative entries and rows that add up to at most `ALL` a pixel, so this far it only falls.
fn improve(colors: &mut [[i32; 3]], wishes: &[Wish; MOST_COLORS]) {
    for (color, (weight, sum)) in colors.iter_mut().zip(wishes).filter(|(_, (weight, _))| *weight > 0) {
        for (level, sum) in color.iter_mut().zip(sum) {
            let mean = (sum / *weight as i64) as i32;
            *level = (*level + (mean - *level) * OWN / ALL).clamp(0, 255 * FRACTION);
        }
    }
}

/// Goes over all pixels once: mixes colours for each at a temperature, or chooses the best one.
fn sweep(
    picture: Image<'_, Rgb>,
    errors: &mut Errors<'_>,
    colors: &[[i32; 3]],
    temperature: Option<u32>,
    indices: &mut ImageMut<'_, u8>,
) -> [Wish; MOST_COLORS] {
    let mut wishes: [Wish; MOST_COLORS] = [(0, [0; 3]); MOST_COLORS];
    let mut distances = [0u32; MOST_COLORS];
    for (y, (line, indices)) in picture.rows().zip(indices.rows_mut()).enumerate() {
        for (x, (pixel, index)) in line.iter().zip(indices).enumerate() {
            let pixel = [pixel.r, pixel.g, pixel.b].map(|level| i32::from(level) * FRACTION);
            let owed = errors.of_neighbours(x, y);
            let target = [0, 1, 2].map(|channel| pixel[channel] - owed[channel]);
            let mut least = (u32::MAX, 0);
            for (number, (distance, color)) in distances.iter_mut().zip(colors).enumerate() {
                // In sixteenths of a squared level. Errors of neighbours add up to at most 6.2 times 255 levels:
                // squares stay below 2^26.
                let square = |channel: usize| ((color[channel] - target[channel]).unsigned_abs() / 4).pow(2);
                *distance = square(0) + square(1) + square(2);
                least = least.min((*distance, number));
            }
            *index = least.1 as u8;
            let mean = match temperature {
                None => {
                    wish(&mut wishes[least.1], 1 << 16, target);
                    colors[least.1]
                }
                Some(temperature) => {
                    let (mut weights, mut sums) = (0u64, [0u64; 3]);
                    for (number, (distance, color)) in distances.iter().zip(colors).enumerate() {
                        // 23 sixteenths of an octave are a factor e.
                        let x = u64::from(distance - least.0) * 23 / (u64::from(temperature) * 16);
                        let Some(&weight) = LIKELIHOOD.get(x as usize) else { continue };
                        weights += u64::from(weight);
                        for (sum, level) in sums.iter_mut().zip(color) {
                            *sum += u64::from(weight) * *level as u64;
                        }
                        wish(&mut wishes[number], weight, target);
                    }
                    // The likeliest colour has a weight, so there is no division by zero.
                    sums.map(|sum| (sum / weights.max(1)) as i32)
                }
            };
            errors.errors[y * errors.width + x] =
                [0, 1, 2].map(|channel| (mean[channel] - pixel[channel]) as i16);
        }
    }
    wishes
}

fn wish(wish: &mut Wish, weight: u32, target: [i32; 3]) {
    wish.0 += u64::from(weight);
    for (sum, target) in wish.1.iter_mut().zip(target) {
        *sum += i64::from(weight) * i64::from(target);
    }
}
