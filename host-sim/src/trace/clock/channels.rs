//! Any channel of a capture as its clock, for who does not know yet which wire is what.
//!
//! ```text
//! clock     __──__──__──__──
//! others    A───B───C───D───       calls: A B C D, bit i is the level of the i-th of the others
//! ```

use firmware::camif::pins::Edge;

use super::super::PlayError;
use super::super::capture::{CHANNELS, Capture};
use super::super::edges::{EdgeSink, PCLK};
use super::super::error::TraceError;
use super::super::levels::Enough;
use super::super::wiring::Tap;
use super::{Clock, ClockError, Finder, Known, Survey};

/// Bits of the survey's state for other wires.
const SURVEYED: [u32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 16, 17];

impl Capture {
    /// The clock that a channel makes in the beginning of the capture; its edge is where the `others` (the first 16 of them) are still.
    ///
    /// # Errors
    /// The trace's; [`ClockError`] inside if the channel is no clock.
    pub fn clock_of(&self, clock: usize, others: &[usize]) -> Result<Result<Clock, ClockError>, TraceError> {
        let mut wires = vec![(self.tap(clock)?, PCLK)];
        for (&other, bit) in others.iter().zip(SURVEYED) {
            wires.push((self.tap(other)?, 1 << bit));
        }
        let survey = self.survey(&wires)?;
        let name = self.channels().get(clock).map(|channel| channel.name.clone()).unwrap_or_default();
        let chosen = Clock::choose(&survey, self.known(Edge::Rising, None), &name);
        Ok(chosen.map(|clock| match clock.still_edge() {
            Some(edge) => Clock { edge, ..clock },
            None => clock,
        }))
    }

    /// Plays the levels of the `others` (at most 62) at every active edge of the clock, until the sink has [`Enough`].
    ///
    /// # Errors
    /// The trace's.
    pub fn play_at_edges(
        &self,
        (channel, clock): (usize, &Clock),
        others: &[usize],
        sink: &mut dyn FnMut(u64) -> Result<(), Enough>,
    ) -> Result<(), TraceError> {
        if others.len() >= CHANNELS {
            return Err(self.no_channel());
        }
        let mut wires = vec![(self.tap(channel)?, PCLK)];
        for (index, &other) in others.iter().enumerate() {
            // The clock has a bit among them.
            let bit = index as u32 + u32::from(1 << index >= PCLK);
            wires.push((self.tap(other)?, 1 << bit));
        }
        let mut states = States(sink);
        let mut finder = Finder::new(clock.plan(), &mut states);
        match self.play_wires(&wires, &mut finder, &mut |_| ()) {
            Err(PlayError::Trace(error)) => return Err(error),
            Err(PlayError::Sink(Enough)) => return Ok(()),
            Ok(_) => {}
        }
        let _ = finder.finish();
        Ok(())
    }

    fn tap(&self, channel: usize) -> Result<Tap, TraceError> {
        self.channels().get(channel).map(|channel| channel.tap).ok_or_else(|| self.no_channel())
    }

    fn no_channel(&self) -> TraceError {
        TraceError::Channels { path: self.path().to_owned(), has: self.channels().len() }
    }

    /// Surveys the beginning.
    pub(in super::super) fn survey(&self, wires: &[(Tap, u64)]) -> Result<Survey, TraceError> {
        let mut survey = Survey::default();
        match self.play_wires(wires, &mut survey, &mut |_| ()) {
            Err(PlayError::Trace(error)) => Err(error),
            Ok(_) | Err(PlayError::Sink(_)) => Ok(survey),
        }
    }

    /// What is known of the clock beside the survey.
    pub(in super::super) fn known(&self, edge: Edge, shortest: Option<f64>) -> Known {
        Known {
            ticks_per_second: self.ticks_per_second(),
            sample_rate: self.sample_rate(),
            sampled: self.is_sampled(),
            edge,
            shortest,
        }
    }
}

/// The clock's own bit taken out.
struct States<'s>(&'s mut dyn FnMut(u64) -> Result<(), Enough>);

impl EdgeSink for States<'_> {
    type Error = Enough;

    fn edge(&mut self, state: u64, _: u64) -> Result<(), Enough> {
        let below = state & (PCLK - 1);
        self.0(below | (state & !(PCLK | (PCLK - 1))) >> 1)
    }
}
