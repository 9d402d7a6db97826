//! Levels of wires over time: what a capture holds before anybody knows what the wires mean.
//!
//! ```text
//! time        0      5      10     13                    units of the capture, see Capture::ticks_per_second
//! channel 0   ____───────────______________
//! channel 1   ___________────────────______
//! calls       00     01     11     10            levels(time, state): bit i is the level of the i-th chosen channel
//! ```

/// Takes levels change by change.
pub trait LevelSink {
    /// Why the sink wants no more.
    type Error;

    /// Bits of the state whose changes the sink wants to be told; others may have changed too when it is told. Asked once,
    /// at the beginning. Watching fewer bits is faster.
    #[inline]
    fn watched(&self) -> u64 {
        u64::MAX
    }

    /// From `time` on the levels are `state`. Times never run backwards. The first call says how the wires stand at the
    /// beginning; after it a watched bit has changed, unless the capture says the same level twice.
    ///
    /// # Errors
    /// Whatever the sink has; the player stops and hands it on.
    fn levels(&mut self, time: u64, state: u64) -> Result<(), Self::Error>;
}

/// What was played of a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelsPlayed {
    /// When the capture ends, as far as the format says; else the time of the last change.
    pub end: u64,
    /// Levels that the capture does not know (x, z, or X in a gap), which were given as 0.
    pub unknown: u64,
}

/// Changes held in memory: a [`LevelSink`] for the beginning of a capture.
#[derive(Clone, Debug, Default)]
pub struct Levels {
    /// When; as many as `states`.
    pub times: Vec<u64>,
    /// The levels from then on.
    pub states: Vec<u64>,
    limit: usize,
}

/// A sink has seen as much as it wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enough;

impl Levels {
    /// Takes the first `limit` changes. A change is 16 bytes.
    #[must_use]
    pub fn at_most(limit: usize) -> Self {
        Self { times: Vec::new(), states: Vec::new(), limit }
    }
}

impl LevelSink for Levels {
    type Error = Enough;

    fn levels(&mut self, time: u64, state: u64) -> Result<(), Enough> {
        if self.times.len() >= self.limit {
            return Err(Enough);
        }
        self.times.push(time);
        self.states.push(state);
        Ok(())
    }
}
