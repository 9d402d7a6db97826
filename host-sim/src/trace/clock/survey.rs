//! The beginning of a capture: what the clock looks like, and when the other wires move.
//!
//! ```text
//!            rise         fall         rise
//! PCLK   ____┌────────────┐____________┌───
//! data            X            X                    each change is nearest to one edge: the other one is where
//!                 └ rise       └ fall               the data is still
//! ```

use super::super::edges::{PCLK, WIRES};
use super::super::levels::{Enough, LevelSink};

/// Periods and changes that are enough, and calls after which it ends anyway.
const ENOUGH: usize = 4096;
const CALLS: u32 = 1 << 21;

/// How long the clock is at its levels, and what the other wires do.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Survey {
    before: Option<u64>,
    /// The last edge of the clock, and whether it was a rise.
    edge: Option<(u64, bool)>,
    rise: Option<u64>,
    /// From rise to rise.
    pub(super) periods: Vec<u64>,
    /// Lengths of low and of high pulses.
    pub(super) pulses: [Vec<u64>; 2],
    /// Changes of a wire since the last edge of the clock.
    waiting: Vec<u64>,
    /// Times at which some wire changed, by the edge they are nearest to: fall, rise.
    pub(super) near: [u64; 2],
    /// Of those, in the very same unit of time as the edge.
    pub(super) with: [u64; 2],
    /// When each wire changed last, and how far apart the changes of one wire are.
    last: [Option<u64>; 18],
    pub(super) distances: Vec<u64>,
    calls: u32,
}

impl Survey {
    /// A wire changed at `time`, between the edge before and the one at `next`.
    fn assign(&mut self, time: u64, next: Option<(u64, bool)>) {
        let Some((last, rose)) = self.edge else { return };
        let behind = time - last;
        let (rise, distance) = match next {
            Some((next, rises)) if next - time < behind => (rises, next - time),
            _ => (rose, behind),
        };
        self.near[usize::from(rise)] += 1;
        self.with[usize::from(rise)] += u64::from(distance == 0);
    }
}

impl LevelSink for Survey {
    type Error = Enough;

    fn watched(&self) -> u64 {
        WIRES
    }

    fn levels(&mut self, time: u64, state: u64) -> Result<(), Enough> {
        self.calls += 1;
        let Some(before) = self.before.replace(state) else { return Ok(()) };
        let changed = (state ^ before) & WIRES;
        if changed & PCLK != 0 {
            let rises = state & PCLK != 0;
            for change in std::mem::take(&mut self.waiting) {
                self.assign(change, Some((time, rises)));
            }
            if let Some((last, rose)) = self.edge {
                self.pulses[usize::from(rose)].push(time - last);
            }
            if rises && let Some(last) = self.rise.replace(time) {
                self.periods.push(time - last);
            }
            self.edge = Some((time, rises));
        }
        let mut others = changed & !PCLK;
        if others != 0 {
            if changed & PCLK != 0 {
                self.assign(time, None);
            } else {
                self.waiting.push(time);
            }
            while others != 0 {
                let wire = others.trailing_zeros() as usize % self.last.len();
                if let Some(last) = self.last[wire].replace(time) {
                    self.distances.push(time - last);
                }
                others &= others - 1;
            }
        }
        // Changes without a clock are remembered only so far.
        self.waiting.truncate(ENOUGH);
        let seen = self.periods.len() >= ENOUGH && self.distances.len() >= ENOUGH;
        if seen || self.calls >= CALLS { Err(Enough) } else { Ok(()) }
    }
}
