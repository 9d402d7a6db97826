use std::time::Duration;

use algos_nostd::pixel::yuv422::{Coefficients, Matrix, Range};
use v4l2_capture::FourCc;

use super::CaptureError;

/// A camera that was chosen, set and started.
///
/// Frames are lent out in the memory that the device wrote; the device has it back when the frame is dropped.
pub trait CaptureDevice {
    /// What was settled when it started.
    fn opened(&self) -> &Opened;

    /// Buffers that the device has at the moment, to be filled.
    fn buffers(&self) -> usize;

    /// Waits for a frame, no longer than `timeout`; `None` if none came.
    ///
    /// # Errors
    /// If the device is gone or has stopped.
    fn next(&mut self, timeout: Duration) -> Result<Option<Box<dyn Captured>>, CaptureError>;
}

/// What is settled when a camera starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// What to call it: the path of a V4L2 device, the name of a camera of libcamera.
    pub name: String,
    /// What its frames are.
    pub format: FrameFormat,
    /// What was asked for and not granted, for people.
    pub notes: Vec<String>,
}

impl Opened {
    /// The camera was unplugged.
    pub(super) fn gone(&self) -> CaptureError {
        CaptureError::Gone { device: self.name.clone(), frames: 0 }
    }

    /// The camera has stopped, for this reason.
    pub(super) fn stopped(&self, what: String) -> CaptureError {
        CaptureError::Stopped { device: self.name.clone(), frames: 0, what }
    }
}

/// A frame in the memory of its device.
pub trait Captured: Send {
    /// The bytes of each piece of memory, as many as the device wrote.
    fn planes(&self) -> Vec<&[u8]>;

    /// Frames that the device has taken before this one; after 2³²−1 comes 0.
    fn sequence(&self) -> u32;

    /// Whether the device says that the data is damaged.
    fn is_damaged(&self) -> bool;
}

/// What the frames of a device are.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameFormat {
    /// The pixel format, by V4L2's code.
    pub code: FourCc,
    /// Pixels a line.
    pub width: u32,
    /// Lines.
    pub height: u32,
    /// Bytes from the start of a line to the start of the next, of each piece of memory.
    pub strides: Vec<u32>,
    /// How its YUV is meant.
    pub yuv: YuvMeaning,
    /// Frames a second, if the device says.
    pub rate: Option<f64>,
}

/// How YUV, or hue, is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct YuvMeaning {
    /// The coefficients of luma.
    pub matrix: Matrix,
    /// Which codes are black and white.
    pub range: Range,
    /// Hue goes to 255, and not in steps of two degrees to 179.
    pub whole_hue: bool,
}

impl Default for YuvMeaning {
    /// BT.601 in limited range.
    fn default() -> Self {
        Self { matrix: Matrix::Bt601, range: Range::Limited, whole_hue: false }
    }
}

impl YuvMeaning {
    pub(super) fn coefficients(self) -> Coefficients {
        Coefficients::new(self.matrix, self.range)
    }
}

impl FrameFormat {
    /// Width and height as lengths.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width as usize, self.height as usize)
    }
}

/// What a device is asked for. What is left open is the device's choice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Width and height, in pixels.
    pub size: Option<(u32, u32)>,
    /// Pixel format, by V4L2's code.
    pub code: Option<FourCc>,
    /// Frames a second.
    pub rate: Option<f64>,
    /// The connector, of devices that have several.
    pub input: Option<u32>,
    /// The part of the sensor's picture: left, top, width, height.
    pub crop: Option<(i32, i32, u32, u32)>,
    /// Controls and their values, in this order; of menus the item's number or name.
    pub controls: Vec<(String, String)>,
    /// Buffers.
    pub buffers: u32,
}

/// A camera that could be captured from.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Found {
    /// How to choose it: `v4l2` or `libcamera`.
    pub interface: &'static str,
    /// The path or name by which it is chosen.
    pub id: String,
    /// Its name, for people.
    pub name: String,
    /// Its driver and place.
    pub place: String,
    /// Its connectors, where there are several to choose from.
    pub inputs: Vec<String>,
    /// Whether frames come only after its way from the sensor is set up, which libcamera does.
    pub media_controlled: bool,
    /// Least and greatest frames a second, of a camera that takes any between at the size that it is set to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rates: Option<(f64, f64)>,
    /// What it offers.
    pub formats: Vec<FoundFormat>,
}

/// A pixel format that a camera offers.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct FoundFormat {
    /// Its code.
    pub code: String,
    /// Its name, for people.
    pub name: String,
    /// Whether it becomes a picture; others are captured as raw bytes.
    pub picture: bool,
    /// What sizes there are, and how many frames a second of each, most first.
    pub sizes: Vec<FoundSize>,
}

/// A size that a camera offers.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct FoundSize {
    /// Pixels a line.
    pub width: u32,
    /// Lines.
    pub height: u32,
    /// If it is the least of a range, the greatest width and height.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up_to: Option<(u32, u32)>,
    /// Frames a second, most first; none if the device does not say.
    pub rates: Vec<f64>,
}

impl FoundSize {
    /// Whether this size can be asked for.
    #[cfg(feature = "libcamera")]
    pub(super) fn contains(&self, (width, height): (u32, u32)) -> bool {
        let (most_width, most_height) = self.up_to.unwrap_or((self.width, self.height));
        (self.width..=most_width).contains(&width) && (self.height..=most_height).contains(&height)
    }
}
