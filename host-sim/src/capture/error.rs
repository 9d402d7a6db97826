use std::path::PathBuf;
use std::time::Duration;

use crate::profile::nearest;

/// Why frames do not come, or no more of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The device can't be opened.
    #[error("{device}: {what}; {remedy}")]
    Open {
        /// The device.
        device: String,
        /// What the system says.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// There is no device to choose from.
    #[error("no capture device found; `host-sim capture --list` says what to check")]
    None,
    /// It was asked for something that it does not have.
    #[error("{device}: no {kind} `{name}`; there are {known}")]
    Unknown {
        /// The device.
        device: String,
        /// What kind of thing.
        kind: &'static str,
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// It does not do what it was asked for.
    #[error("{device}: {setting} was refused: {what}; {remedy}")]
    Refused {
        /// The device.
        device: String,
        /// What was asked for.
        setting: String,
        /// What the device says.
        what: String,
        /// What to do.
        remedy: String,
    },
    /// No frame came in time.
    #[error(
        "{device}: no frame for {:.1} s, after {frames} frames; check the camera's cable and signal, take another input, or give it longer with --timeout",
        waited.as_secs_f64()
    )]
    Timeout {
        /// The device.
        device: String,
        /// How long was waited.
        waited: Duration,
        /// Frames that came before.
        frames: u64,
    },
    /// Frames came, and none of them was whole.
    #[error(
        "{device}: no whole frame for {:.1} s: of {frames} frames {damaged} came damaged and {short} too short; check the camera's cable, take a smaller size, a lower rate or another format, or give it longer with --timeout",
        waited.as_secs_f64()
    )]
    NoneWhole {
        /// The device.
        device: String,
        /// How long was waited.
        waited: Duration,
        /// Frames that came in all.
        frames: u64,
        /// Of these, damaged ones.
        damaged: u64,
        /// Of these, short ones.
        short: u64,
    },
    /// It was unplugged, or its driver removed.
    #[error("{device}: gone after {frames} frames; plug it in again. What came before is whole")]
    Gone {
        /// The device.
        device: String,
        /// Frames that came before.
        frames: u64,
    },
    /// It stopped by itself.
    #[error(
        "{device}: stopped after {frames} frames ({what}); unplug it and plug it in again, and see `dmesg`"
    )]
    Stopped {
        /// The device.
        device: String,
        /// Frames that came before.
        frames: u64,
        /// What the system says.
        what: String,
    },
    /// Something can't be written.
    #[error(transparent)]
    Output(#[from] crate::picture::PictureError),
    /// The trace can't be written.
    #[error(transparent)]
    Trace(#[from] crate::trace::TraceError),
    /// A frame can't become what was asked for.
    #[error("{device}: frame {frame}: {what}")]
    Frame {
        /// The device.
        device: String,
        /// Its number, from 0.
        frame: u64,
        /// What is wrong.
        what: String,
    },
    /// A folder can't be made.
    #[error("{}: the folder cannot be made: {error}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

impl CaptureError {
    /// Something of which there is none, with what there is, the nearest first.
    pub(super) fn unknown<'a>(
        device: &str,
        kind: &'static str,
        name: &str,
        known: impl Iterator<Item = &'a str> + Clone,
    ) -> Self {
        let first = nearest(name, known.clone());
        let others = known.filter(|other| Some(*other) != first);
        let known = first.into_iter().chain(others).collect::<Vec<_>>().join(", ");
        Self::Unknown { device: device.to_owned(), kind, name: name.to_owned(), known }
    }

    /// A setting that is not granted.
    #[cfg(feature = "libcamera")]
    pub(super) fn refused(device: &str, setting: &str, what: &str, remedy: &str) -> Self {
        let [device, setting, what, remedy] = [device, setting, what, remedy].map(str::to_owned);
        Self::Refused { device, setting, what, remedy }
    }

    /// The same, with the frames that came before it.
    pub(super) fn after(mut self, count: u64) -> Self {
        if let Self::Timeout { frames, .. } | Self::Gone { frames, .. } | Self::Stopped { frames, .. } =
            &mut self
        {
            *frames = count;
        }
        self
    }
}
