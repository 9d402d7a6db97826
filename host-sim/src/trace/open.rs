//! A trace file of any format.
//!
//! The format is told by the first bytes: `CAMT`, or a `$` keyword (or sigrok's `META` line) for a value change dump. Playing opens the file anew, so a
//! trace can be played often. Memory does not depend on the file's length.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use firmware::trace::{ChunkBuffer, Item, Reader, StretchSink};

use super::camt::{StdIo, fast_crc32};
use super::error::TraceError;
use super::vcd::VcdReader;
use super::wiring::Matched;
use super::{CaptureOptions, PlayError};

/// Bytes read from a `.camt` file at a time.
const READ_AHEAD: usize = 1 << 18;
/// Bytes of a `.camt` played between two calls of `progress`.
const PROGRESS: u64 = 1 << 20;
/// Bytes at the start of a file in which the format shows.
const SNIFFED: u64 = 4096;

/// Formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The project's own.
    Camt,
    /// Value change dump.
    Vcd,
}

/// What a trace says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceInfo {
    /// The format.
    pub format: Format,
    /// Width of the data bus: 8, 10, 12 or 14.
    pub bus_bits: u8,
    /// Pixel clock in hertz: declared in a `.camt`, measured at the beginning of a VCD; `None` if unknown.
    pub pclk_hz: Option<u32>,
    /// TOML text of the profile that the trace was made with, if it carries one.
    pub profile: Option<String>,
    /// Which signals were taken for which wires, in a format that has names.
    pub matched: Option<Matched>,
    /// Bytes of the file: what `progress` counts up to.
    pub file_bytes: u64,
}

/// What was played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Played {
    /// Pixel clocks.
    pub clocks: u64,
    /// Unknown values (x, z) of wires, which were read as 0.
    pub unknown: u64,
}

/// A trace file that can be played.
#[derive(Clone, Debug)]
pub struct Trace {
    path: PathBuf,
    options: CaptureOptions,
    info: TraceInfo,
}

/// Opens a trace and reads what it says of itself.
///
/// # Errors
/// If the file cannot be read, is none of the formats, is malformed at its beginning, or lacks a wire.
pub fn open(path: impl AsRef<Path>, options: &CaptureOptions) -> Result<Trace, TraceError> {
    let path = path.as_ref();
    let io_error = |error| TraceError::Open { path: path.to_owned(), error };
    let file = File::open(path).map_err(io_error)?;
    let metadata = file.metadata().map_err(io_error)?;
    if metadata.is_dir() {
        return Err(io_error(io::ErrorKind::IsADirectory.into()));
    }
    let mut head = Vec::new();
    file.take(SNIFFED).read_to_end(&mut head).map_err(io_error)?;
    let format = sniff(&head).ok_or_else(|| TraceError::Unknown { path: path.to_owned() })?;
    let info = TraceInfo {
        format,
        bus_bits: 0,
        pclk_hz: None,
        profile: None,
        matched: None,
        file_bytes: metadata.len(),
    };
    let mut trace = Trace { path: path.to_owned(), options: options.clone(), info };
    match format {
        Format::Camt => trace.read_camt_info()?,
        Format::Vcd => trace.read_vcd_info()?,
    }
    Ok(trace)
}

fn sniff(head: &[u8]) -> Option<Format> {
    if head.starts_with(b"CAMT") {
        return Some(Format::Camt);
    }
    let text = head.trim_ascii_start();
    (text.starts_with(b"$") || text.starts_with(b"META ")).then_some(Format::Vcd)
}

