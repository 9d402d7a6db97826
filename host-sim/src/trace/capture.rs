//! A capture at the level of its signals, before anybody knows which wire is what: the same for every format.
//!
//! ```text
//! file ─► Capture::open: format told by content ─► channels, a bit each ─► play(channels, sink) ─► levels over time
//! ```
//!
//! This is where a bus is guessed from. In bulk, at the beginning of any file:
//!
//! ```no_run
//! use host_sim::trace::{Capture, levels::Levels};
//! let capture = Capture::open("capture.sr")?;
//! for (index, channel) in capture.channels().iter().enumerate() {
//!     println!("{index}: {}", channel.name);
//! }
//! // The first 100,000 changes of the first three channels: bit i of a state is the i-th of them.
//! let levels: Levels = capture.beginning(&[0, 1, 2], 100_000)?;
//! let seconds_a_unit = capture.ticks_per_second().map(|ticks| 1.0 / ticks);
//! for (time, state) in levels.times.iter().zip(&levels.states) {
//!     println!("{time}: {state:03b}");
//! }
//! # Ok::<(), host_sim::trace::TraceError>(())
//! ```
//!
//! The whole file goes through [`Capture::play`] into any [`LevelSink`], in constant memory. Once the wires are known, their
//! names make a [`SignalMap`](super::SignalMap) ([`SignalMap::of`](super::SignalMap::of)), and [`open`](fn@super::open) plays frames
//! by a profile. A `.camt` has no clock wire; it shows one as if it had been recorded at two units of time a clock:
//! the other wires change at `2k`, `PCLK` rises at `2k + 1`.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use super::camt;
use super::error::TraceError;
use super::fst;
use super::levels::{LevelSink, Levels, LevelsPlayed};
use super::open::Format;
use super::saleae::{BinaryExport, CsvExport};
use super::sr::SrFile;
use super::vcd::VcdLevels;
use super::wiring::{Signal, Tap};
use super::{PlayError, saleae};

/// Channels that one call can play: the bits of a state, less one.
pub const CHANNELS: usize = 63;
/// Channels that are listed, of the vectors and scalars of a file.
const LISTED: usize = 1 << 16;
/// Bytes at the start of a file in which the format shows.
const SNIFFED: u64 = 4096;
/// Bytes read from a file at a time.
const READ_AHEAD: usize = 1 << 18;

/// One bit of a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// As a map names it: `PCLK`, `tb.cam.D[3]`.
    pub name: String,
    /// Which signal and bit it is.
    pub tap: Tap,
}

/// What a file says of itself, whatever its format.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct About {
    pub(super) signals: Vec<Signal>,
    pub(super) ticks_per_second: Option<f64>,
    pub(super) sample_rate: Option<f64>,
    /// An analyser's samples, which know nothing of the clock.
    pub(super) sampled: bool,
}

/// A capture whose beginning is read.
#[derive(Clone, Debug)]
pub struct Capture {
    path: PathBuf,
    format: Format,
    about: About,
    channels: Vec<Channel>,
    file_bytes: u64,
}

