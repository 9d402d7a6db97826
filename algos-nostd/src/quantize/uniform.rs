//! Uniform palette: the same levels of red, green and blue for every picture, and no search.
//!
//! ```text
//!        0     85    170    255         4 levels of a channel; the colours are all combinations,
//!        ●──────●──────●──────●         blue counts fastest: index = (r · green levels + g) · blue levels + b
//! ```
//!
//! The classic ones are 6 × 6 × 6 (216 colours), 8 × 8 × 4 (256) and, for few colours, 2 × 2 × 2 or 2 × 3 × 2.
//!
//! Cost: one multiplication and one table-free division by 255 a channel. Memory: the palette.

use super::nearest::ColorIndex;
use super::palette::{MOST_COLORS, lent};
use crate::image::{Error, Rgb};

/// Palette of evenly spaced levels; as a [`ColorIndex`] it computes the nearest colour.
#[derive(Clone, Copy, Debug)]
pub struct Uniform<'a> {
    palette: &'a [Rgb],
    levels: [u32; 3],
}

/// Level `step` of `levels`, from 0 to 255 and rounded, halves upwards; a single level is the middle.
fn level(step: usize, levels: usize) -> u8 {
    match levels {
        0 | 1 => 128,
        _ => ((step * 510 + levels - 1) / (2 * (levels - 1))) as u8,
    }
}

impl<'a> Uniform<'a> {
    /// Writes the palette of this many levels of red, green and blue into lent memory.
    ///
    /// # Errors
    /// If a channel has no level, there are more than 256 colours, or `palette` is shorter than them.
    pub fn new(levels: [u8; 3], palette: &'a mut [Rgb]) -> Result<Self, Error> {
        let [red, green, blue] = levels.map(usize::from);
        let colors = red * green * blue;
        if !(1..=MOST_COLORS).contains(&colors) {
            let allowed = "at least 1 a channel, with a product of at most 256";
            return Err(Error::Parameter { name: "levels", got: colors as i64, allowed });
        }
        let palette = lent("palette", palette, colors)?;
        for (index, color) in palette.iter_mut().enumerate() {
            let (r, g, b) = (index / (green * blue), index / blue % green, index % blue);
            *color = Rgb { r: level(r, red), g: level(g, green), b: level(b, blue) };
        }
        Ok(Self { palette, levels: levels.map(u32::from) })
    }
}

impl ColorIndex for Uniform<'_> {
    fn palette(&self) -> &[Rgb] {
        self.palette
    }

    #[inline]
    fn index(&mut self, color: Rgb) -> u8 {
        let [red, green, blue] = self.levels;
        let step = |level: u8, levels: u32| (u32::from(level) * (levels - 1) + 127) / 255;
        ((step(color.r, red) * green + step(color.g, green)) * blue + step(color.b, blue)) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_gets_the_nearest_step() {
        for levels in 1..=255u8 {
            let mut palette = [Rgb::default(); 256];
            let mut uniform = Uniform::new([levels, 1, 1], &mut palette).unwrap();
            for red in 0..=255 {
                let color = Rgb { r: red, g: 0, b: 0 };
                let index = usize::from(uniform.index(color));
                let given = uniform.palette()[index].r.abs_diff(red);
                let nearest = uniform.palette().iter().map(|color| color.r.abs_diff(red)).min().unwrap();
                assert_eq!(given, nearest, "{levels} levels, {red}");
            }
        }
    }

    #[test]
    fn blue_counts_fastest() {
        let mut palette = [Rgb::default(); 12];
        let mut uniform = Uniform::new([2, 3, 2], &mut palette).unwrap();
        assert_eq!(uniform.palette()[3], Rgb { r: 0, g: 128, b: 255 });
        assert_eq!(uniform.index(Rgb { r: 250, g: 120, b: 3 }), 8);
        assert!(Uniform::new([0, 3, 2], &mut [Rgb::default(); 12]).is_err());
        assert!(Uniform::new([7, 7, 6], &mut [Rgb::default(); 300]).is_err());
        assert!(Uniform::new([2, 3, 2], &mut [Rgb::default(); 11]).is_err());
    }
}
