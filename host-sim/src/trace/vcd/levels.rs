//! A VCD file as levels of any of its signals.

use std::io::Read;

use super::super::PlayError;
use super::super::capture::About;
use super::super::edges::EdgeSink;
use super::super::levels::{LevelSink, LevelsPlayed};
use super::super::wiring::Tap;
use super::changes::SamplePoint;
use super::error::VcdError;
use super::header::Declarations;
use super::reader::Parser;

/// A VCD file whose declarations are read.
#[derive(Debug)]
pub(in super::super) struct VcdLevels<R> {
    parser: Parser<R>,
    declared: Declarations,
}

/// Tells a sink of levels what changed in a time stamp.
struct Told<'s, S> {
    sink: &'s mut S,
    watched: u64,
    before: Option<u64>,
    end: u64,
}

impl<S: LevelSink> EdgeSink for Told<'_, S> {
    const EVERY: bool = true;
    type Error = S::Error;

    #[inline(always)]
    fn edge(&mut self, state: u64, time: u64) -> Result<(), S::Error> {
        self.end = time;
        if self.before.is_some_and(|before| (before ^ state) & self.watched == 0) {
            return Ok(());
        }
        self.before = Some(state);
        self.sink.levels(time, state)
    }
}

impl<R: Read> VcdLevels<R> {
    pub(in super::super) fn new(inner: R) -> Result<Self, VcdError> {
        let (parser, declared) = Parser::new(inner)?;
        Ok(Self { parser, declared })
    }

    pub(in super::super) fn about(&self) -> About {
        let declared = &self.declared;
        About {
            signals: declared.signals.clone(),
            ticks_per_second: declared.timescale_fs.map(|unit| 1e15 / unit as f64),
            sample_rate: declared.sample_rate.map(|rate| rate as f64),
            sampled: declared.sampled,
        }
    }

    pub(in super::super) fn play<S: LevelSink>(
        mut self,
        wires: &[(Tap, u64)],
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<LevelsPlayed, PlayError<VcdError, S::Error>> {
        self.parser.wire(&self.declared, wires, false, SamplePoint::AtEdge).map_err(PlayError::Trace)?;
        // The dump begins with unknown levels that it is about to tell, so the first call waits for them.
        let watched = sink.watched();
        let mut told = Told { sink, watched, before: None, end: 0 };
        self.parser.parse(&mut told, progress)?;
        Ok(LevelsPlayed { end: told.end, unknown: self.parser.unknown() })
    }
}
