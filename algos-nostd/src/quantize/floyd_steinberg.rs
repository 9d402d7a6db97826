//! Floyd–Steinberg dithering: what a pixel's palette colour is off by goes on to its neighbours.
//!
//! ```text
//!   even lines ──►          odd lines ◄──
//!         ●  7                  7  ●            sixteenths of the error; every second line runs backwards
//!      3  5  1                  1  5  3         (serpentine), against the worms that one direction draws
//! ```
//!
//! Reference: Floyd and Steinberg, "An Adaptive Algorithm for Spatial Greyscale", 1976; serpentine after Ulichney,
//! "Digital Halftoning", 1987.
//!
//! Errors are kept in sixteenths and rounded once, when a pixel takes what has come to it: nothing is lost on the
//! way. What has come is added to the pixel and clamped to 0 to 255, so a palette that cannot reach a colour makes
//! no runaway error.
//!
//! Cost: one [`ColorIndex::index`] a pixel, in sequence. Memory: one line of indices and one of errors, 6 bytes a
//! pixel.

use super::nearest::ColorIndex;
use super::palette::lent;
use crate::image::{Error, Rgb};
use crate::lines::{LineFilter, LineSink, check_width};

/// Line filter from pixels to dithered indices.
#[derive(Debug)]
pub struct FloydSteinberg<'a, C> {
    colors: C,
    indices: &'a mut [u8],
    /// What has come to each pixel of the next line, in sixteenths of a level.
    errors: &'a mut [[i16; 3]],
    backwards: bool,
}

impl<'a, C: ColorIndex> FloydSteinberg<'a, C> {
    /// A filter for lines of `width` pixels, with as many indices and errors of lent memory.
    ///
    /// # Errors
    /// If `width` is zero or a buffer is shorter.
    pub fn new(
        width: usize,
        colors: C,
        indices: &'a mut [u8],
        errors: &'a mut [[i16; 3]],
    ) -> Result<Self, Error> {
        if width == 0 {
            return Err(Error::ZeroSize { width, height: 1 });
        }
        let indices = lent("indices", indices, width)?;
        let errors = lent("errors", errors, width)?;
        errors.fill([0; 3]);
        Ok(Self { colors, indices, errors, backwards: false })
    }
}

/// Goes along a line, pixels and all in the line's direction.
///
/// Each pixel waits for the error of the one before. So what can be added up without that error is: `partial` holds
/// 16 times the pixel, what came from above, half for rounding, and of 7 · (wanted − given) the part that is known
/// before the palette is asked.
fn along<'p, C: ColorIndex>(
    colors: &mut C,
    pixels: impl Iterator<Item = &'p Rgb>,
    indices: impl Iterator<Item = &'p mut u8>,
    errors: impl Iterator<Item = &'p mut [i16; 3]>,
) {
    /// The highest sum that is still level 255.
    const HIGHEST: i32 = 256 * 16 - 1;
    let (mut wanted, mut given) = ([0i32; 3], [0i32; 3]);
    // The last error, and what the pixel below the last one has so far: 5/16 of it and 1/16 of the one before.
    let (mut last, mut below) = ([0i32; 3], [0i32; 3]);
    let mut previous: Option<&mut [i16; 3]> = None;
    for ((pixel, index), error) in pixels.zip(indices).zip(errors) {
        let pixel = [pixel.r, pixel.g, pixel.b];
        for channel in 0..3 {
            let base = i32::from(pixel[channel]) * 16 + i32::from(error[channel]) + 8;
            let partial = base + 7 * wanted[channel];
            wanted[channel] = (partial - 7 * given[channel]).clamp(0, HIGHEST) >> 4;
        }
        let [r, g, b] = wanted.map(|level| level as u8);
        let (nearest, color) = colors.entry(Rgb { r, g, b });
        *index = nearest;
        given = [color.r, color.g, color.b].map(i32::from);
        let mut behind = [0; 3];
        for channel in 0..3 {
            let error = wanted[channel] - given[channel];
            // At most 9/16 of 255 levels: 2295 sixteenths.
            behind[channel] = (below[channel] + 3 * error) as i16;
            below[channel] = 5 * error + last[channel];
            last[channel] = error;
        }
        if let Some(previous) = previous.replace(error) {
            *previous = behind;
        }
    }
    if let Some(previous) = previous {
        *previous = below.map(|error| error as i16);
    }
}

impl<C: ColorIndex> LineFilter for FloydSteinberg<'_, C> {
    type Input = Rgb;
    type Output = u8;

    const LATENCY: usize = 0;

    fn push(&mut self, line: &[Rgb], sink: &mut impl LineSink<u8>) -> Result<(), Error> {
        check_width(self.indices.len(), line.len())?;
        if self.backwards {
            let (indices, errors) = (self.indices.iter_mut().rev(), self.errors.iter_mut().rev());
            along(&mut self.colors, line.iter().rev(), indices, errors);
        } else {
            along(&mut self.colors, line.iter(), self.indices.iter_mut(), self.errors.iter_mut());
        }
        self.backwards = !self.backwards;
        sink.line(self.indices);
        Ok(())
    }

    fn finish(&mut self, _: &mut impl LineSink<u8>) {
        self.errors.fill([0; 3]);
        self.backwards = false;
    }
}
