//! Samples of weighted colours, as evenly spread as can be and always the same: food for the learning methods.
//!
//! ```text
//!   colours       |   a   |  b |        c         | d |     each as wide as it has pixels
//!   samples           0      3    1      4     2            steps of 0.618 of the whole, modulo the whole
//! ```
//!
//! Steps near the golden section fall into the largest gap each time, so any number of samples is spread evenly over
//! the list, whose neighbours are neighbours in colour.
//!
//! Cost: a binary search a sample. Memory: 4 bytes a colour.

use super::palette::{WeightedColor, check_colors, lent};
use crate::image::Error;

/// The sampler.
#[derive(Debug)]
pub(super) struct Samples<'a> {
    colors: &'a [WeightedColor],
    /// Pixels up to and with each colour.
    cumulative: &'a [u32],
    total: u32,
    step: u32,
    at: u32,
}

const fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

impl<'a> Samples<'a> {
    /// # Errors
    /// If the colours stand for no pixel or too many, or `cumulative` is shorter than `colors`.
    pub(super) fn new(colors: &'a [WeightedColor], cumulative: &'a mut [u32]) -> Result<Self, Error> {
        let total = check_colors(colors)?;
        let cumulative = lent("cumulative", cumulative, colors.len())?;
        let mut sum = 0;
        for (place, color) in cumulative.iter_mut().zip(colors) {
            sum += color.count();
            *place = sum;
        }
        // 40503 / 65536 is the golden section; a step without common divisor visits every pixel.
        let mut step = ((u64::from(total) * 40503) >> 16) as u32 | 1;
        while common_divisor(step, total) != 1 {
            step += 1;
        }
        Ok(Self { colors, cumulative, total, step: step % total, at: total / 2 })
    }
}

impl Iterator for Samples<'_> {
    type Item = [u16; 3];

    /// The next sample, in quarters of a level; there is no end.
    fn next(&mut self) -> Option<[u16; 3]> {
        self.at = (self.at + self.step) % self.total;
        let index = self.cumulative.partition_point(|sum| *sum <= self.at);
        Some(self.colors.get(index)?.quarters())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Rgb;

    #[test]
    fn each_colour_comes_as_often_as_it_has_pixels() {
        let color = |level: u8, count| WeightedColor::new(Rgb { r: level, g: 0, b: 0 }, count);
        for counts in [[1, 0, 0], [3, 0, 5], [1, 2, 3], [100, 28, 1]] {
            let colors: [_; 3] = core::array::from_fn(|index| color(index as u8, counts[index]));
            let mut cumulative = [0; 3];
            let samples = Samples::new(&colors, &mut cumulative).unwrap();
            let mut seen = [0; 3];
            samples
                .take(counts.iter().sum::<u32>() as usize)
                .for_each(|[red, ..]| seen[usize::from(red / 4)] += 1);
            assert_eq!(seen, counts);
        }
        assert!(Samples::new(&[color(0, 1)], &mut []).is_err());
    }
}
