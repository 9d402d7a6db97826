//! A wire called HREF, LV or FV meets a profile with a high blanking level.
//!
//! ```text
//! HREF    ____┌────────────┐____┌────────────┐____      by its name: data is valid while it is high
//!             │ 1,920      │ 40 │ 1,920      │
//! profile     hsync_blank = "high", 1,920 clocks a line: data is valid while HSYNC is low
//! ```
//!
//! Name and profile disagree; the trace decides. If the runs of one level, and only of that one, are as long as the profile's
//! lines, then that is the level at which data is valid. If neither level fits, the wire is taken as it is. In marker mode a
//! sync wire has no level at which data is valid, and nothing is decided.

use std::collections::BTreeMap;

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::wiring::SyncName;

/// A sync wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// HSYNC: its valid runs are lines.
    Hsync,
    /// VSYNC: its valid runs are frames.
    Vsync,
}

/// Different lengths that are remembered for a level; real wires have a handful.
const LENGTHS: usize = 256;

/// How long a wire stays high and low: a sink for the beginning of a trace.
#[derive(Clone, Debug)]
pub struct RunLengths {
    wire: Wire,
    /// Clocks still to be looked at.
    left: u64,
    level: Option<bool>,
    run: u64,
    /// The run began with an edge, so its length is known.
    whole: bool,
    /// How often each length occurred, low and high.
    lengths: [BTreeMap<u64, u64>; 2],
}

/// A sink has seen as much of the trace as it wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enough;

impl RunLengths {
    /// Looks at the first `clocks` of a trace.
    #[must_use]
    pub fn new(wire: Wire, clocks: u64) -> Self {
        let lengths = [BTreeMap::new(), BTreeMap::new()];
        Self { wire, left: clocks, level: None, run: 0, whole: false, lengths }
    }

    /// The most frequent length of that level's runs, in pixel clocks.
    #[must_use]
    pub fn usual(&self, level: bool) -> Option<u64> {
        let [low, high] = &self.lengths;
        let lengths = if level { high } else { low };
        lengths.iter().max_by_key(|(length, count)| (**count, **length)).map(|(length, _)| *length)
    }
}

impl StretchSink for RunLengths {
    type Error = Enough;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Enough> {
        let level = match self.wire {
            Wire::Hsync => sync.hsync,
            Wire::Vsync => sync.vsync,
        };
        let clocks = samples.len() as u64;
        if self.level != Some(level) && clocks > 0 {
            if let (Some(ended), true) = (self.level, self.whole) {
                let [low, high] = &mut self.lengths;
                let lengths = if ended { high } else { low };
                if lengths.len() < LENGTHS || lengths.contains_key(&self.run) {
                    *lengths.entry(self.run).or_default() += 1;
                }
            }
            self.whole = self.level.is_some();
            (self.level, self.run) = (Some(level), 0);
        }
        self.run += clocks;
        self.left = self.left.saturating_sub(clocks);
        if self.left == 0 { Err(Enough) } else { Ok(()) }
    }
}

/// What the profile says of a wire in gated mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    /// The profile's blanking level is high.
    pub blank_high: bool,
    /// The sync mode is `marker`.
    pub marker: bool,
    /// Clocks of a line for HSYNC; for VSYNC the fewest that a frame can have: lines times clocks of a line.
    pub valid_clocks: u64,
}

/// Whether a wire is to be inverted, and why.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polarity {
    /// The wire's levels are to be exchanged before the block sees them.
    pub invert: bool,
    /// What to tell the user; nothing if name and profile agree.
    pub reason: Option<String>,
}

/// Decides whether a wire that is valid when high by its name is inverted to fit a profile.
#[must_use]
pub fn decide(name: &SyncName, expected: Expected, seen: &RunLengths) -> Polarity {
    if expected.marker || !name.valid_high || !expected.blank_high {
        return Polarity::default();
    }
    let clocks = expected.valid_clocks;
    let (unit, wire) = match seen.wire {
        Wire::Hsync => ("line", "hsync_blank"),
        Wire::Vsync => ("frame", "vsync_blank"),
    };
    let fits = |level| {
        seen.usual(level).is_some_and(|usual| match seen.wire {
            Wire::Hsync => usual == clocks,
            // Between the lines of a frame there may be blanking; between frames there is less than a frame of it.
            Wire::Vsync => usual >= clocks && usual > seen.usual(!level).unwrap_or(0),
        })
    };
    let signal = &name.signal;
    let both = format!("`{signal}` means valid when high by its name, the profile has {wire} = \"high\"");
    let (invert, reason) = match (fits(true), fits(false)) {
        (true, false) => {
            (true, format!("and its high runs are as long as a {unit} of {clocks} clocks: inverted"))
        }
        (false, true) => {
            (false, format!("and its low runs are as long as a {unit} of {clocks} clocks: taken as it is"))
        }
        _ => (
            false,
            format!(
                "and neither level alone fits a {unit} of {clocks} clocks (usually high for {}, low for {}): taken as \
                 it is; set {wire} = \"low\" if the name is right",
                words(seen.usual(true)),
                words(seen.usual(false))
            ),
        ),
    };
    Polarity { invert, reason: Some(format!("{both}, {reason}")) }
}

