use std::io;
use std::path::{Path, PathBuf};

use rustix::io::Errno;

/// What was asked of a device, and what it answered.
#[derive(Debug)]
pub struct Error {
    /// The device.
    pub path: PathBuf,
    /// The request, by its name in the kernel's documentation, or `open`, `poll`, `mmap`.
    pub request: &'static str,
    /// The answer.
    pub source: io::Error,
}

impl Error {
    pub(crate) fn new(path: &Path, request: &'static str, errno: Errno) -> Self {
        Self { path: path.to_owned(), request, source: errno.into() }
    }

    fn is(&self, errno: &[Errno]) -> bool {
        self.source.raw_os_error().is_some_and(|code| errno.iter().any(|errno| errno.raw_os_error() == code))
    }

    /// The device is gone: unplugged, or its driver removed.
    #[must_use]
    pub fn is_gone(&self) -> bool {
        self.is(&[Errno::NODEV, Errno::NXIO])
    }

    /// Another program has the device.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.is(&[Errno::BUSY])
    }

    /// There is no such file.
    #[must_use]
    pub fn is_missing(&self) -> bool {
        self.is(&[Errno::NOENT])
    }

    /// The user may not open it.
    #[must_use]
    pub fn is_forbidden(&self) -> bool {
        self.is(&[Errno::ACCESS, Errno::PERM])
    }

    /// The device knows no such request, or not for what it is set to.
    #[must_use]
    pub fn is_unsupported(&self) -> bool {
        self.is(&[Errno::NOTTY, Errno::NODATA, Errno::INVAL])
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}: {}", self.path.display(), self.request, self.source)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}
