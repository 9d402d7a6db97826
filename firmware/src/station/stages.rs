//! Which stages make the second stream: the pipelines that the device can run, from text and back.
//!
//! ```text
//! [balance|]                                                    colour
//! [balance|]palette                                             indices of sixteen fixed colours
//! [balance|]gray[|gaussian:size=3 or 5]                         gray
//! [balance|]gray[|gaussian:…]|sobel                             magnitudes
//! [balance|]gray[|gaussian:…]|canny:low=50,high=150,norm=l2     a map of edges
//! ```
//!
//! The words are those of `host-sim process --op`, as far as the device's pipeline goes; `palette` is its own.

use core::fmt;

use algos_nostd::image::Rgb;
use algos_nostd::pixel::format::Meaning;
use algos_nostd::pixel::yuv422::Coefficients;
use algos_nostd::quantize::Probe;

use super::control::Picture;
use crate::link::{Format, packet};
use crate::pipeline::{Balance, Norm, Output, Palette, Settings, Smoothing, Thresholds};

/// The greatest threshold: Sobel's gradient of a step from black to white, L1.
const MOST: i32 = 2_040;

/// The palette's colours: the corners of the cube, the same at half the light, and a light gray.
pub static COLORS: [Rgb; 16] = {
    let mut colors = [Rgb { r: 192, g: 192, b: 192 }; 16];
    let mut index = 0;
    while index < 16 {
        if index != 8 {
            let level = if index < 8 { 128 } else { 255 };
            let channel = [0, level];
            colors[index] =
                Rgb { r: channel[index & 1], g: channel[index >> 1 & 1], b: channel[index >> 2 & 1] };
        }
        index += 1;
    }
    colors
};

/// What comes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// The picture.
    Color,
    /// Its indices of [`COLORS`].
    Palette,
    /// Its gray.
    Gray(Smoothing),
    /// The gradient's magnitude.
    Sobel(Smoothing),
    /// Edges.
    Canny(Smoothing, Thresholds),
}

/// The stages of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stages {
    /// Whether light is evened out.
    pub balance: bool,
    /// What comes out.
    pub made: Made,
}

impl Stages {
    /// What a device begins with, if it has the memory: balance, gray, Gaussian, Canny.
    pub const START: Self = Self {
        balance: true,
        made: Made::Canny(Smoothing::Gaussian5, Thresholds { low: 50, high: 150, norm: Norm::L2 }),
    };
    /// What takes the least memory: the picture.
    pub const COLOR: Self = Self { balance: false, made: Made::Color };

    /// Words of memory that suffice for any stages of pictures of this size.
    #[must_use]
    pub const fn memory(width: usize, height: usize) -> usize {
        let sizes = [
            Settings::palette_memory(width),
            Settings::sobel_memory(width),
            Settings::canny_memory(width, height),
        ];
        let mut most = sizes[0];
        let mut index = 1;
        while index < sizes.len() {
            if sizes[index] > most {
                most = sizes[index];
            }
            index += 1;
        }
        most
    }

    /// Reads a pipeline.
    ///
    /// # Errors
    /// [`StageError`] with the stage that the device can't do there.
    pub fn read(text: &str) -> Result<Self, StageError<'_>> {
        let mut stages = Self::COLOR;
        for (place, stage) in text.split('|').map(str::trim).filter(|stage| !stage.is_empty()).enumerate() {
            let (name, arguments) = stage.split_once(':').unwrap_or((stage, ""));
            let refused = StageError { stage };
            let bare = if arguments.is_empty() { Ok(()) } else { Err(refused) };
            stages.made = match (name.trim(), stages.made) {
                ("balance", Made::Color) if place == 0 && matches!(arguments, "" | "gray-world") => {
                    stages.balance = true;
                    Made::Color
                }
                ("palette", Made::Color) => bare.map(|()| Made::Palette)?,
                ("gray", Made::Color) => bare.map(|()| Made::Gray(Smoothing::None))?,
                ("gaussian", Made::Gray(Smoothing::None)) => Made::Gray(smoothing(arguments).ok_or(refused)?),
                ("sobel", Made::Gray(smoothing)) if matches!(arguments, "" | "norm=l1") => {
                    Made::Sobel(smoothing)
                }
                ("canny", Made::Gray(smoothing)) => {
                    Made::Canny(smoothing, thresholds(arguments).ok_or(refused)?)
                }
                _ => return Err(refused),
            };
        }
        Ok(stages)
    }

    /// The format of what comes out.
    #[must_use]
    pub const fn format(&self) -> Format {
        match self.made {
            Made::Color => Format::RGB888,
            Made::Palette => Format::Index8,
            Made::Gray(_) | Made::Sobel(_) | Made::Canny(..) => Format::GRAY8,
        }
    }

    /// Words of memory that these stages take for pictures of this size.
    #[must_use]
    pub fn needs(&self, width: usize, height: usize) -> usize {
        match self.made {
            Made::Palette => Settings::palette_memory(width),
            Made::Color => Settings { output: Output::Color, ..Settings::new(width, height) }.memory(),
            Made::Gray(smoothing) => {
                Settings { output: Output::Gray(smoothing), ..Settings::new(width, height) }.memory()
            }
            Made::Sobel(_) => Settings::sobel_memory(width),
            Made::Canny(..) => Settings::canny_memory(width, height),
        }
    }

    /// What the pipeline is told for these pictures; `None` if their format is not one of whole pixels. `probes` is a
    /// palette's memory.
    #[must_use]
    pub fn settings<'m>(
        &self,
        picture: &Picture,
        probes: &'m mut [Probe; COLORS.len()],
    ) -> Option<Settings<'m>> {
        let Picture { width, height, format: Format::Pixels(format), .. } = *picture else { return None };
        let output = match self.made {
            Made::Color => Output::Color,
            Made::Palette => Output::Palette(Palette { colors: &COLORS, probes }),
            Made::Gray(smoothing) => Output::Gray(smoothing),
            Made::Sobel(smoothing) => Output::Sobel(smoothing),
            Made::Canny(smoothing, thresholds) => Output::Canny(smoothing, thresholds),
        };
        let packet::Meaning { bayer, matrix, range } = picture.meaning;
        let mut settings = Settings::new(width.into(), height.into());
        settings.format = format;
        settings.meaning = Meaning { yuv: Coefficients::new(matrix, range), bayer };
        settings.balance = if self.balance { Balance::GrayWorld } else { Balance::Off };
        settings.output = output;
        Some(settings)
    }
}