fn words(clocks: Option<u64>) -> String {
    clocks.map_or_else(|| "an unknown time".to_owned(), |clocks| clocks.to_string())
}

/// Exchanges the levels of sync wires on their way to a sink.
#[derive(Debug)]
pub struct Inverted<S> {
    /// Exchange the levels of HSYNC.
    pub hsync: bool,
    /// Exchange the levels of VSYNC.
    pub vsync: bool,
    /// Where the stretches go.
    pub sink: S,
}

impl<S: StretchSink> StretchSink for Inverted<S> {
    type Error = S::Error;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), S::Error> {
        let sync = Sync { hsync: sync.hsync ^ self.hsync, vsync: sync.vsync ^ self.vsync };
        self.sink.stretch(sync, samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten lines of `valid` clocks at `level`, with `blank` clocks between.
    fn lines(wire: Wire, level: bool, valid: u32, blank: u32) -> RunLengths {
        let mut seen = RunLengths::new(wire, 1_000_000);
        for _ in 0..10 {
            for (level, clocks) in [(!level, blank), (level, valid / 2), (level, valid - valid / 2)] {
                let sync = Sync { hsync: level, vsync: level };
                seen.stretch(sync, Samples::Repeat { value: 0, clocks }).unwrap();
            }
        }
        seen
    }

    fn decided(seen: &RunLengths, marker: bool, blank_high: bool, valid_high: bool) -> Polarity {
        let name = SyncName { signal: "tb.HREF".into(), valid_high };
        decide(&name, Expected { blank_high, marker, valid_clocks: 1920 }, seen)
    }

    #[test]
    fn the_level_that_is_a_line_long_is_the_valid_one() {
        let high = decided(&lines(Wire::Hsync, true, 1920, 40), false, true, true);
        assert!(high.invert && high.reason.unwrap().ends_with("1920 clocks: inverted"));
        let low = decided(&lines(Wire::Hsync, false, 1920, 40), false, true, true);
        assert!(!low.invert && low.reason.unwrap().contains("its low runs"));
        let frame = decided(&lines(Wire::Vsync, true, 2500, 90), false, true, true);
        assert!(frame.invert);
    }

    #[test]
    fn a_wire_that_fits_neither_or_both_is_taken_as_it_is() {
        for seen in [lines(Wire::Hsync, true, 1919, 40), lines(Wire::Hsync, true, 1920, 1920)] {
            let found = decided(&seen, false, true, true);
            assert!(!found.invert && found.reason.unwrap().contains("neither level alone"));
        }
        let nothing = decided(&RunLengths::new(Wire::Hsync, 10), false, true, true);
        assert!(nothing.reason.unwrap().contains("an unknown time"));
    }

    #[test]
    fn marker_mode_and_agreement_decide_nothing() {
        let seen = lines(Wire::Hsync, true, 1920, 40);
        for (marker, blank_high, valid_high) in
            [(true, true, true), (false, false, true), (false, true, false)]
        {
            assert_eq!(decided(&seen, marker, blank_high, valid_high), Polarity::default());
        }
    }

    #[test]
    fn a_sink_that_has_enough_says_so_and_an_inverter_inverts() {
        let mut seen = Inverted { hsync: true, vsync: false, sink: RunLengths::new(Wire::Hsync, 30) };
        for (hsync, clocks) in [(false, 10), (true, 10)] {
            let sync = Sync { hsync, vsync: false };
            assert_eq!(seen.stretch(sync, Samples::Repeat { value: 0, clocks }), Ok(()));
        }
        assert_eq!(seen.stretch(Sync::default(), Samples::Repeat { value: 0, clocks: 10 }), Err(Enough));
        assert_eq!((seen.sink.usual(false), seen.sink.usual(true)), (Some(10), None));
    }
}
