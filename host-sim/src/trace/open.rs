//! A trace file of any format.
//!
//! A `.camt` holds pixel clocks, and a simulator's dump exact times: they have ways of their own. All others are captures of an
//! analyser, whose samples know nothing of the pixel clock: their beginning is surveyed first ([`clock`](super::clock)), then the states at the
//! edges make the stretches. Playing opens the file anew, so a trace can be played often. Memory does not depend on the file's length.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use firmware::camif::pins::Edge;
use firmware::trace::{ChunkBuffer, Item, Reader, StretchSink};

use super::camt::{StdIo, fast_crc32};
use super::capture::Capture;
use super::clock::{Clock, Finder};
use super::edges::{Sampler, wires};
use super::error::TraceError;
use super::vcd::VcdReader;
use super::wiring::{Matched, Tap, Wiring, wire};
use super::{CaptureOptions, PlayError};

/// Bytes read from a `.camt` file at a time.
const READ_AHEAD: usize = 1 << 18;
/// Bytes of a `.camt` played between two calls of `progress`.
const PROGRESS: u64 = 1 << 20;

/// Formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The project's own.
    Camt,
    /// Value change dump.
    Vcd,
    /// sigrok session.
    Sr,
    /// Saleae's `digital.csv`.
    SaleaeCsv,
    /// Saleae's binary files.
    SaleaeBinary,
    /// Fast signal trace.
    Fst,
}

impl Format {
    /// Its name, in a word or two.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Camt => "camt",
            Self::Vcd => "VCD",
            Self::Sr => "sigrok session",
            Self::SaleaeCsv => "Saleae CSV",
            Self::SaleaeBinary => "Saleae binary",
            Self::Fst => "FST",
        }
    }
}

/// What a trace says of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceInfo {
    /// The format.
    pub format: Format,
    /// Width of the data bus: 8, 10, 12 or 14.
    pub bus_bits: u8,
    /// Pixel clock in hertz: declared in a `.camt`, else measured at the beginning; `None` if unknown.
    pub pclk_hz: Option<u32>,
    /// TOML text of the profile that the trace was made with, if it carries one.
    pub profile: Option<String>,
    /// Which signals were taken for which wires, in a format that has names.
    pub matched: Option<Matched>,
    /// The clock as it was recovered from an analyser's samples.
    pub clock: Option<Clock>,
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
    /// Pulses of the clock that were too short and dropped, in an analyser's samples.
    pub dropped_pulses: u64,
}

/// A trace file that can be played.
#[derive(Clone, Debug)]
pub struct Trace {
    capture: Capture,
    options: CaptureOptions,
    /// The bits of the state that each wire sets, where the clock is recovered.
    wires: Vec<(Tap, u64)>,
    info: TraceInfo,
}

