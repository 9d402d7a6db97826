use std::collections::HashMap;

use algos_nostd::pixel::rgb888;

use firmware::driver::verdict::Verdict;
use firmware::link::packet::{FrameStart, Meaning};
use firmware::link::{Choice, Format};

use crate::picture;
use crate::pipeline::{Frame, Picture, Pipeline, PipelineError, Runner};
use crate::profile::Profile;

/// The streams of a device: name, and the pipeline that it begins with.
pub const STREAMS: [(&str, &str); 3] = [
    ("raw", ""),
    ("edges", "gray|canny:low=50,high=150"),
    ("palette", "quantize:median-cut,colors=16,dither=floyd-steinberg"),
];

/// Colours of a palette.
pub(super) type Palette = Vec<[u8; 3]>;

/// Why a stream can't be made so.
#[derive(Debug, thiserror::Error)]
pub(super) enum StagesError {
    /// The text is no pipeline.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// STREAM has no room for it.
    #[error("a pipeline has at most 255 bytes, not {0}")]
    TooLong(usize),
}

/// A stream: what it makes of each frame, and how it sends that.
pub(super) struct Stream {
    pub(super) name: &'static str,
    /// The pipeline as understood; empty: the frame as captured.
    pub(super) text: String,
    runner: Option<Runner<'static>>,
    /// The last stage gives few colours: what leaves are places in their palette.
    indexed: bool,
    pub(super) choice: Choice,
    pub(super) on: bool,
    /// Format, width and height of its frames.
    pub(super) shape: (Format, u16, u16),
    pub(super) palette: Option<Palette>,
}

/// A frame as captured.
pub(super) struct Capture<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) verdict: Verdict,
    pub(super) sequence: u32,
    pub(super) snapshot: bool,
    /// Microseconds since the start.
    pub(super) at: u64,
}

/// A frame of a stream, ready to be sent.
pub(super) struct Prepared {
    pub(super) start: FrameStart,
    pub(super) choice: Choice,
    pub(super) bytes: Vec<u8>,
    pub(super) palette: Option<Palette>,
}

impl Prepared {
    /// The lines that there are: whole ones.
    pub(super) fn line(&self, number: u16) -> Option<&[u8]> {
        let size = self.start.format.line_bytes(self.start.width.into());
        self.bytes.get(usize::from(number) * size..)?.get(..size)
    }

    /// How many.
    pub(super) fn lines(&self) -> u16 {
        (0..self.start.height).find(|&line| self.line(line).is_none()).unwrap_or(self.start.height)
    }
}

/// Indices of a picture's colours, and the palette in order; `None` if they are more than 256.
fn indexed(frame: &Frame<rgb::RGB8>) -> Option<(Vec<u8>, Palette)> {
    let mut colors: Vec<[u8; 3]> = Vec::new();
    let mut last = None;
    for &pixel in frame.pixels() {
        if last != Some(pixel) && !colors.contains(&pixel.into()) {
            colors.push(pixel.into());
            if colors.len() > 256 {
                return None;
            }
        }
        last = Some(pixel);
    }
    colors.sort_unstable();
    let places: HashMap<[u8; 3], u8> = colors.iter().copied().zip(0..=255).collect();
    let mut last = ([0; 3], places.get(&[0; 3]).copied().unwrap_or(0));
    let place = |pixel: &rgb::RGB8| {
        let color = (*pixel).into();
        if last.0 != color {
            last = (color, places.get(&color).copied().unwrap_or(0));
        }
        last.1
    };
    Some((frame.pixels().iter().map(place).collect(), colors))
}

fn palette_crc(palette: Option<&Palette>) -> u32 {
    palette.map_or(0, |colors| picture::crc32(colors.as_flattened()))
}

impl Stream {
    /// Of frames of this profile.
    pub(super) fn new(name: &'static str, stages: &str, profile: &Profile) -> Result<Self, StagesError> {
        let mut stream = Self {
            name,
            text: String::new(),
            runner: None,
            indexed: false,
            choice: Choice::Sender,
            on: true,
            shape: raw_shape(profile),
            palette: None,
        };
        stream.choose(stages, profile)?;
        Ok(stream)
    }

    /// Makes it by another pipeline from now on. Tried on a black picture first, so that one that can't run is refused.
    pub(super) fn choose(&mut self, stages: &str, profile: &Profile) -> Result<(), StagesError> {
        let stages = stages.trim();
        if stages.is_empty() {
            (self.text, self.runner, self.indexed) = (String::new(), None, false);
            (self.shape, self.palette) = (raw_shape(profile), None);
            return Ok(());
        }
        let pipeline: Pipeline = stages.parse()?;
        let text = pipeline.to_string();
        if text.len() > 255 {
            return Err(StagesError::TooLong(text.len()));
        }
        let indexed = text.rsplit('|').next().is_some_and(|stage| stage.starts_with("quantize"));
        let (width, height) = (profile.frame.width, profile.frame.height);
        let black = Picture::from_image(&image::RgbImage::new(width, height));
        let tried = Runner::new(&pipeline).run(black)?;
        let (width, height) = tried.size();
        let format = match tried {
            Picture::Gray(_) => Format::GRAY8,
            Picture::Rgb(_) if indexed => Format::Index8,
            Picture::Rgb(_) => Format::RGB888,
        };
        self.shape = (format, width as u16, height as u16);
        (self.text, self.runner, self.indexed) = (text, Some(Runner::owning(pipeline)), indexed);
        self.palette = None;
        Ok(())
    }

    /// What of the format is left open.
    pub(super) fn meaning(&self, profile: &Profile) -> Meaning {
        let bayer = profile.frame.bayer;
        if self.text.is_empty() { Meaning { bayer, ..Meaning::default() } } else { Meaning::default() }
    }

    /// Makes its frame of a captured one. Of a frame that is not whole only the lines as captured are sent.
    pub(super) fn prepare(
        &mut self,
        number: u8,
        capture: &Capture<'_>,
        profile: &Profile,
    ) -> Result<Prepared, PipelineError> {
        let meaning = self.meaning(profile);
        let bytes = match &mut self.runner {
            None => capture.bytes.to_vec(),
            Some(_) if !capture.verdict.outcome.is_good() => Vec::new(),
            Some(runner) => {
                let seen = picture::decode(capture.bytes, profile).picture;
                let made = runner.run(Picture::from_image(&seen))?;
                let (width, height) = made.size();
                let (format, bytes) = match made {
                    Picture::Gray(frame) => (Format::GRAY8, frame.pixels().to_vec()),
                    Picture::Rgb(frame) => match self.indexed.then(|| indexed(&frame)).flatten() {
                        Some((indices, palette)) => {
                            self.palette = Some(palette);
                            (Format::Index8, indices)
                        }
                        None => (Format::RGB888, rgb888::as_bytes(frame.pixels()).to_vec()),
                    },
                };
                self.shape = (format, width as u16, height as u16);
                bytes
            }
        };
        let (format, width, height) = self.shape;
        let palette = self.palette.clone().filter(|_| format == Format::Index8);
        let start = FrameStart {
            stream: number,
            format,
            meaning,
            snapshot: capture.snapshot,
            sequence: capture.sequence,
            width,
            height,
            captured: capture.at,
            palette: palette_crc(palette.as_ref()),
        };
        Ok(Prepared { start, choice: self.choice, bytes, palette })
    }
}

fn raw_shape(profile: &Profile) -> (Format, u16, u16) {
    // A profile's sides are 8,192 at most.
    (Format::Pixels(profile.frame.format), profile.frame.width as u16, profile.frame.height as u16)
}
