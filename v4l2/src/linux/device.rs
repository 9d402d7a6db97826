use std::fs::File;
use std::os::fd::{AsFd, BorrowedFd};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;

use super::call::{ENUMERATE_INPUTS, GET_INPUT, QUERY_CAPABILITY, Request, SET_INPUT, call};
use super::error::Error;
use super::raw::{self, Plain, text};

/// A device that captures.
#[derive(Clone, Debug)]
pub struct Device {
    pub(crate) path: Arc<PathBuf>,
    pub(crate) file: Arc<File>,
    pub(crate) capability: Arc<Capability>,
    /// `V4L2_BUF_TYPE_VIDEO_CAPTURE`, or that with planes.
    pub(crate) kind: u32,
    /// Whether there is a stream, or a buffer of one.
    pub(crate) streams: Arc<AtomicBool>,
}

/// What a device says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Capability {
    /// The driver's name, such as `uvcvideo`.
    pub driver: String,
    /// The device's name, for people.
    pub card: String,
    /// Where it is attached, such as `usb-0000:00:14.0-1`.
    pub bus: String,
    /// The flags `V4L2_CAP_…` of this node.
    pub flags: u32,
}

/// A connector, or a sensor, of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// Its number.
    pub index: u32,
    /// Its name, for people.
    pub name: String,
    /// Flags `V4L2_IN_ST_…`; 0 is a signal.
    pub status: u32,
}

/// All `/dev/video…` in the order of their numbers. They may be other things than cameras: [`Device::open`] tells.
#[must_use]
pub fn device_paths() -> Vec<PathBuf> {
    let mut found: Vec<(u32, PathBuf)> = std::fs::read_dir("/dev")
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| {
            let number = entry.file_name().to_str()?.strip_prefix("video")?.parse().ok()?;
            Some((number, entry.path()))
        })
        .collect();
    found.sort();
    found.into_iter().map(|(_, path)| path).collect()
}

impl Device {
    /// Opens a device; `None` if it is one that does not capture frames into mapped memory.
    ///
    /// # Errors
    /// If it cannot be opened, or is no video device.
    pub fn open(path: &Path) -> Result<Option<Self>, Error> {
        let flags = OFlags::RDWR | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let file =
            rustix::fs::open(path, flags, Mode::empty()).map_err(|errno| Error::new(path, "open", errno))?;
        let mut raw = raw::Capability::ZERO;
        call(file.as_fd(), &QUERY_CAPABILITY, &mut raw)
            .map_err(|errno| Error::new(path, QUERY_CAPABILITY.name, errno))?;
        let whole = raw.capabilities & raw::HAS_DEVICE_CAPS == 0;
        let flags = if whole { raw.capabilities } else { raw.device_caps };
        let kind = if flags & raw::CAN_CAPTURE != 0 {
            raw::CAPTURE
        } else if flags & raw::CAN_CAPTURE_PLANES != 0 {
            raw::CAPTURE_PLANES
        } else {
            return Ok(None);
        };
        if flags & raw::CAN_STREAM == 0 {
            return Ok(None);
        }
        let capability =
            Capability { driver: text(&raw.driver), card: text(&raw.card), bus: text(&raw.bus_info), flags };
        Ok(Some(Self {
            path: Arc::new(path.to_owned()),
            file: Arc::new(file.into()),
            capability: Arc::new(capability),
            kind,
            streams: Arc::default(),
        }))
    }

    /// The file that was opened.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it says of itself.
    #[must_use]
    pub fn capability(&self) -> &Capability {
        &self.capability
    }

    pub(crate) fn fd(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }

    pub(crate) fn call<T: Plain>(&self, request: &Request<T>, argument: &mut T) -> Result<(), Error> {
        call(self.fd(), request, argument).map_err(|errno| self.error(request.name, errno))
    }

    pub(crate) fn error(&self, request: &'static str, errno: Errno) -> Error {
        Error::new(&self.path, request, errno)
    }

    /// Asks for one after the other, until the device says that there is no such index.
    pub(crate) fn enumerate<T: Plain>(
        &self,
        request: &Request<T>,
        argument: impl Fn(u32) -> T,
    ) -> Result<Vec<T>, Error> {
        let mut all = Vec::new();
        // A driver that never says so would not end.
        for index in 0..1024 {
            let mut one = argument(index);
            match self.call(request, &mut one) {
                Ok(()) => all.push(one),
                Err(error) if error.is_unsupported() => break,
                Err(error) => return Err(error),
            }
        }
        Ok(all)
    }

    /// The connectors.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn inputs(&self) -> Result<Vec<Input>, Error> {
        let all = self.enumerate(&ENUMERATE_INPUTS, |index| raw::Input { index, ..raw::Input::ZERO })?;
        let input = |raw: raw::Input| Input { index: raw.index, name: text(&raw.name), status: raw.status };
        Ok(all.into_iter().map(input).collect())
    }

    /// The connector in use.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn input(&self) -> Result<u32, Error> {
        let mut index = 0;
        self.call(&GET_INPUT, &mut index)?;
        Ok(index)
    }

    /// Takes another connector. What is set otherwise may change with it: do this first.
    ///
    /// # Errors
    /// If there is no such connector.
    pub fn set_input(&self, mut index: u32) -> Result<(), Error> {
        self.call(&SET_INPUT, &mut index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_camera_is_said() {
        let error = Device::open(Path::new("/dev/no-such-camera")).unwrap_err();
        assert!(
            error.is_missing() && error.to_string().starts_with("/dev/no-such-camera: open: "),
            "{error}"
        );
        let error = Device::open(Path::new("/dev/null")).unwrap_err();
        assert!(error.is_unsupported() && error.request == "VIDIOC_QUERYCAP", "{error}");
        assert!(!error.is_gone() && !error.is_busy() && !error.is_forbidden() && !error.is_missing());
    }
}
