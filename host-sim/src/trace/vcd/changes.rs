//! The value changes: the loop that decides how fast a VCD is read.
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
//! Cost: one load of eight bytes a change, one table entry, one update of a register; no branch depends on a value.

use super::blocks::TAIL;
use super::error::Problem;
use super::ids::{IdTable, PCLK, VECTOR};
use super::rare;
use super::scan::{binary, bit_count, blanks, decimal, digit_count, is_blank, load};

/// Which state is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplePoint {
    /// After all changes of the time stamp that has the active edge.
    #[default]
    AtEdge,
    /// Before them: registers that launch data by the active edge.
    BeforeEdge,
}

/// Takes the state of the wires at every active edge of the clock.
pub(super) trait EdgeSink {
    type Error;
    fn edge(&mut self, state: u32, time: u64) -> Result<(), Self::Error>;
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
    pub(super) state: u32,
    /// The wires at the end of the time stamp before.
    pub(super) settled: u32,
    pub(super) time: u64,
    /// Unknown values on wires.
    pub(super) unknown: u64,
    pub(super) section: Section,
    /// PCLK if it idles high, as with a falling active edge; else 0.
    pub(super) idle: u32,
    point: SamplePoint,
    /// State and time of a `$dumpvars` that may turn out to be the first sample.
    pub(super) first: Option<(u32, u64)>,
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

/// Ten to the power of the index.
const POWERS: [u64; 8] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000];

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
        // A copy in registers; what is rare gets it by value.
        let mut now = *self;
        let limit = if last { end } else { end.saturating_sub(TAIL) };
        let stop = loop {
            if at >= limit {
                break Ok(());
            }
            let word = load(bytes, at);
            let first = word as u8;
            if first & 0xFE == b'0' && now.section != Section::Skipped {
                // Scalar. Most identifiers are short; predicting their length hides the search for their end.
                let (key, length) = if is_blank((word >> 16) as u8) {
                    (word >> 8 & 0xFF, 1)
                } else if is_blank((word >> 24) as u8) {
                    (word >> 8 & 0xFFFF, 2)
                } else {
                    let ends = (blanks(word) & !0xFF).trailing_zeros() / 8;
                    // Without an end in sight the key is 0, which nothing has.
                    let kept = 1_u64.checked_shl(8 * ends).map_or(0, |bit| bit - 1);
                    ((word & kept) >> 8, ends.wrapping_sub(1) as usize)
                };
                let entry = ids.first(key);
                if entry.key == key {
                    now.state = now.state & !entry.mask | entry.mask & (word as u32 & 1).wrapping_neg();
                    at += length + 2;
                    continue;
                }
            } else if first == b'#' && now.section != Section::Skipped {
                let digits = load(bytes, at + 1);
                let count = digit_count(digits);
                let mut next = at + 1 + count as usize;
                if count > 0 {
                    let mut time = decimal(digits, count);
                    let mut more = 0;
                    if count == 8 {
                        let digits = load(bytes, next);
                        more = digit_count(digits);
                        if let (1.., Some(power)) = (more, POWERS.get(more as usize)) {
                            time = time * power + decimal(digits, more);
                            next += more as usize;
                        }
                    }
                    if more < 8 && bytes.get(next).copied().is_some_and(is_blank) && time > now.time {
                        if let Err(error) = now.close(sink) {
                            break Err(Stop::Sink(error));
                        }
                        now.time = time;
                        at = next + 1;
                        continue;
                    }
                }
            } else if first | 0x20 == b'b'
                && now.section != Section::Skipped
                && let Some((bits, mask, next)) = short_vector(bytes, at, ids)
            {
                now.state = now.state & !mask | bits;
                at = next;
                continue;
            }
            if is_blank(first) {
                at += 1;
                continue;
            }
            match rare::token(now, bytes, at, end, last, ids) {
                Ok(rare::Step::Go(then, next)) => {
                    now = then;
                    at = next;
                }
                Ok(rare::Step::Time(time, next)) => {
                    if let Err(error) = now.close(sink) {
                        break Err(Stop::Sink(error));
                    }
                    now.time = time;
                    at = next;
                }
                Err((place, Some(problem))) => break Err(Stop::Text(place, problem)),
                Err((_, None)) => break Err(Stop::More),
            }
        };
        *self = now;
        (at.min(end), stop)
    }

    /// The time stamp ends: takes a sample if it had an active edge.
    #[inline(always)]
    pub(super) fn close<S: EdgeSink>(&mut self, sink: &mut S) -> Result<(), S::Error> {
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
        let changed = self.state ^ state;
        if changed != 0 {
            self.first = None;
        }
        if changed == PCLK && self.point == SamplePoint::AtEdge {
            sink.edge(state, time)?;
        }
        Ok(())
    }
}

/// A vector of up to 16 known bits with a short identifier: the bits of the state, their mask, and where the next token
/// begins. `None` for anything else, which is then looked at without haste.
#[inline(always)]
fn short_vector(bytes: &[u8], at: usize, ids: &IdTable) -> Option<(u32, u32, usize)> {
    let word = load(bytes, at + 1);
    let count = bit_count(word);
    if count == 0 {
        return None;
    }
    let mut value = binary(word, count);
    let mut next = at + 1 + count as usize;
    if count == 8 {
        let word = load(bytes, next);
        let more = bit_count(word);
        if more > 0 {
            value = value << more | binary(word, more);
            next += more as usize;
        }
    }
    let word = load(bytes, next);
    let ends = (blanks(word) & !0xFF).trailing_zeros() / 8;
    if !is_blank(word as u8) || !(2..8).contains(&ends) {
        return None;
    }
    let key = (word & ((1 << (8 * ends)) - 1)) >> 8 | VECTOR;
    let entry = ids.first(key);
    let digits = next - at - 1;
    if entry.key != key || digits > entry.width() as usize {
        return None;
    }
    let next = next + ends as usize + 1;
    Some(ids.vector(entry).map_or((0, 0, next), |vector| (vector.bits(value), vector.mask, next)))
}