impl Trace {
    /// What the trace says of itself.
    #[must_use]
    pub fn info(&self) -> &TraceInfo {
        &self.info
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Plays the whole trace into `sink`; `progress` gets the bytes of the file that are done.
    ///
    /// # Errors
    /// The trace's, at whatever place it is damaged (all that was delivered before is good), or the sink's.
    pub fn play<S: StretchSink>(
        &self,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Played, PlayError<TraceError, S::Error>> {
        match self.info.format {
            Format::Camt => self.play_camt(None, sink, progress),
            Format::Vcd => {
                let reader = self.vcd().map_err(PlayError::Trace)?;
                let played = reader.play(sink, progress).map_err(|error| match error {
                    PlayError::Trace(error) => PlayError::Trace(self.vcd_error(error)),
                    PlayError::Sink(error) => PlayError::Sink(error),
                })?;
                Ok(Played { clocks: played.clocks, unknown: played.unknown })
            }
        }
    }

    /// Plays from a mark on: mark 0 is the first clock, the others are where VSYNC goes to its active level.
    ///
    /// # Errors
    /// As [`play`](Self::play), and if the trace has no such mark or, as a VCD, no index.
    pub fn play_from<S: StretchSink>(
        &self,
        mark: u64,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Played, PlayError<TraceError, S::Error>> {
        match self.info.format {
            Format::Camt => self.play_camt(Some(mark), sink, progress),
            Format::Vcd => Err(PlayError::Trace(TraceError::NoIndex { path: self.path.clone(), mark })),
        }
    }

    fn play_camt<S: StretchSink>(
        &self,
        mark: Option<u64>,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Played, PlayError<TraceError, S::Error>> {
        let camt = |error| PlayError::Trace(self.camt_error(error));
        let mut buffer = ChunkBuffer::new();
        let file = StdIo(self.file().map_err(PlayError::Trace)?);
        let mut reader = Reader::with_checksum(file, &mut buffer, fast_crc32).map_err(camt)?;
        if let Some(mark) = mark {
            reader.seek_mark(mark).map_err(camt)?;
        }
        let first = reader.clock();
        let mut told = 0;
        loop {
            let position = reader.position();
            if position >= told + PROGRESS {
                told = position;
                progress(told);
            }
            match reader.next_item().map_err(camt)? {
                Some(Item::Stretch(sync, samples)) => sink.stretch(sync, samples).map_err(PlayError::Sink)?,
                Some(_) => {}
                None => break,
            }
        }
        progress(reader.position());
        Ok(Played { clocks: reader.clock() - first, unknown: 0 })
    }

    /// Header and profile, which stand before the first stretch.
    fn read_camt_info(&mut self) -> Result<(), TraceError> {
        let mut buffer = ChunkBuffer::new();
        let file = StdIo(self.file()?);
        let mut reader =
            Reader::with_checksum(file, &mut buffer, fast_crc32).map_err(|error| self.camt_error(error))?;
        let header = reader.header();
        let mut profile = String::new();
        while let Some(Item::Profile(part)) = reader.next_item().map_err(|error| self.camt_error(error))? {
            profile.push_str(part);
        }
        self.info.bus_bits = header.bus_bits;
        self.info.pclk_hz = (header.pclk_hz > 0).then_some(header.pclk_hz);
        self.info.profile = (!profile.is_empty()).then_some(profile);
        Ok(())
    }

    fn read_vcd_info(&mut self) -> Result<(), TraceError> {
        let reader = self.vcd()?;
        self.info.bus_bits = reader.bus_bits();
        self.info.matched = Some(reader.matched().clone());
        self.info.pclk_hz = reader.measure_clock().map_err(|error| self.vcd_error(error))?;
        Ok(())
    }

    fn vcd(&self) -> Result<VcdReader<File>, TraceError> {
        let file = File::open(&self.path).map_err(|error| self.open_error(error))?;
        VcdReader::new(file, &self.options).map_err(|error| self.vcd_error(error))
    }

    fn file(&self) -> Result<BufReader<File>, TraceError> {
        let file = File::open(&self.path).map_err(|error| self.open_error(error))?;
        Ok(BufReader::with_capacity(READ_AHEAD, file))
    }

    fn open_error(&self, error: io::Error) -> TraceError {
        TraceError::Open { path: self.path.clone(), error }
    }

    fn camt_error(&self, error: firmware::trace::Error<io::Error>) -> TraceError {
        TraceError::Camt { path: self.path.clone(), error }
    }

    fn vcd_error(&self, error: super::vcd::VcdError) -> TraceError {
        TraceError::Vcd { path: self.path.clone(), error }
    }
}
