//! What a device refuses, with what to do about it.

use std::io::ErrorKind;
use std::path::Path;

use v4l2_capture::{Device, Error};

use super::super::error::CaptureError;

pub(super) fn open_error(path: &Path, error: &Error) -> CaptureError {
    let remedy = if error.is_missing() {
        "check the path; `host-sim capture --list` says which there are"
    } else if error.is_forbidden() {
        "join the group that owns it, most often by `sudo usermod -aG video $USER`, and log in again"
    } else if error.is_busy() {
        "another program uses it: end that"
    } else if error.is_unsupported() || error.source.kind() == ErrorKind::IsADirectory {
        "it is no video device; `host-sim capture --list` says which there are"
    } else {
        "unplug it and plug it in again"
    };
    CaptureError::Open { device: path.display().to_string(), what: error.source.to_string(), remedy }
}

pub(super) fn refused(
    device: &Device,
    setting: String,
    error: &Error,
    remedy: impl Into<String>,
) -> CaptureError {
    let remedy = if error.is_busy() { "another program uses it: end that".into() } else { remedy.into() };
    CaptureError::Refused {
        device: device.path().display().to_string(),
        setting,
        what: format!("{}: {}", error.request, error.source),
        remedy,
    }
}

pub(super) fn unknown<'a>(
    device: &Device,
    kind: &'static str,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> CaptureError {
    CaptureError::unknown(&device.path().display().to_string(), kind, name, known)
}
