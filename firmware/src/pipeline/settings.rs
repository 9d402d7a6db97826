//! What is wanted of a pipeline, and the memory that it takes.

use algos_nostd::edges::gradient::Sobel;
use algos_nostd::edges::measure::{L1, Saturated};
use algos_nostd::edges::smooth::{Gaussian3, Gaussian5, NoSmoothing};
use algos_nostd::edges::{CannyLines, GradientFilter, Thresholds, words_a_map};
use algos_nostd::filter::{Gaussian3Filter, Gaussian5Filter};
use algos_nostd::image::Rgb;
use algos_nostd::pixel::format::{Format, Meaning};
use algos_nostd::quantize::{InverseMap, Probe};

/// Bits a channel of the palette's inverse map.
pub(super) const MAP_BITS: u32 = 4;

/// How light is evened out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Balance {
    /// Not at all.
    Off,
    /// By the mean of the frames before, which is taken for gray.
    GrayWorld,
}

/// How gray is smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothing {
    /// Not at all.
    None,
    /// Gaussian of 3 × 3 pixels, 1 2 1 squared.
    Gaussian3,
    /// Gaussian of 5 × 5 pixels, σ = 1.4.
    Gaussian5,
}

/// Colours to quantize to.
#[derive(Debug)]
pub struct Palette<'m> {
    /// 1 to 256 colours.
    pub colors: &'m [Rgb],
    /// As many.
    pub probes: &'m mut [Probe],
}

/// What comes out.
#[derive(Debug)]
pub enum Output<'m> {
    /// The balanced picture.
    Color,
    /// Its indices into a palette.
    Palette(Palette<'m>),
    /// Its gray.
    Gray(Smoothing),
    /// The magnitude of Sobel's gradient of the gray, L1, 255 at most.
    Sobel(Smoothing),
    /// Canny's edges of the gray.
    Canny(Smoothing, Thresholds),
}

/// What a pipeline is to do: chosen once, at start-up.
#[derive(Debug)]
pub struct Settings<'m> {
    /// Pixels a line.
    pub width: usize,
    /// Lines a frame. Only Canny's maps depend on it.
    pub height: usize,
    /// What the camera's bytes mean; a format of whole pixels.
    pub format: Format,
    /// What the format's name leaves open.
    pub meaning: Meaning,
    /// White balance.
    pub balance: Balance,
    /// What comes out.
    pub output: Output<'m>,
}

impl Settings<'_> {
    /// RGB888 in, the same out, unbalanced; everything can be set afterwards.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let (format, meaning) = (Format::Rgb888, Meaning::default());
        Self { width, height, format, meaning, balance: Balance::Off, output: Output::Color }
    }

    /// Words of memory that these settings take.
    #[must_use]
    pub const fn memory(&self) -> usize {
        match &self.output {
            Output::Color => pixels(self.width),
            Output::Palette(_) => Self::palette_memory(self.width),
            Output::Gray(smoothing) => pixels(self.width)
                .saturating_add(bytes(self.width))
                .saturating_add(smooth(self.width, *smoothing)),
            Output::Sobel(_) => Self::sobel_memory(self.width),
            Output::Canny(..) => Self::canny_memory(self.width, self.height),
        }
    }

    /// Words that suffice for [`Output::Palette`].
    #[must_use]
    pub const fn palette_memory(width: usize) -> usize {
        pixels(width).saturating_add(bytes(width)).saturating_add(InverseMap::<MAP_BITS>::cells())
    }

    /// Words that suffice for [`Output::Sobel`], whatever the smoothing.
    #[must_use]
    pub const fn sobel_memory(width: usize) -> usize {
        let gradient = bytes(GradientFilter::<Sobel, Saturated<L1>>::memory(width));
        pixels(width)
            .saturating_add(bytes(width).saturating_mul(2))
            .saturating_add(smooth(width, Smoothing::Gaussian5))
            .saturating_add(gradient)
    }

    /// Words that suffice for [`Output::Canny`], whatever the smoothing.
    #[must_use]
    pub const fn canny_memory(width: usize, height: usize) -> usize {
        pixels(width)
            .saturating_add(bytes(width))
            .saturating_add(canny_lines(width))
            .saturating_add(words_a_map(width, height).saturating_mul(2))
    }
}

/// Words of a line of pixels.
const fn pixels(width: usize) -> usize {
    bytes(width.saturating_mul(3))
}

/// Words that hold so many bytes.
pub(super) const fn bytes(length: usize) -> usize {
    length.div_ceil(4)
}

/// Words of a smoothing filter.
pub(super) const fn smooth(width: usize, smoothing: Smoothing) -> usize {
    match smoothing {
        Smoothing::None => 0,
        Smoothing::Gaussian3 => bytes(Gaussian3Filter::memory(width)),
        Smoothing::Gaussian5 => bytes(Gaussian5Filter::memory(width)),
    }
}

/// Words of the line part of Canny: the most that any smoothing takes.
const fn canny_lines(width: usize) -> usize {
    let sizes = [
        CannyLines::<NoSmoothing>::memory(width),
        CannyLines::<Gaussian3>::memory(width),
        CannyLines::<Gaussian5>::memory(width),
    ];
    let (mut most, mut index) = (0, 0);
    while index < sizes.len() {
        if sizes[index] > most {
            most = sizes[index];
        }
        index += 1;
    }
    most
}
