//! What is done with good frames: files, pipelines, a trace.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use image::RgbImage;
use serde::Serialize;

use super::CaptureError;
use super::convert::{Converter, FrameFault};
use super::device::FrameFormat;
use super::layout::Layout;
use crate::picture::{self, write_pieces};
use crate::pipeline::{Picture, Pipeline, Runner};
use crate::profile::Profile;
use crate::scene::Still;
use crate::sensor::Sensor;
use crate::trace::vcd::VcdWriterOptions;
use crate::trace::{Created, TraceWriter, TraceWriterOptions, create};

/// Which files a frame becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Files {
    /// A PNG picture.
    pub png: bool,
    /// The bytes, or the JPEG picture as it came.
    pub raw: bool,
}

/// Where good frames go.
#[derive(Debug)]
pub struct Output<'a> {
    device: String,
    format: FrameFormat,
    converter: Converter,
    folder: Option<(PathBuf, Files)>,
    runner: Option<Runner<'a>>,
    trace: Option<Trace>,
    frames: u64,
    written: Vec<Written>,
    copied_bytes: u64,
    converted_bytes: u64,
}

#[derive(Debug)]
struct Trace {
    sensor: Sensor,
    writer: TraceWriter,
}

/// A frame in files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Written {
    /// Its number in the output, from 0.
    pub frame: u64,
    /// The device's number.
    pub sequence: u32,
    /// CRC-32 (IEEE) of the raw bytes.
    pub crc32: u32,
    /// The picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub png: Option<PathBuf>,
    /// The bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raw: Option<PathBuf>,
    /// The picture as the pipeline made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub op_png: Option<PathBuf>,
}

/// Files that are listed one by one; of an endless capture the first ones.
const LISTED: usize = 1000;

impl<'a> Output<'a> {
    /// For frames of a device that are so.
    #[must_use]
    pub fn new(device: &str, format: &FrameFormat) -> Self {
        Self {
            device: device.to_owned(),
            format: format.clone(),
            converter: Converter::new(format),
            folder: None,
            runner: None,
            trace: None,
            frames: 0,
            written: Vec::new(),
            copied_bytes: 0,
            converted_bytes: 0,
        }
    }

    /// Writes `frame-0000.png` and the others to a folder, which is made.
    ///
    /// # Errors
    /// [`CaptureError::Folder`].
    pub fn to_folder(mut self, folder: &Path, files: Files) -> Result<Self, CaptureError> {
        std::fs::create_dir_all(folder)
            .map_err(|error| CaptureError::Folder { path: folder.to_owned(), error })?;
        self.folder = Some((folder.to_owned(), files));
        Ok(self)
    }

    /// Sends each picture through these stages and writes `frame-0000-op.png` to the folder.
    #[must_use]
    pub fn through(mut self, pipeline: &'a Pipeline) -> Self {
        self.runner = Some(Runner::new(pipeline));
        self
    }

    /// Plays each frame as a camera of this profile into a trace. A frame in the profile's format and size goes there byte
    /// by byte, another as a picture.
    ///
    /// # Errors
    /// If the profile is none, or the trace can't be begun.
    pub fn to_trace(mut self, path: &Path, profile: &Profile) -> anyhow::Result<Self> {
        let mut vcd = VcdWriterOptions::new(profile.bus.bits.try_into().unwrap_or(8), profile.timing.pclk_hz);
        vcd.edge = profile.bus.clock_edge;
        let options = TraceWriterOptions {
            vcd,
            vsync_active: profile.bus.vsync_blank.is_high(),
            profile: profile.to_toml(),
        };
        let writer = create(path, &options)?;
        self.trace = Some(Trace { sensor: Sensor::new(profile.clone())?, writer });
        Ok(self)
    }

