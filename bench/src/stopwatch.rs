//! Times repetitions by the wall.

use std::time::{Duration, Instant};

/// Repeats what it is given, and keeps how long each repetition took.
#[derive(Debug)]
pub(crate) struct Stopwatch {
    repetitions: usize,
    times: Vec<Duration>,
}

impl Stopwatch {
    /// For so many timed repetitions.
    pub(crate) fn new(repetitions: usize) -> Self {
        Self { repetitions, times: Vec::with_capacity(repetitions) }
    }

    /// Times `work`, after once without a clock.
    pub(crate) fn time(&mut self, mut work: impl FnMut()) {
        self.time_prepared(&mut (), |()| {}, |()| work());
    }

    /// Times `work` on a state that is prepared before each repetition, while the clock stands.
    pub(crate) fn time_prepared<S>(
        &mut self,
        state: &mut S,
        mut prepare: impl FnMut(&mut S),
        mut work: impl FnMut(&mut S),
    ) {
        prepare(state);
        work(state);
        for _ in 0..self.repetitions {
            prepare(state);
            let start = Instant::now();
            work(state);
            self.times.push(start.elapsed());
        }
    }

    /// The times taken, in order.
    pub(crate) fn times(&self) -> &[Duration] {
        &self.times
    }
}
