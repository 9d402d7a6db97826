//! Gives each pixel of a line its index into a palette, without dithering.
//!
//! ```text
//! Rgb Rgb Rgb …  ─► ColorIndex ─►  3 3 7 …
//! ```
//!
//! Cost and memory: those of the [`ColorIndex`], and a line of indices.

use super::nearest::ColorIndex;
use super::palette::lent;
use crate::image::{Error, Rgb};
use crate::lines::{LineFilter, LineSink, check_width};

/// Line filter from pixels to indices.
#[derive(Debug)]
pub struct ApplyPalette<'a, C> {
    colors: C,
    indices: &'a mut [u8],
}

impl<'a, C: ColorIndex> ApplyPalette<'a, C> {
    /// A filter for lines of `width` pixels, with `width` indices of lent memory.
    ///
    /// # Errors
    /// If `width` is zero or `indices` is shorter.
    pub fn new(width: usize, colors: C, indices: &'a mut [u8]) -> Result<Self, Error> {
        if width == 0 {
            return Err(Error::ZeroSize { width, height: 1 });
        }
        Ok(Self { colors, indices: lent("indices", indices, width)? })
    }
}

impl<C: ColorIndex> LineFilter for ApplyPalette<'_, C> {
    type Input = Rgb;
    type Output = u8;

    const LATENCY: usize = 0;

    fn push(&mut self, line: &[Rgb], sink: &mut impl LineSink<u8>) -> Result<(), Error> {
        check_width(self.indices.len(), line.len())?;
        self.colors.indices(line, self.indices);
        sink.line(self.indices);
        Ok(())
    }

    fn finish(&mut self, _: &mut impl LineSink<u8>) {}
}
