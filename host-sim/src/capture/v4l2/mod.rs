//! Cameras of the Linux kernel: USB webcams, frame grabbers, camera interfaces of systems on chip.
//!
//! | file | what lives there |
//! |---|---|
//! | `list` | which there are |
//! | `format` | pixel format, size, crop, rate |
//! | `control` | controls by name |
//! | `refusal` | errors with their remedies |

mod list;
mod format;
mod control;
mod refusal;

use std::path::Path;
use std::time::Duration;

use v4l2_capture::{Buffer, Device, Stream};

use super::device::{CaptureDevice, Captured, FrameFormat, Opened, Settings};
use super::error::CaptureError;
pub use control::{ControlValue, controls, set_control};
use format::{meaning, set_format, set_rate};
pub use list::{ADVICE, list};
use refusal::{open_error, refused, unknown};

/// A camera that streams.
#[derive(Debug)]
pub struct V4l2 {
    opened: Opened,
    stream: Stream,
}

/// Opens a device that captures.
///
/// # Errors
/// [`CaptureError::Open`] with what to do.
pub fn open(path: &Path) -> Result<Device, CaptureError> {
    match Device::open(path) {
        Ok(Some(device)) => Ok(device),
        Ok(None) => Err(CaptureError::Open {
            device: path.display().to_string(),
            what: "it does not capture frames".to_owned(),
            remedy: "`host-sim capture --list` says which devices do",
        }),
        Err(error) => Err(open_error(path, &error)),
    }
}

/// Takes a connector by its number.
///
/// # Errors
/// [`CaptureError::Unknown`] with those that there are, [`CaptureError::Refused`] with what the device says.
pub fn set_input(device: &Device, index: u32) -> Result<(), CaptureError> {
    let inputs = device.inputs().unwrap_or_default();
    if !inputs.iter().any(|input| input.index == index) {
        let names: Vec<String> =
            inputs.iter().map(|input| format!("{} ({})", input.index, input.name)).collect();
        return Err(unknown(device, "input", &index.to_string(), names.iter().map(String::as_str)));
    }
    device.set_input(index).map_err(|error| refused(device, format!("input {index}"), &error, "take another"))
}

impl V4l2 {
    /// Chooses, sets and starts a device.
    ///
    /// # Errors
    /// [`CaptureError`] with the setting that was refused, and what there is instead.
    pub fn start(path: &Path, settings: &Settings) -> Result<Self, CaptureError> {
        let device = open(path)?;
        let mut notes = Vec::new();
        if let Some(index) = settings.input {
            set_input(&device, index)?;
        }
        let format = set_format(&device, settings, &mut notes)?;
        let rate = set_rate(&device, settings, &mut notes)?;
        for (name, value) in &settings.controls {
            set_control(&device, name, value)?;
        }
        let stream = Stream::start(&device, settings.buffers).map_err(|error| {
            refused(&device, "streaming".to_owned(), &error, "take a smaller size, or see `dmesg`")
        })?;
        let format = FrameFormat {
            code: format.code,
            width: format.width,
            height: format.height,
            strides: format.planes.iter().map(|plane| plane.stride).collect(),
            yuv: meaning(&format),
            rate,
        };
        Ok(Self { opened: Opened { name: path.display().to_string(), format, notes }, stream })
    }
}

impl CaptureDevice for V4l2 {
    fn opened(&self) -> &Opened {
        &self.opened
    }

    fn buffers(&self) -> usize {
        self.stream.queued() as usize
    }

    fn next(&mut self, timeout: Duration) -> Result<Option<Box<dyn Captured>>, CaptureError> {
        match self.stream.next(timeout) {
            Ok(buffer) => Ok(buffer.map(|buffer| Box::new(buffer) as Box<dyn Captured>)),
            Err(error) if error.is_gone() => Err(self.opened.gone()),
            Err(error) => Err(self.opened.stopped(format!("{}: {}", error.request, error.source))),
        }
    }
}

impl Captured for Buffer {
    fn planes(&self) -> Vec<&[u8]> {
        Self::planes(self).collect()
    }

    fn sequence(&self) -> u32 {
        Self::sequence(self)
    }

    fn is_damaged(&self) -> bool {
        self.is_error()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_camera_is_said_with_a_remedy() {
        let said = |path| open(Path::new(path)).unwrap_err().to_string();
        assert!(said("/dev/video-none").contains("check the path"));
        for other in ["/dev/null", "/dev", env!("CARGO_MANIFEST_DIR"), file!()] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(other);
            let error = open(&path).unwrap_err().to_string();
            assert!(error.contains("it is no video device"), "{error}");
        }
    }
}
