//! Local k-means: samples pull the nearest colour of the palette towards them, and reserved colours stay.
//!
//! ```text
//!   sample ∙        ∙
//!          ╲   ─►    ╲○      the nearest moves a little; the step shrinks from round to round
//!           ○
//!        ■               ■   reserved: it takes the samples near it, so that no other colour is spent on them
//! ```
//!
//! Reference: Verevka, "The Local K-means Algorithm for Color Image Quantization", 1995. It was made for displays
//! whose window system owns some colours of the palette: here the first [`Learning::reserved`] colours.
//! Deviation: the samples are spread evenly over the histogram instead of drawn at random, and the step halves each
//! round; a round in which no colour moved a level ends it.
//!
//! Cost: rounds × samples × palette distances. Memory: 4 bytes a weighted colour, 12 bytes a palette colour.

use super::palette::{WeightedColor, check_palette, lent, quarters, rounded};
use super::samples::Samples;
use crate::image::{Error, Rgb};

/// How to learn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Learning {
    /// Colours at the start of the palette that stay as they are.
    pub reserved: usize,
    /// Samples a round.
    pub samples: usize,
    /// Rounds at most, 1 to 16: the first step is an eighth of the way, each round halves it.
    pub rounds: u32,
}

impl Default for Learning {
    fn default() -> Self {
        Self { reserved: 0, samples: 4096, rounds: 6 }
    }
}

/// Refines `palette` (which must hold a start: evenly spread colours, or some other method's) and says how many
/// rounds it took.
///
/// Lent are `cumulative`, one for each weighted colour, and `centers`, one for each palette colour.
///
/// # Errors
/// If the palette's length is not 1 to 256, more colours are reserved than that, a parameter is out of its range, a
/// buffer is too short, or the colours stand for no pixel or too many; the palette is then as it was.
pub fn local_kmeans(
    colors: &[WeightedColor],
    learning: Learning,
    cumulative: &mut [u32],
    centers: &mut [[i32; 3]],
    palette: &mut [Rgb],
) -> Result<u32, Error> {
    check_palette(palette)?;
    let Learning { reserved, samples, rounds } = learning;
    if reserved > palette.len() {
        let allowed = "at most the palette's length";
        return Err(Error::Parameter { name: "reserved", got: reserved as i64, allowed });
    }
    if samples == 0 {
        return Err(Error::Parameter { name: "samples", got: 0, allowed: "at least 1" });
    }
    if !(1..=16).contains(&rounds) {
        return Err(Error::Parameter { name: "rounds", got: rounds.into(), allowed: "1 to 16" });
    }
    let centers = lent("centers", centers, palette.len())?;
    let mut source = Samples::new(colors, cumulative)?;
    for (center, &color) in centers.iter_mut().zip(palette.iter()) {
        // Quarters of a level in 1/4096.
        *center = quarters(color).map(|level| i32::from(level) << FRACTION);
    }
    let mut taken = 0;
    for round in 0..rounds {
        taken += 1;
        let mut farthest = 0;
        for sample in source.by_ref().take(samples) {
            let wanted = sample.map(|level| i32::from(level) << FRACTION);
            let Some(index) = nearest(centers, sample) else { break };
            if index < reserved {
                continue;
            }
            for (level, wanted) in centers[index].iter_mut().zip(wanted) {
                let step = (wanted - *level) >> (3 + round);
                *level += step;
                farthest = farthest.max(step.abs());
            }
        }
        if farthest < 4 << FRACTION {
            break;
        }
    }
    for (color, center) in palette.iter_mut().zip(centers.iter()).skip(reserved) {
        *color = rounded(center.map(|level| (level >> FRACTION) as u16));
    }
    Ok(taken)
}

const FRACTION: u32 = 12;

/// The centre nearest to a sample; of equals, the first.
fn nearest(centers: &[[i32; 3]], sample: [u16; 3]) -> Option<usize> {
    let distance = |center: &[i32; 3]| -> i32 {
        center
            .iter()
            .zip(sample)
            .map(|(center, level)| ((center >> FRACTION) - i32::from(level)).pow(2))
            .sum()
    };
    let keys = centers.iter().enumerate().map(|(index, center)| (distance(center), index));
    keys.min().map(|(_, index)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reserved_colours_stay_and_the_others_do_not_go_there() {
        let gray = |level| Rgb { r: level, g: level, b: level };
        let colors = [(0, 50), (4, 50), (120, 40), (124, 40), (250, 30)]
            .map(|(level, count)| WeightedColor::new(gray(level), count));
        let mut palette = [gray(1), gray(80), gray(200)];
        let learning = Learning { reserved: 1, samples: 210, rounds: 8 };
        let (mut cumulative, mut centers) = ([0; 5], [[0; 3]; 3]);
        local_kmeans(&colors, learning, &mut cumulative, &mut centers, &mut palette).unwrap();
        assert_eq!(palette[0], gray(1));
        assert!(palette[1].r.abs_diff(122) <= 1 && palette[2].r.abs_diff(250) <= 1, "{palette:?}");
    }

    #[test]
    fn bad_parameters_are_refused() {
        let colors = [WeightedColor::new(Rgb::default(), 1)];
        let run = |learning, centers: usize, palette: usize| {
            let (mut buffer, mut made) = ([[0; 3]; 2], [Rgb::default(); 2]);
            local_kmeans(&colors, learning, &mut [0], &mut buffer[..centers], &mut made[..palette])
        };
        let learning = Learning::default();
        assert!(run(learning, 2, 2).is_ok());
        assert!(run(learning, 1, 2).is_err());
        assert!(run(learning, 2, 0).is_err());
        assert!(run(Learning { reserved: 3, ..learning }, 2, 2).is_err());
        assert!(run(Learning { samples: 0, ..learning }, 2, 2).is_err());
        assert!(run(Learning { rounds: 17, ..learning }, 2, 2).is_err());
    }
}
