//! `.camt` files on the host: the firmware's reader and writer over files, with a fast checksum.

use std::io;

/// CRC-32 by the processor's carry-less multiplication where it has one.
#[must_use]
pub fn fast_crc32(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}

/// A standard reader, writer or file as the `embedded-io` one that the firmware takes.
#[derive(Debug)]
pub struct StdIo<T>(pub T);

impl<T> embedded_io::ErrorType for StdIo<T> {
    type Error = io::Error;
}

impl<T: io::Read> embedded_io::Read for StdIo<T> {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, io::Error> {
        retried(|| self.0.read(buf))
    }
}

impl<T: io::Write> embedded_io::Write for StdIo<T> {
    fn write(&mut self, buf: &[u8]) -> Result<usize, io::Error> {
        match retried(|| self.0.write(buf))? {
            // The other trait has no answer for this, and would panic.
            0 if !buf.is_empty() => Err(io::ErrorKind::WriteZero.into()),
            count => Ok(count),
        }
    }

    fn flush(&mut self) -> Result<(), io::Error> {
        self.0.flush()
    }
}

impl<T: io::Seek> embedded_io::Seek for StdIo<T> {
    fn seek(&mut self, pos: embedded_io::SeekFrom) -> Result<u64, io::Error> {
        self.0.seek(pos.into())
    }
}

fn retried(mut call: impl FnMut() -> io::Result<usize>) -> io::Result<usize> {
    loop {
        match call() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}
