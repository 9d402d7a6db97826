//! The value changes, and the rule of when a sample is taken.
//!
//! ```text
//! #18084   the time stamp before ends: was there an active edge? then its state is a sample
//! 0!  1%   scalars: identifier ─► mask ─► state
//! b101 "   vectors
//! ```
//!
//! **When a sample is taken.** All changes of a time stamp happen at once. If PCLK has its active edge in a time
//! stamp, the sample is the state after *all* changes of that stamp, in whatever order they stand. So both usual
//! styles give what was meant: data that changes with the opposite edge (as sensors do), and data written
//! together with the active edge ("set the pins, raise the clock"). A simulation in which registers launch new data *by*
//! the active edge itself means the state before it: that is [`SamplePoint::BeforeEdge`].
//!
//! Values of `$dumpvars` (and of `$dumpon`, `$dumpoff`) are where the wires stand, not edges. Two exceptions serve generators
//! that begin with a sample. Some tools (pyvcd) put all changes of the first time stamp into `$dumpvars`: if the clock is active
//! there, every wire is known, and then nothing but the clock changes up to and with its next inactive edge, that was the first
//! sample. And where there is no `$dumpvars`, a first level of the clock that is active is an edge. Unknown values (x, z) read as 0 and are counted; an unknown clock is
//! inactive.
//!
//! Runs of common changes go through a loop of their own ([`common`](super::common)); what stops it is taken one token at a time
//! ([`rare`]), which knows everything and says what is wrong.

use super::super::edges::{EdgeSink, PCLK, WIRES};
use super::blocks::TAIL;
use super::error::Problem;
use super::ids::IdTable;
use super::rare;
use super::stamp::Guess;

/// Which state is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplePoint {
    /// After all changes of the time stamp that has the active edge.
    #[default]
    AtEdge,
    /// Before them: registers that launch data by the active edge.
    BeforeEdge,
}

/// In which section of the changes the parser is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Section {
    #[default]
    Changes,
    /// `$dumpvars` and the like: values as they stand.
    Standing(&'static str),
    /// `$dumpall`.
    Checkpoint,
    /// `$comment` and unknown sections.
    Skipped,
}

/// Where the parser is between two tokens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Machine {
    /// The wires now.
    pub(super) state: u64,
    /// The wires at the end of the time stamp before.
    pub(super) settled: u64,
    pub(super) time: u64,
    /// Unknown values on wires.
    pub(super) unknown: u64,
    pub(super) section: Section,
    /// PCLK if it idles high, as with a falling active edge; else 0.
    pub(super) idle: u64,
    point: SamplePoint,
    /// State and time of a `$dumpvars` that may turn out to be the first sample.
    pub(super) first: Option<(u64, u64)>,
    /// What the next time stamp is likely to look like.
    pub(super) guess: Guess,
}

/// Why the parser stopped.
#[derive(Debug)]
pub(super) enum Stop<E> {
    /// The token that begins here is not whole: more of the file is needed.
    More,
    /// The text is wrong here.
    Text(usize, Problem),
    /// The sink wanted no more.
    Sink(E),
}

impl Machine {
    pub(super) fn new(falling: bool, point: SamplePoint) -> Self {
        let idle = if falling { PCLK } else { 0 };
        Self {
            state: idle,
            settled: idle,
            time: 0,
            unknown: 0,
            section: Section::default(),
            idle,
            point,
            first: None,
            guess: Guess::default(),
        }
    }

    /// Parses from `at`, up to the end of the block if it is the `last`, else to where the next token may not be whole.
    /// `bytes` has a blank tail behind `end`. Gives back where it stopped, at the start of a token.
    pub(super) fn run<S: EdgeSink>(
        &mut self,
        bytes: &[u8],
        mut at: usize,
        end: usize,
        last: bool,
        ids: &IdTable,
        sink: &mut S,
    ) -> (usize, Result<(), Stop<S::Error>>) {
        let limit = if last { end } else { end.saturating_sub(TAIL) };
        let stop = loop {
            // A section that is skipped may hold anything.
            if self.section != Section::Skipped {
                let (next, taken) = self.common(bytes, at, limit, ids, sink);
                at = next;
                if let Err(error) = taken {
                    break Err(Stop::Sink(error));
                }
            }
            if at >= limit {
                break Ok(());
            }
            match rare::token(*self, bytes, at, end, last, ids) {
                Ok(rare::Step::Go(then, next)) => {
                    *self = then;
                    at = next;
                }
                Ok(rare::Step::Time(time, next)) => {
                    if let Err(error) = self.close(sink) {
                        break Err(Stop::Sink(error));
                    }
                    self.time = time;
                    at = next;
                }
                Err((place, Some(problem))) => break Err(Stop::Text(place, problem)),
                Err((_, None)) => break Err(Stop::More),
            }
        };
        (at.min(end), stop)
    }

    /// The time stamp ends: takes a sample if it had an active edge.
    #[inline(always)]
    pub(super) fn close<S: EdgeSink>(&mut self, sink: &mut S) -> Result<(), S::Error> {
        if S::EVERY {
            return sink.edge(self.state, self.time);
        }
        if self.first.is_some() {
            self.look_at_first(sink)?;
        }
        let (state, settled) = (self.state, self.settled);
        self.settled = state;
        if (state ^ self.idle) & !(settled ^ self.idle) & PCLK != 0 {
            let sampled = if self.point == SamplePoint::AtEdge { state } else { settled };
            sink.edge(sampled, self.time)?;
        }
        Ok(())
    }

    /// Decides about the `$dumpvars` that stood with an active clock, as soon as something else happens.
    #[cold]
    fn look_at_first<S: EdgeSink>(&mut self, sink: &mut S) -> Result<(), S::Error> {
        let Some((state, time)) = self.first else { return Ok(()) };
        let changed = (self.state ^ state) & WIRES;
        if changed != 0 {
            self.first = None;
        }
        if changed == PCLK && self.point == SamplePoint::AtEdge {
            sink.edge(state, time)?;
        }
        Ok(())
    }
}