/// Opens a trace and reads what it says of itself.
///
/// # Errors
/// If the file cannot be read, is none of the formats, is malformed at its beginning, or lacks a wire; if an analyser's samples are too few to recover
/// the clock from.
pub fn open(path: impl AsRef<Path>, options: &CaptureOptions) -> Result<Trace, TraceError> {
    let capture = Capture::open(path)?;
    let info = TraceInfo {
        format: capture.format(),
        bus_bits: 0,
        pclk_hz: None,
        profile: None,
        matched: None,
        clock: None,
        file_bytes: capture.file_bytes(),
    };
    let mut trace = Trace { capture, options: options.clone(), wires: Vec::new(), info };
    match trace.info.format {
        Format::Camt => trace.read_camt_info()?,
        Format::Vcd if !trace.capture.is_sampled() => trace.read_vcd_info()?,
        _ => trace.recover_clock()?,
    }
    Ok(trace)
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
        self.capture.path()
    }

    /// The same file at the level of its signals.
    #[must_use]
    pub fn capture(&self) -> &Capture {
        &self.capture
    }

    /// The edge of the clock at which the other wires are still; nothing if that is not clear, or the trace holds no edges as a
    /// `.camt` does.
    ///
    /// # Errors
    /// The trace's.
    pub fn still_edge(&self) -> Result<Option<Edge>, TraceError> {
        if let Some(clock) = &self.info.clock {
            return Ok(clock.still_edge());
        }
        if self.info.format == Format::Camt {
            return Ok(None);
        }
        let wiring = self.wiring()?;
        let survey = self.capture.survey(&wires(&wiring))?;
        let clock = Clock::choose(&survey, self.capture.known(Edge::Rising, None), &wiring.matched.pclk);
        Ok(clock.ok().and_then(|clock| clock.still_edge()))
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
            _ if let Some(clock) = &self.info.clock => self.play_recovered(clock, sink, progress),
            _ => {
                let reader = self.vcd().map_err(PlayError::Trace)?;
                let played = reader.play(sink, progress);
                let played = played.map_err(|error| error.map(|error| self.vcd_error(error)))?;
                Ok(Played { clocks: played.clocks, unknown: played.unknown, dropped_pulses: 0 })
            }
        }
    }

    /// Plays from a mark on: mark 0 is the first clock, the others are where VSYNC goes to its active level.
    ///
    /// # Errors
    /// As [`play`](Self::play), and if the trace has no such mark or, in any format but `.camt`, no index.
    pub fn play_from<S: StretchSink>(
        &self,
        mark: u64,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Played, PlayError<TraceError, S::Error>> {
        match self.info.format {
            Format::Camt => self.play_camt(Some(mark), sink, progress),
            _ => {
                let path = self.path().to_owned();
                Err(PlayError::Trace(TraceError::NoIndex { path, mark }))
            }
        }
    }

    fn play_recovered<S: StretchSink>(
        &self,
        clock: &Clock,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Played, PlayError<TraceError, S::Error>> {
        let mut sampler = Sampler::new(sink, self.info.bus_bits == 8);
        let mut finder = Finder::new(clock.plan(), &mut sampler);
        let played = self.capture.play_wires(&self.wires, &mut finder, progress);
        let (finished, dropped_pulses) = (finder.finish(), finder.dropped);
        // Samples before an error are good.
        let flushed = sampler.flush();
        let played = played?;
        finished.and(flushed).map_err(PlayError::Sink)?;
        Ok(Played { clocks: sampler.edges, unknown: played.unknown, dropped_pulses })
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
        Ok(Played { clocks: reader.clock() - first, ..Played::default() })
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

    /// Finds the wires among the signals, and the clock in the beginning of the capture.
    fn recover_clock(&mut self) -> Result<(), TraceError> {
        let capture = &self.capture;
        let wiring = self.wiring()?;
        let wires = wires(&wiring);
        let survey = capture.survey(&wires)?;
        let known = capture.known(self.options.edge, self.options.shortest_pulse);
        let clock = Clock::choose(&survey, known, &wiring.matched.pclk)
            .map_err(|error| TraceError::Clock { path: self.path().to_owned(), error })?;
        self.info.bus_bits = wiring.data.len() as u8;
        self.info.pclk_hz = clock.hertz.map(|hertz| hertz.round() as u32);
        self.info.matched = Some(wiring.matched);
        self.info.clock = Some(clock);
        self.wires = wires;
        Ok(())
    }

    fn wiring(&self) -> Result<Wiring, TraceError> {
        wire(self.capture.signals(), &self.options.wanted)
            .map_err(|error| TraceError::Wiring { path: self.path().to_owned(), error })
    }

    fn vcd(&self) -> Result<VcdReader<File>, TraceError> {
        let file = File::open(self.path()).map_err(|error| self.open_error(error))?;
        VcdReader::new(file, &self.options).map_err(|error| self.vcd_error(error))
    }

    fn file(&self) -> Result<BufReader<File>, TraceError> {
        let file = File::open(self.path()).map_err(|error| self.open_error(error))?;
        Ok(BufReader::with_capacity(READ_AHEAD, file))
    }

    fn open_error(&self, error: io::Error) -> TraceError {
        TraceError::Open { path: self.path().to_owned(), error }
    }

    fn camt_error(&self, error: firmware::trace::Error<io::Error>) -> TraceError {
        TraceError::Camt { path: self.path().to_owned(), error }
    }

    fn vcd_error(&self, error: super::vcd::VcdError) -> TraceError {
        TraceError::Vcd { path: self.path().to_owned(), error }
    }
}
