//! The device's own vision: lines from the camera in, finished lines out, in memory that is known before it starts.
//!
//! ```text
//! line ring ─► pixels ─► balance ─┬─► colour
//!   bytes                 ▲       ├─► palette ─► indices
//!                         │       └─► gray ─► smooth ─┬─► Sobel ─► magnitudes
//!              white of the frame                     └─► Canny ─► edges, when the frame has ended
//!              before
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `settings` | what is wanted, and the memory that it takes |
//! | `memory` | lent words, cut into typed pieces |
//! | `light` | white balance from frame to frame |
//! | `tail` | from pixels to what is wanted |
//! | `edges` | Canny: two maps of bits |
//!
//! What is wanted is chosen at start-up. Nothing is allocated, and no frame is kept: all but Canny's two maps, of one bit
//! a pixel, is a window of a few lines.
//!
//! # Example
//! ```
//! use firmware::pipeline::{Output, Pipeline, Product, Settings, Smoothing};
//!
//! let settings = Settings { output: Output::Sobel(Smoothing::Gaussian3), ..Settings::new(8, 2) };
//! let mut memory = [0; Settings::sobel_memory(8)];
//! let mut pipeline = Pipeline::new(settings, &mut memory)?;
//! let mut strongest = 0;
//! let mut sink = |product: Product<'_>| {
//!     if let Product::Gray(line) = product {
//!         strongest = line.iter().copied().fold(strongest, u8::max);
//!     }
//! };
//! let step: [u8; 24] = core::array::from_fn(|byte| if byte < 12 { 10 } else { 90 });
//! for _ in 0..2 {
//!     pipeline.push(&step, &mut sink)?;
//! }
//! pipeline.finish(&mut sink);
//! assert_eq!(strongest, 240);
//! # Ok::<(), algos_nostd::image::Error>(())
//! ```

mod settings;
mod memory;
mod light;
mod tail;
mod edges;
#[cfg(test)]
mod tests;

pub use algos_nostd::edges::{Norm, Thresholds};
pub use light::Light;
pub use settings::{Balance, Output, Palette, Settings, Smoothing};

use algos_nostd::image::{Error, Rgb};
use algos_nostd::pixel::format::{Format, Meaning};

use memory::Memory;
use tail::Tail;

/// A finished line, or a line of a finished frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Product<'a> {
    /// Pixels in colour.
    Color(&'a [Rgb]),
    /// Gray levels, or magnitudes of the gradient.
    Gray(&'a [u8]),
    /// Indices of a palette's colours.
    Indices(&'a [u8]),
    /// Edges, a bit a pixel, the first pixel lowest. They come when the frame has ended.
    Edges(&'a [u32]),
}

/// A pipeline at work.
#[derive(Debug)]
pub struct Pipeline<'m> {
    format: Format,
    meaning: Meaning,
    light: Option<Light>,
    pixels: &'m mut [Rgb],
    tail: Tail<'m>,
}

impl<'m> Pipeline<'m> {
    /// A pipeline that waits for a frame's first line. `memory` may be longer than [`Settings::memory`], the rest is not
    /// used.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if the memory is too short, [`Error::ZeroSize`] for a frame without pixels,
    /// [`Error::Parameter`] for a RAW format, a threshold or a palette that cannot be.
    pub fn new(settings: Settings<'m>, memory: &'m mut [u32]) -> Result<Self, Error> {
        let (expected, got) = (settings.memory(), memory.len());
        if settings.width == 0 || settings.height == 0 {
            return Err(Error::ZeroSize { width: settings.width, height: settings.height });
        }
        if got < expected {
            return Err(Error::BufferLength { name: "memory", expected, got });
        }
        let mut memory = Memory::new(memory);
        let pixels = memory.pixels(settings.width)?;
        // What the format cannot do shows now, not at the first line.
        settings.format.decode_line(&[], &mut [], &settings.meaning)?;
        let light = match settings.balance {
            Balance::Off => None,
            Balance::GrayWorld => Some(Light::new()?),
        };
        let tail = Tail::new(settings.output, settings.width, settings.height, &mut memory)?;
        Ok(Self { format: settings.format, meaning: settings.meaning, light, pixels, tail })
    }

    /// Goes on with the light that an earlier pipeline has seen, if both balance.
    #[must_use]
    pub fn lit(mut self, light: Option<Light>) -> Self {
        self.light = self.light.map(|dark| light.unwrap_or(dark));
        self
    }

    /// The light as the frames so far have shown it; `None` if light is not evened out.
    #[must_use]
    pub fn light(&self) -> Option<Light> {
        self.light
    }

    /// Takes the next line as the camera delivered it, and hands on what it completes.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if it is not as long as a line of the format; it is then not taken.
    pub fn push(&mut self, line: &[u8], sink: &mut impl FnMut(Product<'_>)) -> Result<(), Error> {
        self.format.decode_line(line, self.pixels, &self.meaning)?;
        if let Some(light) = &mut self.light {
            light.balance(self.pixels);
        }
        self.tail.push(self.pixels, sink)
    }

    /// The frame has ended: hands on what is still held, and is ready for the next one.
    pub fn finish(&mut self, sink: &mut impl FnMut(Product<'_>)) {
        if let Some(light) = &mut self.light {
            light.frame_ended();
        }
        self.tail.finish(sink);
    }
}