impl fmt::Display for Stages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gray = |smoothing| match smoothing {
            Smoothing::None => "gray",
            Smoothing::Gaussian3 => "gray|gaussian:size=3",
            Smoothing::Gaussian5 => "gray|gaussian:size=5,sigma=1.4",
        };
        let rest = match self.made {
            Made::Color => "",
            Made::Palette => "palette",
            Made::Gray(smoothing) | Made::Sobel(smoothing) | Made::Canny(smoothing, _) => gray(smoothing),
        };
        f.write_str(if self.balance { "balance:gray-world" } else { "" })?;
        f.write_str(if self.balance && !rest.is_empty() { "|" } else { "" })?;
        f.write_str(rest)?;
        match self.made {
            Made::Sobel(_) => f.write_str("|sobel"),
            Made::Canny(_, Thresholds { low, high, norm }) => {
                let norm = if norm == Norm::L1 { "l1" } else { "l2" };
                write!(f, "|canny:low={low},high={high},norm={norm}")
            }
            Made::Color | Made::Palette | Made::Gray(_) => Ok(()),
        }
    }
}

/// A stage that the device can't do, or not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageError<'t> {
    /// As it was written.
    pub stage: &'t str,
}

impl fmt::Display for StageError<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "not `{}` here; [balance|]palette or [balance|]gray[|gaussian:size=3 or 5][|sobel or canny:low=,high=,norm=l1 or l2]",
            self.stage
        )
    }
}

fn smoothing(arguments: &str) -> Option<Smoothing> {
    match arguments {
        "" | "size=3" => Some(Smoothing::Gaussian3),
        "size=5" | "size=5,sigma=1.4" => Some(Smoothing::Gaussian5),
        _ => None,
    }
}

fn thresholds(arguments: &str) -> Option<Thresholds> {
    let mut thresholds = Thresholds { low: 50, high: 150, norm: Norm::L2 };
    for part in arguments.split(',').filter(|part| !part.is_empty()) {
        let level = |text: &str| text.parse().ok().filter(|level| (0..=MOST).contains(level));
        match part.split_once('=')? {
            ("low", text) => thresholds.low = level(text)?.try_into().ok()?,
            ("high", text) => thresholds.high = level(text)?.try_into().ok()?,
            ("norm", "l1") => thresholds.norm = Norm::L1,
            ("norm", "l2") => thresholds.norm = Norm::L2,
            _ => return None,
        }
    }
    (thresholds.low <= thresholds.high).then_some(thresholds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_written_the_same() {
        for text in [
            "",
            "palette",
            "balance:gray-world",
            "balance:gray-world|palette",
            "gray",
            "gray|gaussian:size=3",
            "gray|gaussian:size=5,sigma=1.4|sobel",
            "balance:gray-world|gray|canny:low=20,high=70,norm=l1",
        ] {
            assert_eq!(Stages::read(text).unwrap().to_string(), text);
        }
        assert_eq!(
            Stages::read(" balance | gray|gaussian|canny ").unwrap().to_string(),
            "balance:gray-world|gray|gaussian:size=3|canny:low=50,high=150,norm=l2"
        );
        assert_eq!(Stages::read(&Stages::START.to_string()), Ok(Stages::START));
    }

    #[test]
    fn what_the_device_cannot_do_is_quoted() {
        for (text, stage) in [
            ("gray|median", "median"),
            ("sobel", "sobel"),
            ("gray|balance", "balance"),
            ("gray|gaussian:size=7", "gaussian:size=7"),
            ("gray|canny:low=9,high=3", "canny:low=9,high=3"),
            ("gray|canny:low=9,high=2041", "canny:low=9,high=2041"),
            ("gray|sobel|canny", "canny"),
            ("palette|gray", "gray"),
            ("gray:x", "gray:x"),
        ] {
            assert_eq!(Stages::read(text), Err(StageError { stage }), "{text}");
        }
    }
}
