//! A state at every active edge of the clock.
//!
//! An edge counts when the level behind it has held for long enough: so it is held back until the next edge. A pulse that is too short, of
//! either level, is as if it had not been: both of its edges vanish and the level before it goes on.

use super::super::edges::{EdgeSink, PCLK};
use super::super::levels::LevelSink;

/// What is taken for an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct Plan {
    /// PCLK if the clock idles high, as with a falling active edge; else 0.
    pub(in super::super) idle: u64,
    /// The shortest pulse that counts, in units of time: of the inactive level, and of the active one.
    pub(in super::super) shortest: [u64; 2],
}

/// Finds the edges and hands the states on.
#[derive(Debug)]
pub(in super::super) struct Finder<'s, S> {
    plan: Plan,
    sink: &'s mut S,
    /// When the level began, and the one before it; nothing for those that were there from the beginning.
    since: Option<u64>,
    before: Option<u64>,
    active: Option<bool>,
    held: Option<(u64, u64)>,
    /// Pulses that were too short.
    pub(in super::super) dropped: u64,
}

impl<'s, S: EdgeSink> Finder<'s, S> {
    pub(in super::super) fn new(plan: Plan, sink: &'s mut S) -> Self {
        Self { plan, sink, since: None, before: None, active: None, held: None, dropped: 0 }
    }

    /// The capture ends: an edge that was held back counts.
    pub(in super::super) fn finish(&mut self) -> Result<(), S::Error> {
        match self.held.take() {
            Some((state, time)) => self.sink.edge(state, time),
            None => Ok(()),
        }
    }
}

impl<S: EdgeSink> LevelSink for Finder<'_, S> {
    type Error = S::Error;

    #[inline]
    fn watched(&self) -> u64 {
        PCLK
    }

    #[inline(always)]
    fn levels(&mut self, time: u64, state: u64) -> Result<(), S::Error> {
        let active = (state ^ self.plan.idle) & PCLK != 0;
        let Some(was) = self.active else {
            // Where the clock stands is no edge.
            self.active = Some(active);
            return Ok(());
        };
        if was == active {
            return Ok(());
        }
        self.active = Some(active);
        let too_short = |since: u64| time - since < self.plan.shortest[usize::from(was)];
        if self.since.is_some_and(too_short) {
            self.dropped += 1;
            self.since = self.before;
            self.held = None;
            return Ok(());
        }
        let held = self.held.take();
        (self.before, self.since) = (self.since, Some(time));
        if active {
            self.held = Some((state, time));
        }
        match held {
            Some((state, time)) => self.sink.edge(state, time),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[derive(Default)]
    struct Edges(Vec<(u64, u64)>);

    impl EdgeSink for Edges {
        type Error = Infallible;
        fn edge(&mut self, state: u64, time: u64) -> Result<(), Infallible> {
            self.0.push((time, state & 0xFF));
            Ok(())
        }
    }

    /// Draws the clock, a character a unit of time; the data is the time.
    fn edges(wave: &str, falling: bool, shortest: u64) -> (Vec<u64>, u64) {
        let mut found = Edges::default();
        let plan = Plan { idle: if falling { PCLK } else { 0 }, shortest: [shortest; 2] };
        let mut finder = Finder::new(plan, &mut found);
        for (time, level) in wave.bytes().enumerate() {
            let clock = if level == b'-' { PCLK } else { 0 };
            finder.levels(time as u64, clock | time as u64).unwrap();
        }
        finder.finish().unwrap();
        let dropped = finder.dropped;
        assert!(found.0.iter().all(|(time, state)| time == state));
        (found.0.into_iter().map(|(time, _)| time).collect(), dropped)
    }

    #[test]
    fn edges_of_either_kind_are_found_and_short_pulses_vanish() {
        assert_eq!(edges("___---___---___", false, 0), (vec![3, 9], 0));
        assert_eq!(edges("___---___---___", true, 0), (vec![6, 12], 0));
        assert_eq!(edges("---___---___", false, 0), (vec![6], 0));
        // Too short high, low, both, and at the end, where nobody knows.
        assert_eq!(edges("___---___-___---___", false, 2), (vec![3, 13], 1));
        assert_eq!(edges("____--_--____---", false, 2), (vec![4, 13], 1));
        assert_eq!(edges("____--_-_--____---", false, 2), (vec![4, 15], 2));
        assert_eq!(edges("____---___-", false, 2), (vec![4, 10], 0));
        // The level at the beginning began before it.
        assert_eq!(edges("-___---", false, 2), (vec![4], 0));
        assert_eq!(edges("", false, 2), (vec![], 0));
    }
}
