//! From a survey to the clock: its edge, the pulses that are too short, whether there are samples enough.
//!
//! *Samples a clock* is the mean period in samples, pauses left out. Under four it is a warning: an edge can be a whole sample late, a quarter of the
//! period. Under two there is nothing to recover, and what one sees then is an alias: a clock that looks slower than
//! it is. It shows in the data. Between two changes of a wire there is a clock at least, so if wires often change faster than what
//! seems to be the clock, that is not the clock.
//!
//! *Too short* is a pulse of less than half of the usual length of its level. Sampling alone makes a pulse of `n` samples
//! `⌊n⌋` at least, which is not less than half of it.

use firmware::camif::pins::Edge;

use super::super::edges::PCLK;
use super::finder::Plan;
use super::survey::Survey;

/// Fewest distances between changes of a wire from which an alias can be told.
const EVIDENCE: usize = 200;

/// Part of the changes that is nearer to one edge than to the other where it is clear which.
const CLEARLY: f64 = 2.0 / 3.0;

/// How still the other wires are at an edge of the clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stillness {
    /// Changes of other wires that were looked at.
    pub changes: u64,
    /// Of these, the part that is nearer to a falling edge than to a rising one, 0 to 1.
    pub near_falling: f64,
}

/// The pixel clock of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Its frequency in hertz, if the capture has a unit of time.
    pub hertz: Option<f64>,
    /// Samples a second of the analyser, if it is known.
    pub sample_rate: Option<f64>,
    /// Samples a period of the clock, if the sample rate is known.
    pub samples_per_clock: Option<f64>,
    /// The edge at which the wires are read.
    pub edge: Edge,
    /// It is not the edge that was asked for: the data moves there.
    pub edge_was_changed: bool,
    /// Where the data moves, if it moves.
    pub stillness: Option<Stillness>,
    /// Pulses of less than this are dropped, in units of time of the capture: low ones, high ones.
    pub shortest: [u64; 2],
}

/// Why there is no clock to be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClockError {
    /// The wire has no period.
    #[error(
        "`{0}` never has two rising edges, so there is no clock; check the capture, or name another wire with --map PCLK=…"
    )]
    None(String),
    /// Fewer than two samples a period.
    #[error(
        "`{signal}` has fewer than 2 samples a clock: it seems to have {seen:.2}, yet {percent:.0}% of the changes of other wires follow \
         each other faster than that; capture again with at least 4 samples a clock, or name the clock with --map PCLK=…"
    )]
    Undersampled {
        /// The clock's signal.
        signal: String,
        /// Samples a clock that it seems to have.
        seen: f64,
        /// Part of the distances that are shorter than a clock, in percent.
        percent: f64,
    },
}

/// What is known beside the survey.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Known {
    /// Units of time a second.
    pub(in super::super) ticks_per_second: Option<f64>,
    pub(in super::super) sample_rate: Option<f64>,
    /// It was recorded by an analyser, whose samples know nothing of the clock.
    pub(in super::super) sampled: bool,
    /// The edge that is asked for.
    pub(in super::super) edge: Edge,
    /// Seconds of the shortest pulse, if that is asked for.
    pub(in super::super) shortest: Option<f64>,
}

