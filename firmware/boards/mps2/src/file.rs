//! The host's files, by semihosting.

use core::ffi::CStr;

use semihosting::fs::File;
use semihosting::io::Read as _;

use crate::exit;

/// A file of the host as a stream of bytes.
#[derive(Debug)]
pub struct Input(File);

impl Input {
    /// Opens a file in the folder in which QEMU was started; ends the image if there is none.
    #[must_use]
    pub fn open(name: &CStr) -> Self {
        match File::open(name) {
            Ok(file) => Self(file),
            Err(_) => {
                defmt::error!("cannot open {=str}", name.to_str().unwrap_or("a file"));
                exit::failure()
            }
        }
    }
}

/// The host could not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub struct ReadError;

impl core::fmt::Display for ReadError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the host could not read")
    }
}

impl core::error::Error for ReadError {}

impl embedded_io::Error for ReadError {
    fn kind(&self) -> embedded_io::ErrorKind {
        embedded_io::ErrorKind::Other
    }
}

impl embedded_io::ErrorType for Input {
    type Error = ReadError;
}

impl embedded_io::Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ReadError> {
        self.0.read(buffer).map_err(|_| ReadError)
    }
}

/// Fills a buffer from a file; ends the image if the file is shorter.
pub fn fill(name: &CStr, buffer: &mut [u8]) {
    if embedded_io::Read::read_exact(&mut Input::open(name), buffer).is_err() {
        defmt::error!("{=str} is too short", name.to_str().unwrap_or("a file"));
        exit::failure()
    }
}
