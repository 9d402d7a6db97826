//! One binary file: a channel as a row of times at which it changes.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use super::error::{SaleaeError, SaleaeProblem};

/// Bytes of a file in memory at a time; there may be 63 files.
const READ_AHEAD: usize = 1 << 16;

/// A change of level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    /// Seconds, as the file has them.
    pub(super) seconds: f64,
    pub(super) high: bool,
    /// It follows a gap in which nothing was recorded.
    pub(super) after_gap: bool,
}

/// A file that is read change by change.
#[derive(Debug)]
pub(super) struct Channel<R = BufReader<File>> {
    path: PathBuf,
    file: R,
    bytes: u64,
    pub(super) offset: u64,
    version: i32,
    /// Chunks still to come, and changes still to come in this one.
    chunks: u64,
    changes: u64,
    high: bool,
    seconds: f64,
    /// When the capture begins and the level it begins with.
    pub(super) begin: f64,
    pub(super) end: f64,
    pub(super) initial: bool,
    pub(super) sample_rate: Option<f64>,
}

impl Channel {
    pub(super) fn open(path: &Path) -> Result<Self, SaleaeError> {
        let file = File::open(path)?;
        let bytes = file.metadata()?.len();
        Self::new(path, BufReader::with_capacity(READ_AHEAD, file), bytes)
    }
}

impl<R: Read> Channel<R> {
    /// Reads the header and the first chunk's.
    pub(super) fn new(path: &Path, file: R, bytes: u64) -> Result<Self, SaleaeError> {
        let path = path.to_owned();
        let mut channel = Self {
            path,
            file,
            bytes,
            offset: 0,
            version: 0,
            chunks: 1,
            changes: 0,
            high: false,
            seconds: f64::NEG_INFINITY,
            begin: 0.0,
            end: 0.0,
            initial: false,
            sample_rate: None,
        };
        if channel.bytes < 8 || &channel.take::<8>()? != b"<SALEAE>" {
            return Err(channel.wrong(0, SaleaeProblem::Magic));
        }
        channel.version = i32::from_le_bytes(channel.take()?);
        if !(0..=1).contains(&channel.version) {
            return Err(channel.wrong(8, SaleaeProblem::Version(channel.version)));
        }
        let kind = i32::from_le_bytes(channel.take()?);
        if kind != 0 {
            return Err(channel.wrong(12, SaleaeProblem::Type(kind)));
        }
        if channel.version == 1 {
            channel.chunks = u64::from_le_bytes(channel.take()?);
        }
        if channel.chunks > 0 {
            channel.begin = channel.chunk()?;
            channel.initial = channel.high;
        }
        Ok(channel)
    }

    fn wrong(&self, offset: u64, problem: SaleaeProblem) -> SaleaeError {
        SaleaeError::Binary { file: self.path.clone(), offset, problem }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], SaleaeError> {
        let mut bytes = [0; N];
        let missing = (self.offset + N as u64).saturating_sub(self.bytes);
        if missing > 0 {
            return Err(self.wrong(self.bytes, SaleaeProblem::Short(missing)));
        }
        self.file.read_exact(&mut bytes)?;
        self.offset += N as u64;
        Ok(bytes)
    }

    /// A time, which must be a number and not before the last one.
    #[inline]
    fn time(&mut self) -> Result<f64, SaleaeError> {
        let seconds = f64::from_le_bytes(self.take()?);
        let at = self.offset - 8;
        // So far from 0 a time has no picoseconds.
        if !seconds.is_finite() || seconds.abs() > 1e7 {
            return Err(self.wrong(at, SaleaeProblem::Time(seconds.to_string())));
        }
        if seconds < self.seconds {
            return Err(self.wrong(at, SaleaeProblem::Backwards(seconds.to_string())));
        }
        self.seconds = seconds;
        Ok(seconds)
    }

    /// Header of the next chunk: when it begins.
    fn chunk(&mut self) -> Result<f64, SaleaeError> {
        self.chunks -= 1;
        let initial = u32::from_le_bytes(self.take()?);
        if initial > 1 {
            return Err(self.wrong(self.offset - 4, SaleaeProblem::Initial(initial)));
        }
        self.high = initial == 1;
        if self.version == 1 {
            let rate = f64::from_le_bytes(self.take()?);
            self.sample_rate = self.sample_rate.or(Some(rate)).filter(|rate| rate.is_finite() && *rate > 0.0);
        }
        let begin = self.time()?;
        // The end may not lie before the beginning, but the changes come first.
        self.end = self.time()?;
        self.seconds = begin;
        self.changes = u64::from_le_bytes(self.take()?);
        let needed = self.changes.checked_mul(8).and_then(|bytes| bytes.checked_add(self.offset));
        match needed {
            Some(needed) if needed <= self.bytes => Ok(begin),
            needed => {
                let missing = needed.unwrap_or(u64::MAX) - self.bytes;
                Err(self.wrong(self.bytes, SaleaeProblem::Short(missing)))
            }
        }
    }

    /// The next change; nothing at the end of the file.
    #[inline]
    pub(super) fn next(&mut self) -> Result<Option<Change>, SaleaeError> {
        if self.changes > 0 {
            self.changes -= 1;
            self.high = !self.high;
            return Ok(Some(Change { seconds: self.time()?, high: self.high, after_gap: false }));
        }
        if self.chunks > 0 {
            let seconds = self.chunk()?;
            return Ok(Some(Change { seconds, high: self.high, after_gap: true }));
        }
        if self.offset < self.bytes {
            return Err(self.wrong(self.offset, SaleaeProblem::Behind(self.bytes - self.offset)));
        }
        Ok(None)
    }
}