impl Capture {
    /// Opens a file of any format, or the folder of a Saleae export.
    ///
    /// # Errors
    /// If it cannot be read, is none of the formats, or is malformed at its beginning.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, TraceError> {
        let path = path.as_ref();
        let io_error = |error| TraceError::Open { path: path.to_owned(), error };
        let (path, format) = if path.metadata().map_err(io_error)?.is_dir() {
            saleae::in_folder(path).map_err(|error| TraceError::Saleae { path: path.to_owned(), error })?
        } else {
            let mut head = Vec::new();
            File::open(path).map_err(io_error)?.take(SNIFFED).read_to_end(&mut head).map_err(io_error)?;
            let format = sniff(&head).ok_or_else(|| TraceError::Unknown { path: path.to_owned() })?;
            (path.to_owned(), format)
        };
        let mut capture = Self { path, format, about: About::default(), channels: Vec::new(), file_bytes: 0 };
        (capture.about, capture.file_bytes) = capture.read_about()?;
        let bits = capture.about.signals.iter().enumerate().flat_map(|(signal, found)| {
            (0..found.width).map(move |bit| Channel { name: found.tap_name(bit), tap: Tap { signal, bit } })
        });
        capture.channels = bits.take(LISTED).collect();
        Ok(capture)
    }

    fn read_about(&self) -> Result<(About, u64), TraceError> {
        let bytes = || Ok(self.file()?.metadata().map_err(|error| self.open_error(error))?.len());
        Ok(match self.format {
            Format::Camt => {
                (camt::about(self.buffered()?).map_err(|error| self.camt_error(error))?, bytes()?)
            }
            Format::Vcd => {
                let levels = VcdLevels::new(self.file()?).map_err(|error| self.vcd_error(error))?;
                (levels.about(), bytes()?)
            }
            Format::Sr => {
                let session = self.session()?;
                let rate = session.sample_rate().map(|rate| rate as f64);
                let signals = session.signals();
                (About { signals, ticks_per_second: rate, sample_rate: rate, sampled: true }, bytes()?)
            }
            Format::SaleaeCsv => (self.csv()?.about(), bytes()?),
            Format::SaleaeBinary => {
                let export = self.binary()?;
                (export.about(), export.file_bytes())
            }
            Format::Fst => {
                let file = fst::FstFile::new(self.buffered()?).map_err(|error| self.fst_error(error))?;
                (file.about(), bytes()?)
            }
        })
    }

    /// The file, or the first file of an export.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its format.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// Every bit of every signal, up to 65,536 of them.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The signals with their scopes and widths.
    #[must_use]
    pub fn signals(&self) -> &[Signal] {
        &self.about.signals
    }

    /// Units of time a second; nothing if the file does not say.
    #[must_use]
    pub fn ticks_per_second(&self) -> Option<f64> {
        self.about.ticks_per_second
    }

    /// Samples a second of the analyser; nothing for a simulator's dump or where the file does not say.
    #[must_use]
    pub fn sample_rate(&self) -> Option<f64> {
        self.about.sample_rate
    }

    /// Recorded by an analyser, whose samples know nothing of the pixel clock.
    #[must_use]
    pub fn is_sampled(&self) -> bool {
        self.about.sampled
    }

    /// Bytes of the file or files: what `progress` counts up to.
    #[must_use]
    pub fn file_bytes(&self) -> u64 {
        self.file_bytes
    }

    /// Plays the levels of the chosen channels, which are numbers in [`channels`](Self::channels): bit i of a state is the level of the
    /// i-th of them. `progress` gets the bytes of the file that are done.
    ///
    /// # Errors
    /// [`TraceError::Channels`] for more than [`CHANNELS`] or numbers that there are not; the trace's, at whatever place it is damaged; or
    /// the sink's.
    pub fn play<S: LevelSink>(
        &self,
        channels: &[usize],
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<LevelsPlayed, PlayError<TraceError, S::Error>> {
        let wires: Option<Vec<(Tap, u64)>> = channels
            .iter()
            .enumerate()
            .map(|(bit, &channel)| Some((self.channels.get(channel)?.tap, 1 << bit)))
            .take(CHANNELS + 1)
            .collect();
        match wires.filter(|wires| wires.len() <= CHANNELS) {
            Some(wires) => self.play_wires(&wires, sink, progress),
            None => {
                let (path, has) = (self.path.clone(), self.channels.len());
                Err(PlayError::Trace(TraceError::Channels { path, has }))
            }
        }
    }

    /// The first `limit` changes of the chosen channels, in memory.
    ///
    /// # Errors
    /// As [`play`](Self::play).
    pub fn beginning(&self, channels: &[usize], limit: usize) -> Result<Levels, TraceError> {
        let mut levels = Levels::at_most(limit);
        match self.play(channels, &mut levels, &mut |_| ()) {
            Err(PlayError::Trace(error)) => Err(error),
            Ok(_) | Err(PlayError::Sink(_)) => Ok(levels),
        }
    }

    /// Plays the taps, each of which sets the bits of the state beside it.
    pub(super) fn play_wires<S: LevelSink>(
        &self,
        wires: &[(Tap, u64)],
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<LevelsPlayed, PlayError<TraceError, S::Error>> {
        let trace = PlayError::Trace;
        match self.format {
            Format::Camt => {
                let file = self.buffered().map_err(trace)?;
                camt::levels(file, wires, sink, progress)
                    .map_err(|error| error.map(|error| self.camt_error(error)))
            }
            Format::Vcd => {
                let file = self.file().map_err(trace)?;
                let levels = VcdLevels::new(file).map_err(|error| trace(self.vcd_error(error)))?;
                levels.play(wires, sink, progress).map_err(|error| error.map(|error| self.vcd_error(error)))
            }
            Format::Sr => {
                let played = self.session().map_err(trace)?.play(wires, sink, progress);
                played.map_err(|error| error.map(|error| self.sr_error(error)))
            }
            Format::SaleaeCsv => {
                let played = self.csv().map_err(trace)?.play(wires, sink, progress);
                played.map_err(|error| error.map(|error| self.saleae_error(error)))
            }
            Format::SaleaeBinary => {
                let played = self.binary().map_err(trace)?.play(wires, sink, progress);
                played.map_err(|error| error.map(|error| self.saleae_error(error)))
            }
            Format::Fst => {
                let file = fst::FstFile::new(self.buffered().map_err(trace)?);
                let mut file = file.map_err(|error| trace(self.fst_error(error)))?;
                file.play(wires, sink, progress).map_err(|error| error.map(|error| self.fst_error(error)))
            }
        }
    }

    fn file(&self) -> Result<File, TraceError> {
        File::open(&self.path).map_err(|error| self.open_error(error))
    }

    fn buffered(&self) -> Result<BufReader<File>, TraceError> {
        Ok(BufReader::with_capacity(READ_AHEAD, self.file()?))
    }

    fn session(&self) -> Result<SrFile<BufReader<File>>, TraceError> {
        SrFile::new(self.buffered()?).map_err(|error| self.sr_error(error))
    }

    fn csv(&self) -> Result<CsvExport<File>, TraceError> {
        CsvExport::new(self.file()?).map_err(|error| self.saleae_error(error))
    }

    fn binary(&self) -> Result<BinaryExport, TraceError> {
        BinaryExport::open(&self.path).map_err(|error| self.saleae_error(error))
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

    fn sr_error(&self, error: super::sr::SrError) -> TraceError {
        TraceError::Sr { path: self.path.clone(), error }
    }

    fn saleae_error(&self, error: saleae::SaleaeError) -> TraceError {
        TraceError::Saleae { path: self.path.clone(), error }
    }

    fn fst_error(&self, error: fst::FstError) -> TraceError {
        TraceError::Fst { path: self.path.clone(), error }
    }
}

/// The format by the first bytes of a file.
fn sniff(head: &[u8]) -> Option<Format> {
    if head.starts_with(b"CAMT") {
        return Some(Format::Camt);
    }
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        return Some(Format::Sr);
    }
    if head.starts_with(b"<SALEAE>") {
        return Some(Format::SaleaeBinary);
    }
    if fst::is_fst(head) {
        return Some(Format::Fst);
    }
    let text = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head).trim_ascii_start();
    if text.starts_with(b"$") || text.starts_with(b"META ") {
        return Some(Format::Vcd);
    }
    saleae::is_csv(text).then_some(Format::SaleaeCsv)
}
