use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};
use serde::Serialize;

use super::waves::Wave;
use crate::diagnosis::Diagnosis;
use crate::receiver::Activity;

/// All that a report holds. Its JSON stands in the page, pictures apart.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Page {
    /// The trace file.
    pub trace: String,
    /// What came of it, in a few words.
    pub verdict: String,
    /// The same in a sentence.
    pub summary: String,
    /// Nothing is wrong.
    pub is_clean: bool,
    /// The profile's name.
    pub profile: String,
    /// The profile as TOML text.
    pub profile_toml: String,
    /// The bus, to draw it.
    pub bus: BusFacts,
    /// What the user should know of how it was read.
    pub notes: Vec<String>,
    /// What was found: the JSON of `diagnose --json`.
    pub diagnosis: Diagnosis,
    /// Where each finding shows, in the order of the diagnosis.
    pub places: Vec<FindingPlace>,
    /// The frames that came in.
    pub frames: Vec<FrameFacts>,
    /// Lines of the frames of the trace.
    pub cuts: Vec<Lines>,
    /// Waveforms.
    pub waves: Vec<Wave>,
    /// FIFO and DMA over time.
    pub activity: Option<Activity>,
    /// Words of the FIFO.
    pub fifo_words: usize,
    /// What else the trace may be.
    pub rivals: Vec<Rival>,
    /// Further pictures.
    pub illustrations: Vec<Illustration>,
    /// The pictures, which stand in the page itself.
    #[serde(skip)]
    pub pictures: Vec<Shot>,
}

/// The bus of the profile.
#[derive(Clone, Debug, Default, Serialize)]
#[expect(missing_docs, reason = "the names are those of profile::Bus and Frame")]
pub struct BusFacts {
    pub bits: u32,
    pub sync: &'static str,
    pub clock_edge: &'static str,
    pub hsync_blank_high: bool,
    pub vsync_blank_high: bool,
    pub pclk_hz: u32,
    pub width: u32,
    pub height: u32,
    pub samples_per_line: u32,
    pub clocks_per_line: u64,
}

/// Where a finding shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FindingPlace {
    /// The pixel clock.
    pub clock: u64,
    /// The frame received, by its place in `frames`; nothing if it is in none.
    pub frame: Option<usize>,
    /// The row of that frame's picture.
    pub row: Option<u64>,
    /// It shows all over the frame, and the clock is that of its first sample.
    pub everywhere: bool,
}

/// A frame that came in.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FrameFacts {
    /// Its number.
    pub sequence: u32,
    /// The verdict of the driver.
    pub verdict: String,
    /// The driver found nothing wrong with it.
    pub is_good: bool,
    /// Bytes that came.
    pub bytes: u32,
    /// Lines that came.
    pub lines: u32,
    /// CRC-32 of its bytes.
    pub crc32: Option<u32>,
    /// The frame of the trace that it is, by its place in `cuts`.
    pub cut: Option<usize>,
    /// Its picture by its place among the page's; nothing where there is none.
    pub picture: Option<usize>,
    /// The pixel clock at which each row of the picture begins; nothing for rows that did not come.
    pub row_clocks: Vec<Option<u64>>,
}

/// Lines of a frame of the trace.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Lines {
    /// The pixel clock of each line's first sample.
    pub start: Vec<u64>,
    /// Samples of each line.
    pub samples: Vec<u64>,
}

/// A reading of the trace, as a picture.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Rival {
    /// Its name.
    pub name: String,
    /// Why it may be.
    pub about: String,
    /// How sure, 0 to 1, on the scale of whoever says it.
    pub confidence: Option<f64>,
    /// Who says it: `given`, `received`, `finding`, `look-alike` or `guess`.
    pub by: &'static str,
    /// The profile's key or what else would be changed.
    pub setting: Option<String>,
    /// The picture by its place among the page's.
    pub picture: usize,
}

/// A further picture, with its caption.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Illustration {
    /// What it is.
    pub about: String,
    /// How it was made.
    pub how: String,
    /// The picture by its place among the page's.
    pub picture: usize,
}

/// A picture as it stands in the page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Shot {
    /// Pixels a line.
    pub width: u32,
    /// Lines.
    pub height: u32,
    /// A PNG file in Base64.
    pub png: String,
}

impl Shot {
    /// A picture.
    #[must_use]
    pub fn of(picture: &RgbImage) -> Self {
        let mut png = Vec::new();
        let (width, height) = picture.dimensions();
        // Writing to memory fails for lengths that do not fit the size alone, and an image's do.
        let _ = PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
            .write_image(picture.as_raw(), width, height, ExtendedColorType::Rgb8);
        Self { width, height, png: STANDARD.encode(png) }
    }
}

impl Page {
    /// Adds a picture and tells its place; one that is there already is not added again.
    pub fn add(&mut self, picture: &RgbImage) -> usize {
        let shot = Shot::of(picture);
        self.pictures.iter().position(|known| *known == shot).unwrap_or_else(|| {
            self.pictures.push(shot);
            self.pictures.len() - 1
        })
    }
}
