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
    /// Never inlined: one call of the host's, and one place at which it can go wrong.
    #[inline(never)]
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ReadError> {
        self.0.read(buffer).map_err(|_| ReadError)
    }
}

/// Fills a buffer from a file; ends the image if the file is shorter.
pub fn fill(name: &CStr, buffer: &mut [u8]) {
    let (mut file, mut rest) = (Input::open(name), buffer);
    while !rest.is_empty() {
        // What the host says it read beyond what it was asked for counts as the rest.
        match embedded_io::Read::read(&mut file, rest) {
            Ok(bytes @ 1..) => rest = rest.get_mut(bytes..).unwrap_or_default(),
            Ok(0) | Err(_) => {
                defmt::error!("{=str} is too short", name.to_str().unwrap_or("a file"));
                exit::failure()
            }
        }
    }
}
