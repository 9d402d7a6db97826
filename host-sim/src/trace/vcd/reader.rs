//! A VCD file as pin samples: one pass, a block in memory at a time.

use std::io::Read;

use firmware::camif::pins::Edge;
use firmware::trace::StretchSink;

use super::super::edges::{EdgeSink, Probe, Sampler, wires};
use super::super::wiring::{Matched, Tap, WiringError, wire};
use super::super::{CaptureOptions, PlayError};
use super::blocks::Blocks;
use super::changes::{Machine, SamplePoint, Section, Stop};
use super::error::{Problem, VcdError};
use super::header::{self, Declarations};
use super::ids::IdTable;

/// What was played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VcdPlayed {
    /// Pixel clocks: active edges.
    pub clocks: u64,
    /// Time of the first and of the last of them, in units of the file.
    pub first_time: u64,
    /// See `first_time`.
    pub last_time: u64,
    /// Unknown values (x, z) of wires, which were read as 0.
    pub unknown: u64,
}

/// The changes of a file on their way to a sink.
#[derive(Debug)]
pub(super) struct Parser<R> {
    blocks: Blocks<R>,
    ids: IdTable,
    machine: Machine,
}

/// A VCD file whose declarations are read.
#[derive(Debug)]
pub struct VcdReader<R> {
    parser: Parser<R>,
    matched: Matched,
    timescale_fs: Option<u64>,
    edge: Edge,
}

impl<R: Read> VcdReader<R> {
    /// Reads the declarations and finds the wires among them.
    ///
    /// # Errors
    /// If the file cannot be read or is malformed, or a wire is missing.
    pub fn new(inner: R, options: &CaptureOptions) -> Result<Self, VcdError> {
        let (mut parser, declared) = Parser::new(inner)?;
        let wiring = wire(&declared.signals, &options.wanted).map_err(|error| match error {
            WiringError::Map(error) => VcdError::Map(error),
            WiringError::Missing(missing) => VcdError::Missing(missing),
        })?;
        parser.wire(&declared, &wires(&wiring), options.edge == Edge::Falling, options.sample_point)?;
        let (matched, timescale_fs) = (wiring.matched, declared.timescale_fs);
        Ok(Self { parser, matched, timescale_fs, edge: options.edge })
    }

    /// Which signals were taken for which wires.
    pub fn matched(&self) -> &Matched {
        &self.matched
    }

    /// Width of the data bus: 8, 10, 12 or 14.
    pub fn bus_bits(&self) -> u8 {
        self.matched.data.len() as u8
    }

    /// Femtoseconds of a unit of time, if the file says.
    pub fn timescale_fs(&self) -> Option<u64> {
        self.timescale_fs
    }

    /// Plays the file into `sink`; `progress` gets the bytes read, a few thousand times a gigabyte.
    ///
    /// # Errors
    /// If the file cannot be read or is malformed, if its clock never has an active edge, or the sink's. What was
    /// delivered before is a true beginning of the trace.
    pub fn play<S: StretchSink>(
        mut self,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<VcdPlayed, PlayError<VcdError, S::Error>> {
        let mut sampler = Sampler::new(sink, self.bus_bits() == 8);
        let parsed = self.parser.parse(&mut sampler, progress);
        // Samples before an error are good.
        let flushed = sampler.flush();
        parsed?;
        flushed.map_err(PlayError::Sink)?;
        let (clocks, first_time, last_time) = (sampler.edges, sampler.first_time, sampler.last_time);
        if clocks == 0 {
            return Err(PlayError::Trace(self.no_clock()));
        }
        Ok(VcdPlayed { clocks, first_time, last_time, unknown: self.parser.unknown() })
    }

    /// Reads a beginning of the file and measures the clock; `None` if it has no time unit.
    ///
    /// # Errors
    /// If that part of the file is malformed, or the clock never has an active edge.
    pub fn measure_clock(mut self) -> Result<Option<u32>, VcdError> {
        let mut probe = Probe::default();
        match self.parser.parse(&mut probe, &mut |_| ()) {
            Err(PlayError::Trace(error)) => return Err(error),
            Ok(()) if probe.edges() == 0 => return Err(self.no_clock()),
            Ok(()) | Err(PlayError::Sink(())) => {}
        }
        Ok(self.timescale_fs.and_then(|unit| probe.hertz(unit)))
    }

    fn no_clock(&self) -> VcdError {
        let edge = if self.edge == Edge::Rising { "rising" } else { "falling" };
        VcdError::NoClock { signal: self.matched.pclk.clone(), edge }
    }
}

impl<R: Read> Parser<R> {
    /// Reads the declarations; no wire is wanted yet.
    pub(super) fn new(inner: R) -> Result<(Self, Declarations), VcdError> {
        let mut blocks = Blocks::new(inner);
        let declared = match header::read(&mut blocks) {
            Ok(Ok(declared)) => declared,
            Ok(Err((at, problem))) => return Err(VcdError::Text { place: blocks.place(at), problem }),
            Err(error) => return Err(VcdError::Io { offset: blocks.position(), error }),
        };
        let machine = Machine::new(false, SamplePoint::AtEdge);
        Ok((Self { blocks, ids: IdTable::empty(), machine }, declared))
    }

    /// Says which taps set which bits of the state.
    pub(super) fn wire(
        &mut self,
        declared: &Declarations,
        wires: &[(Tap, u64)],
        falling: bool,
        point: SamplePoint,
    ) -> Result<(), VcdError> {
        let place = self.blocks.place(self.blocks.at);
        self.ids = IdTable::new(declared, wires).map_err(|problem| VcdError::Text { place, problem })?;
        self.machine = Machine::new(falling, point);
        Ok(())
    }

    /// Unknown values so far.
    pub(super) fn unknown(&self) -> u64 {
        self.machine.unknown
    }

    pub(super) fn parse<S: EdgeSink>(
        &mut self,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<(), PlayError<VcdError, S::Error>> {
        let blocks = &mut self.blocks;
        loop {
            let (at, end, last) = (blocks.at, blocks.end(), blocks.is_last());
            let (stopped, result) = self.machine.run(blocks.bytes(), at, end, last, &self.ids, sink);
            blocks.at = stopped;
            let text = |at: usize, problem, blocks: &Blocks<R>| {
                PlayError::Trace(VcdError::Text { place: blocks.place(at), problem })
            };
            match result {
                Ok(()) if last => break,
                Ok(()) | Err(Stop::More) => {}
                Err(Stop::Text(at, problem)) => return Err(text(at, problem, blocks)),
                Err(Stop::Sink(error)) => return Err(PlayError::Sink(error)),
            }
            let offset = blocks.position();
            progress(offset);
            match blocks.refill() {
                Ok(true) => {}
                Ok(false) => return Err(text(blocks.at, Problem::TokenTooLong, blocks)),
                Err(error) => return Err(PlayError::Trace(VcdError::Io { offset, error })),
            }
        }
        let name = match self.machine.section {
            Section::Changes => return self.machine.close(sink).map_err(PlayError::Sink),
            Section::Standing(name) => name,
            Section::Checkpoint => "$dumpall",
            Section::Skipped => "a $ section",
        };
        let problem = Problem::Unclosed(name);
        Err(PlayError::Trace(VcdError::Text { place: blocks.place(blocks.end()), problem }))
    }
}