    /// Whether there is anything to be done with a frame.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.folder.is_none() && self.trace.is_none()
    }

    /// What to tell the user of how frames get into the trace.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let frame = self.trace.as_ref()?.sensor.profile().frame;
        if self.goes_byte_by_byte() {
            return None;
        }
        let size = RgbImage::new(self.format.width, self.format.height);
        Still::new(PathBuf::from(&self.device), size).scaling_note(frame.width, frame.height)
    }

    /// Whether frames stand in memory as the trace's profile has them on the bus.
    fn goes_byte_by_byte(&self) -> bool {
        let Some(trace) = &self.trace else { return false };
        let frame = trace.sensor.profile().frame;
        let bus = Layout::of(self.format.code).and_then(Layout::as_bus);
        (frame.width, frame.height) == (self.format.width, self.format.height)
            && bus.is_some_and(|(format, order)| {
                format == frame.format && order.is_none_or(|order| order == frame.bayer)
            })
    }

    /// Bytes that were copied as they were.
    #[must_use]
    pub fn copied_bytes(&self) -> u64 {
        self.copied_bytes
    }

    /// Bytes of pictures made of frames.
    #[must_use]
    pub fn converted_bytes(&self) -> u64 {
        self.converted_bytes
    }

    /// The files, up to a thousand frames.
    #[must_use]
    pub fn written(&self) -> &[Written] {
        &self.written
    }

    /// Does all that is to be done with a frame. The inner error is of a frame that is no picture: there may be others.
    ///
    /// # Errors
    /// If it can't be written.
    pub fn take(&mut self, planes: &[&[u8]], sequence: u32) -> Result<Result<(), FrameFault>, CaptureError> {
        let direct = self.goes_byte_by_byte();
        let files = self.folder.as_ref().map_or(Files { png: false, raw: false }, |(_, files)| *files);
        let bus = if files.raw || direct { self.converter.as_bus(planes) } else { None };
        if let Some(Cow::Owned(bytes)) = &bus {
            self.copied_bytes += bytes.len() as u64;
        }
        let needs_picture = files.png || self.runner.is_some() || (self.trace.is_some() && !direct);
        let picture = if needs_picture {
            match self.converter.picture(planes) {
                Ok(picture) => Some(picture),
                Err(FrameFault::Unknown(code)) => {
                    let what = FrameFault::Unknown(code).to_string();
                    return Err(CaptureError::Frame {
                        device: self.device.clone(),
                        frame: self.frames,
                        what,
                    });
                }
                Err(fault) => return Ok(Err(fault)),
            }
        } else {
            None
        };
        self.converted_bytes += picture.map_or(0, |picture| picture.as_raw().len() as u64);
        let fault =
            |what: String| CaptureError::Frame { device: self.device.clone(), frame: self.frames, what };
        if let Some((folder, _)) = &self.folder {
            let name = |rest: &str| folder.join(format!("frame-{:04}{rest}", self.frames));
            let mut written =
                Written { frame: self.frames, sequence, crc32: 0, png: None, raw: None, op_png: None };
            if let (true, Some(picture)) = (files.png, picture) {
                let path = name(".png");
                picture::write_png(&path, picture)?;
                written.png = Some(path);
            }
            if let (Some(runner), Some(picture)) = (&mut self.runner, picture) {
                let made =
                    runner.run(Picture::from_image(picture)).map_err(|error| fault(error.to_string()))?;
                let path = name("-op.png");
                picture::write_png(&path, &made.into_image())?;
                written.op_png = Some(path);
            }
            let whole;
            let pieces = match &bus {
                Some(bytes) => {
                    whole = [&bytes[..]];
                    &whole[..]
                }
                None => planes,
            };
            if files.raw {
                let jpeg = Layout::of(self.format.code) == Some(Layout::Jpeg);
                let path = name(if jpeg { ".jpg" } else { ".raw" });
                write_pieces(&path, pieces)?;
                written.crc32 = picture::crc32_of(pieces);
                written.raw = Some(path);
            }
            if self.written.len() < LISTED {
                self.written.push(written);
            }
        }
        if let Some(trace) = &mut self.trace {
            let bytes = match (&bus, picture) {
                (Some(bytes), _) if direct => Cow::Borrowed(&**bytes),
                (_, Some(picture)) => {
                    let frame = &trace.sensor.profile().frame;
                    let picture = Still::fit(picture, frame.width, frame.height);
                    Cow::Owned(trace.sensor.encode(&picture).map_err(|error| fault(error.to_string()))?)
                }
                _ => return Ok(Ok(())),
            };
            trace.sensor.play_frame_bytes(&bytes, &mut trace.writer).map_err(|error| match error {
                crate::sensor::PlayError::Sink(error) => CaptureError::Trace(error),
                other => fault(other.to_string()),
            })?;
        }
        self.frames += 1;
        Ok(Ok(()))
    }

    /// Ends the trace, if there is one. Without a frame there is none: nothing is left behind.
    ///
    /// # Errors
    /// If it can't be written.
    pub fn finish(self) -> Result<(Vec<Written>, Option<Created>), CaptureError> {
        let Some(mut trace) = self.trace else { return Ok((self.written, None)) };
        if self.frames == 0 {
            return Ok((self.written, None));
        }
        trace.sensor.close(&mut trace.writer).map_err(|error| match error {
            crate::sensor::PlayError::Sink(error) => CaptureError::Trace(error),
            other => CaptureError::Frame {
                device: self.device.clone(),
                frame: self.frames,
                what: other.to_string(),
            },
        })?;
        Ok((self.written, Some(trace.writer.finish()?)))
    }
}
