//! White-patch: the brightest of the scene is taken for white, so its colour is that of the light.
//!
//! ```text
//! pixels │▂▅▇▅▃▂▁▁▁▁│▁     for each channel: the value that so many per mille of the pixels
//!        0         white 255                do not exceed
//! ```
//!
//! E. H. Land, J. J. McCann, "Lightness and retinex theory", J. Opt. Soc. Am. 61 (1971), with a percentile in place of the
//! maximum, because one hot pixel or highlight would else decide: M. Ebner, "Color Constancy" (2007) §6.1.
//!
//! **Cost and memory.** Three increments a pixel; 3 KiB of histogram, in the struct that the caller places.

use super::White;
use crate::color::histogram::Histogram;
use crate::image::{Error, Rgb};

/// Counts a picture's values line by line.
#[derive(Clone, Debug)]
pub struct WhitePatch {
    channels: [Histogram; 3],
    per_mille: u32,
}

impl WhitePatch {
    /// The white is the value that `per_mille` of the pixels do not exceed: 1,000 is the maximum, 990 is usual.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it is not 1 to 1,000.
    pub const fn new(per_mille: u32) -> Result<Self, Error> {
        if per_mille == 0 || per_mille > 1000 {
            return Err(Error::Parameter { name: "per_mille", got: per_mille as i64, allowed: "1 to 1000" });
        }
        Ok(Self { channels: [const { Histogram::new() }; 3], per_mille })
    }

    /// Takes a line, of any length.
    pub fn push(&mut self, line: &[Rgb]) {
        let [red, green, blue] = &mut self.channels;
        for pixel in line {
            red.count(pixel.r);
            green.count(pixel.g);
            blue.count(pixel.b);
        }
    }

    /// The light's colour, and is ready for the next frame. `None` without pixels.
    pub fn finish(&mut self) -> Option<White> {
        let [r, g, b] = [0, 1, 2].map(|channel| {
            let counted = core::mem::take(&mut self.channels[channel]);
            counted.quantile(self.per_mille, 1000)
        });
        Some(White::of(Rgb::new(r?, g?, b?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hot_pixel_decides_only_if_asked() {
        let mut line = [Rgb::new(120, 200, 90); 1000];
        line[17] = Rgb::new(255, 255, 255);
        let mut most = WhitePatch::new(1000).unwrap();
        let mut usual = WhitePatch::new(999).unwrap();
        most.push(&line);
        usual.push(&line);
        assert_eq!(most.finish(), Some(White::of(line[17])));
        assert_eq!(usual.finish(), Some(White::of(line[0])));
        assert_eq!(usual.finish(), None);
        assert!(WhitePatch::new(0).is_err() && WhitePatch::new(1001).is_err());
    }
}