impl Clock {
    /// Decides.
    ///
    /// # Errors
    /// [`ClockError`].
    pub(in super::super) fn choose(survey: &Survey, known: Known, signal: &str) -> Result<Self, ClockError> {
        let period = usual(&survey.periods).ok_or_else(|| ClockError::None(signal.to_owned()))?;
        let hertz = known.ticks_per_second.map(|ticks| ticks / period);
        // Units of time a sample.
        let sample = known.sample_rate.zip(known.ticks_per_second).map(|(rate, ticks)| ticks / rate);
        let samples_per_clock = sample.map(|sample| period / sample);
        if let (true, Some(sample), Some(seen)) = (known.sampled, sample, samples_per_clock) {
            undersampled(survey, signal, seen, sample)?;
        }
        let changes: u64 = survey.near.iter().sum();
        let stillness = (changes > 0)
            .then(|| Stillness { changes, near_falling: survey.near[0] as f64 / changes as f64 });
        let moves_at = |edge| {
            stillness.map_or(0.0, |found| match edge {
                Edge::Rising => 1.0 - found.near_falling,
                Edge::Falling => found.near_falling,
            })
        };
        // Clearly more changes at this edge than at the other one: two of three.
        let changed = known.sampled && changes >= 16 && moves_at(known.edge) > CLEARLY;
        let edge = if changed { other(known.edge) } else { known.edge };
        let shortest = survey.pulses.each_ref().map(|pulses| {
            let asked = known.shortest.zip(known.ticks_per_second).map(|(seconds, ticks)| seconds * ticks);
            let half = usual(pulses).filter(|_| known.sampled).map_or(0.0, |pulse| pulse / 2.0);
            asked.unwrap_or(half).ceil() as u64
        });
        let sample_rate = known.sample_rate;
        Ok(Self {
            hertz,
            sample_rate,
            samples_per_clock,
            edge,
            edge_was_changed: changed,
            stillness,
            shortest,
        })
    }

    /// The edge at which the other wires are still, if that is clear: more than two of three changes are nearer to the other edge.
    #[must_use]
    pub fn still_edge(&self) -> Option<Edge> {
        let found = self.stillness.filter(|found| found.changes >= 16)?;
        [(Edge::Rising, found.near_falling), (Edge::Falling, 1.0 - found.near_falling)]
            .into_iter()
            .find_map(|(edge, away)| (away > CLEARLY).then_some(edge))
    }

    pub(in super::super) fn plan(&self) -> Plan {
        let [low, high] = self.shortest;
        match self.edge {
            Edge::Rising => Plan { idle: 0, shortest: [low, high] },
            Edge::Falling => Plan { idle: PCLK, shortest: [high, low] },
        }
    }

    /// What the user should know of it, a line each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(samples) = self.samples_per_clock.filter(|&samples| samples < 4.0) {
            notes.push(format!(
                "warning: only {samples:.2} samples a clock; edges are a quarter of a period wrong and more: capture with at least 4"
            ));
        }
        let Some(found) = self.stillness else { return notes };
        let (asked, name, part) = match other(self.edge) {
            Edge::Rising => ("rising", "falling", 1.0 - found.near_falling),
            Edge::Falling => ("falling", "rising", found.near_falling),
        };
        if self.edge_was_changed {
            notes.push(format!(
                "the wires move at the {asked} edge of the clock ({:.0}% of {} changes): read at the {name} edge, where they are still",
                100.0 * part,
                found.changes
            ));
        }
        notes
    }
}

fn other(edge: Edge) -> Edge {
    match edge {
        Edge::Rising => Edge::Falling,
        Edge::Falling => Edge::Rising,
    }
}

/// The mean of the lengths near the median, so that pauses and short pulses do not count.
fn usual(lengths: &[u64]) -> Option<f64> {
    let mut sorted = lengths.to_vec();
    sorted.sort_unstable();
    let median = *sorted.get(sorted.len() / 2)?;
    let near = sorted.iter().filter(|&&length| length >= median.div_ceil(2) && length <= median + median / 2);
    let (sum, count) = near.fold((0.0, 0.0), |(sum, count), &length| (sum + length as f64, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Tells an alias by wires that change faster than the clock.
fn undersampled(survey: &Survey, signal: &str, seen: f64, sample: f64) -> Result<(), ClockError> {
    let slow = if seen < 4.0 { seen.floor() } else { (seen * 0.75).floor() };
    let short =
        survey.distances.iter().filter(|&&distance| (distance as f64 / sample).round() < slow).count();
    let part = short as f64 / survey.distances.len().max(1) as f64;
    let limit = if seen < 4.0 { 0.02 } else { 0.25 };
    let alias = survey.distances.len() >= EVIDENCE && part > limit;
    // Two samples a clock, one high and one low, are the fewest that can be seen at all.
    if seen < 2.0 || alias {
        let signal = signal.to_owned();
        return Err(ClockError::Undersampled { signal, seen, percent: 100.0 * part });
    }
    Ok(())
}
