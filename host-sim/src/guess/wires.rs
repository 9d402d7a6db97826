//! Which channel is which wire, for a capture whose names say nothing.
//!
//! ```text
//! CH3  _-_-_-_-_-_-_-_-     the clock: the fastest that is regular
//! CH0  ____--------____     HSYNC and VSYNC: the pair that makes the best lines and frames of the trace (`sync`)
//! CH5  __-_--_---_-____     data: what is left, in the order of the channels, up or down
//! ```
//!
//! The order of the data lines is not decided here: [`Wires::maps`] are tried, and the one whose picture takes the fewest bits wins.

use std::cmp::Reverse;

use crate::trace::clock::{Clock, ClockError};
use crate::trace::levels::{Enough, LevelSink};
use crate::trace::names::{MapError, Role};
use crate::trace::{Capture, PlayError, SignalMap, TraceError};

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink as _;

use super::survey::Survey;
use super::sync;

/// Channels that are looked at.
const MOST_CHANNELS: usize = 48;
/// Changes in which a clock must show.
const CLOCK_CHANGES: u32 = 1 << 20;
/// Changes at edges of the clock that are kept: 64 MiB.
const MOST_RUNS: usize = 1 << 22;
/// Channels that may be sync wires: those that move least.
const SYNC_CANDIDATES: usize = 6;
/// Widths of a data bus.
const WIDTHS: [usize; 4] = [8, 10, 12, 14];

/// Why the wires can't be found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoWires {
    /// No channel is regular.
    #[error(
        "none of {0} channels is a clock; check the capture, or name the wires with --map PCLK=…,HSYNC=…,VSYNC=…,D0=…"
    )]
    NoClock(usize),
    /// A channel looks like a clock, and is sampled too slowly.
    #[error(transparent)]
    Clock(#[from] ClockError),
    /// No pair of channels makes lines and frames.
    #[error(
        "`{clock}` is the pixel clock, but no two of the other channels make lines and frames in {clocks} of its periods; capture two \
         frames or more, or name the wires with --map"
    )]
    NoSync {
        /// The clock's channel.
        clock: String,
        /// Periods looked at.
        clocks: u64,
    },
    /// A channel has two wires, which cannot be.
    #[error(transparent)]
    Map(#[from] MapError),
    /// Too few channels, or none that move.
    #[error(
        "{found} channels are left for the data bus, which has 8, 10, 12 or 14; name the wires with --map"
    )]
    NoBus {
        /// Channels that are neither clock nor sync.
        found: usize,
    },
}

/// The wires as far as they can be told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wires {
    /// The pixel clock's channel.
    pub clock: String,
    /// HSYNC's and VSYNC's channels; none with embedded sync.
    pub sync: Option<[String; 2]>,
    /// The data lines' channels in the order of the file.
    pub data: Vec<String>,
    /// Another channel that could be the clock.
    pub other_clock: Option<String>,
}

impl Wires {
    /// The maps to be tried: the data lines in the order of the channels, up and down.
    ///
    /// # Errors
    /// None in truth: no wire is there twice.
    pub fn maps(&self) -> Result<[SignalMap; 2], MapError> {
        let up: Vec<&String> = self.data.iter().collect();
        let down: Vec<&String> = self.data.iter().rev().collect();
        Ok([self.map(&up)?, self.map(&down)?])
    }

    /// What can't be told, in words.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        let doubt = |other: &String| {
            format!(
                "`{other}` looks like a clock as well as `{}`: if it is the pixel clock, say --map",
                self.clock
            )
        };
        self.other_clock.iter().map(doubt).collect()
    }

    fn map(&self, data: &[&String]) -> Result<SignalMap, MapError> {
        let sync = self.sync.iter().flat_map(|[hsync, vsync]| [(Role::Hsync, hsync), (Role::Vsync, vsync)]);
        let data = data.iter().zip(0..).map(|(name, line)| (Role::Data(line), *name));
        let wires = [(Role::Pclk, &self.clock)].into_iter().chain(sync).chain(data);
        SignalMap::of(wires.map(|(role, name)| (role, name.clone())))
    }
}

/// Finds the wires among the channels of a capture.
///
/// # Errors
/// The trace's; [`NoWires`] inside.
pub fn find(capture: &Capture) -> Result<Result<Wires, NoWires>, TraceError> {
    let channels: Vec<usize> = (0..capture.channels().len().min(MOST_CHANNELS)).collect();
    let mut activity = Activity::new(channels.len());
    match capture.play(&channels, &mut activity, &mut |_| ()) {
        Err(PlayError::Trace(error)) => return Err(error),
        Ok(_) | Err(PlayError::Sink(Enough)) => {}
    }
    let clocks = activity.clocks();
    let Some(&clock) = clocks.first() else { return Ok(Err(NoWires::NoClock(channels.len()))) };
    let others: Vec<usize> = channels.iter().copied().filter(|&channel| channel != clock).collect();
    let period = match capture.clock_of(clock, &others)? {
        Ok(period) => period,
        Err(error) => return Ok(Err(error.into())),
    };
    let runs = Runs::of(capture, clock, &period, &others)?;
    let name = |channel: usize| {
        capture.channels().get(channel).map(|channel| channel.name.clone()).unwrap_or_default()
    };
    let named = |bits: &[usize]| -> Vec<String> {
        bits.iter().filter_map(|&bit| others.get(bit)).map(|&channel| name(channel)).collect()
    };
    let is_clock = |bit: usize| others.get(bit).is_some_and(|channel| clocks.contains(channel));
    let sync = match runs.embedded(&is_clock) {
        true => None,
        false => match runs.best_sync() {
            Some(pair) => Some(pair),
            None => return Ok(Err(NoWires::NoSync { clock: name(clock), clocks: runs.clocks })),
        },
    };
    let taken: Vec<usize> = sync.into_iter().flatten().collect();
    let Some(data) = runs.bus(&taken, &is_clock) else {
        return Ok(Err(NoWires::NoBus { found: others.len() - taken.len() }));
    };
    let other_clock = clocks.iter().find(|&&channel| {
        channel != clock
            && others.iter().position(|&other| other == channel).is_some_and(|bit| !data.contains(&bit))
    });
    Ok(Ok(Wires {
        clock: name(clock),
        sync: sync.and_then(|pair| <[String; 2]>::try_from(named(&pair)).ok()),
        data: named(&data),
        other_clock: other_clock.map(|&channel| name(channel)),
    }))
}

/// How often each channel rises, and how regularly.
struct Activity {
    before: Option<u64>,
    rose: Vec<Option<u64>>,
    periods: Vec<Vec<u64>>,
    calls: u32,
}

impl Activity {
    fn new(channels: usize) -> Self {
        Self { before: None, rose: vec![None; channels], periods: vec![Vec::new(); channels], calls: 0 }
    }

    /// The channels that are regular and nearly as fast as the fastest, the fastest first.
    fn clocks(&self) -> Vec<usize> {
        let regular = |periods: &[u64]| {
            let mut sorted = periods.to_vec();
            sorted.sort_unstable();
            let median = *sorted.get(sorted.len() / 2)?.max(&1);
            let near = |period: u64| period * 2 >= median && period * 2 <= median * 3;
            let part = sorted.iter().filter(|&&period| near(period)).count() * 10 >= sorted.len() * 9;
            (sorted.len() >= 64 && part).then_some(median)
        };
        let mut found: Vec<(u64, Reverse<usize>, usize)> = self
            .periods
            .iter()
            .enumerate()
            .filter_map(|(channel, periods)| Some((regular(periods)?, Reverse(periods.len()), channel)))
            .collect();
        found.sort_unstable();
        let fastest = found.first().map_or(0, |(period, ..)| *period);
        found.into_iter().filter(|(period, ..)| period / 4 <= fastest).map(|(.., channel)| channel).collect()
    }
}

impl LevelSink for Activity {
    type Error = Enough;

    fn levels(&mut self, time: u64, state: u64) -> Result<(), Enough> {
        self.calls += 1;
        let Some(before) = self.before.replace(state) else { return Ok(()) };
        let mut rises = state & !before;
        while rises != 0 {
            let channel = rises.trailing_zeros() as usize;
            rises &= rises - 1;
            if let (Some(rose), Some(periods)) = (self.rose.get_mut(channel), self.periods.get_mut(channel))
                && let Some(last) = rose.replace(time)
            {
                periods.push(time - last);
            }
        }
        if self.calls >= CLOCK_CHANGES { Err(Enough) } else { Ok(()) }
    }
}

/// The levels of all channels but the clock at its edges: how long, and which.
struct Runs {
    runs: Vec<(u32, u64)>,
    /// How often each of them changes.
    changes: Vec<u64>,
    clocks: u64,
}

impl Runs {
    fn of(capture: &Capture, clock: usize, period: &Clock, others: &[usize]) -> Result<Self, TraceError> {
        let mut found = Self { runs: Vec::new(), changes: vec![0; others.len()], clocks: 0 };
        capture.play_at_edges((clock, period), others, &mut |state| found.take(state))?;
        Ok(found)
    }

    fn take(&mut self, state: u64) -> Result<(), Enough> {
        self.clocks += 1;
        match self.runs.last_mut() {
            Some((clocks, last)) if *last == state && *clocks < u32::MAX => {
                *clocks += 1;
                return Ok(());
            }
            Some((_, last)) => {
                let mut changed = *last ^ state;
                while changed != 0 {
                    let bit = changed.trailing_zeros() as usize;
                    changed &= changed - 1;
                    if let Some(changes) = self.changes.get_mut(bit) {
                        *changes += 1;
                    }
                }
            }
            None => {}
        }
        self.runs.push((1, state));
        if self.runs.len() >= MOST_RUNS { Err(Enough) } else { Ok(()) }
    }

    /// What the survey of a trace sees if the sync wires are these, and the data is what `value` says.
    fn survey(&self, pair: Option<[usize; 2]>, value: impl Fn(u64) -> u16) -> Survey {
        let mut survey = Survey::default();
        for &(clocks, state) in &self.runs {
            let high = |bit: usize| state >> bit & 1 != 0;
            let sync = pair.map_or(Sync::default(), |[h, v]| Sync { hsync: high(h), vsync: high(v) });
            if survey.stretch(sync, Samples::Repeat { value: value(state), clocks }).is_err() {
                break;
            }
        }
        survey
    }

    /// The channels that make the best lines and frames as HSYNC and VSYNC.
    fn best_sync(&self) -> Option<[usize; 2]> {
        let mut candidates: Vec<usize> = (0..self.changes.len())
            .filter(|&bit| (2..=self.clocks / 4).contains(&self.changes[bit]))
            .collect();
        candidates.sort_by_key(|&bit| self.changes[bit]);
        candidates.truncate(SYNC_CANDIDATES);
        let pairs = candidates.iter().flat_map(|&h| candidates.iter().map(move |&v| [h, v]));
        // A line is shorter than a frame.
        let pairs = pairs.filter(|&[h, v]| h != v && self.changes[h] > self.changes[v]);
        let judged = pairs.filter_map(|pair| {
            let data = !(1 << pair[0] | 1 << pair[1]);
            // Only whether the data changes counts here.
            let fold = |state: u64| {
                let rest = state & data;
                (rest ^ rest >> 15 ^ rest >> 31) as u16
            };
            let survey = self.survey(Some(pair), fold);
            let best = sync::guess(&survey).into_iter().next()?;
            Some((best.score, Reverse(pair), pair))
        });
        judged.max().map(|(.., pair)| pair)
    }

    /// Whether the data holds the codes of embedded sync, and lines and frames by them.
    fn embedded(&self, is_clock: &dyn Fn(usize) -> bool) -> bool {
        let Some(bus) = self.bus(&[], is_clock).filter(|bus| bus.len() == 8) else { return false };
        let gather = |state: u64, up: bool| {
            bus.iter().enumerate().fold(0_u16, |value, (line, &bit)| {
                value | ((state >> bit & 1) as u16) << if up { line } else { 7 - line }
            })
        };
        [true, false].into_iter().any(|up| {
            let survey = self.survey(None, |state| gather(state, up));
            !sync::guess(&survey).is_empty()
        })
    }

    /// The channels that are the data bus, in the order of the file. Those that move, as many as a bus has; where one is missing, one
    /// that rests among or beside them; where one is too many, another clock or the one that moves least is left out.
    fn bus(&self, taken: &[usize], is_clock: &dyn Fn(usize) -> bool) -> Option<Vec<usize>> {
        let free: Vec<usize> = (0..self.changes.len()).filter(|bit| !taken.contains(bit)).collect();
        let (mut moving, mut resting): (Vec<usize>, Vec<usize>) =
            free.into_iter().partition(|&bit| self.changes[bit] > 0);
        if !WIDTHS.contains(&moving.len()) {
            moving.retain(|&bit| !is_clock(bit));
        }
        while !WIDTHS.contains(&moving.len()) {
            let (first, last) = (*moving.first()?, *moving.last()?);
            let distance = |bit: usize| if bit < first { first - bit } else { bit.saturating_sub(last) };
            resting.sort_by_key(|&bit| Reverse(distance(bit)));
            let widest = WIDTHS.iter().any(|&width| width > moving.len());
            match resting.pop().filter(|&bit| widest && distance(bit) <= WIDTHS[3]) {
                Some(bit) => {
                    moving.push(bit);
                    moving.sort_unstable();
                }
                None => {
                    let least = moving.iter().position(|&bit| {
                        self.changes[bit] == moving.iter().map(|&bit| self.changes[bit]).min().unwrap_or(0)
                    })?;
                    moving.remove(least);
                    if moving.len() < WIDTHS[0] {
                        return None;
                    }
                }
            }
        }
        Some(moving)
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;
    use std::path::Path;

    use super::*;
    use crate::guess::{FileGuess, guess_file};
    use crate::profile::Profile;
    use crate::scene::Scene;
    use crate::sensor::Sensor;
    use crate::trace::vcd::VcdWriterOptions;
    use crate::trace::{TraceWriterOptions, create};

    fn write(profile: &Profile, scene: &str, path: &Path) {
        let mut vcd = VcdWriterOptions::new(profile.bus.bits as u8, profile.timing.pclk_hz);
        vcd.edge = profile.bus.clock_edge;
        let options = TraceWriterOptions { vcd, vsync_active: true, profile: String::new() };
        let mut writer = create(path, &options).unwrap();
        let mut sensor = Sensor::new(profile.clone()).unwrap();
        sensor.play(2, &Scene::named(scene, 1).unwrap(), &mut writer).unwrap();
        writer.finish().unwrap();
    }

    /// A VCD whose wires are called CH0, CH1 … in this order of their names, idle ones where there is none of the name.
    fn anonymous(path: &Path, order: &[&str]) {
        let text = std::fs::read_to_string(path).unwrap();
        let (head, changes) = text.split_once("$enddefinitions").unwrap();
        let identifier = |name: &str| {
            let line = head.lines().find(|line| line.split(' ').nth(4) == Some(name));
            line.and_then(|line| line.split(' ').nth(3))
        };
        let mut new = String::from("$timescale 1ps $end\n");
        for (channel, name) in order.iter().enumerate() {
            let idle = format!("idle{channel}");
            writeln!(new, "$var wire 1 {} CH{channel} $end", identifier(name).unwrap_or(&idle)).unwrap();
        }
        let keep: Vec<&str> = order.iter().filter_map(|name| identifier(name)).collect();
        assert!(keep.len() >= 9, "{head}");
        std::fs::write(path, format!("{new}$enddefinitions{changes}")).unwrap();
    }

    fn guessed(profile: &str, scene: &str, order: &[&str]) -> (FileGuess, Profile) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.vcd");
        let profile = Profile::find(profile).unwrap();
        write(&profile, scene, &path);
        anonymous(&path, order);
        (guess_file(&path, &SignalMap::default()).unwrap(), profile)
    }

    #[test]
    fn wires_without_names_are_found_by_what_they_do() {
        let up = ["D0", "D1", "D2", "D3", "D4", "D5", "D6", "D7", "PCLK", "HSYNC", "VSYNC"];
        let down = ["-", "VSYNC", "PCLK", "D7", "D6", "D5", "D4", "D3", "D2", "D1", "D0", "HSYNC", "-", "-"];
        for (profile, scene, order) in [
            ("ov7670-qvga-yuv422", "demo", &up[..]),
            ("ov7670-qvga-yuv422", "bars", &down[..]),
            ("ov7670-vga-rgb565", "demo", &down[..]),
        ] {
            let (guess, profile) = guessed(profile, scene, order);
            let place =
                |name: &str| format!("{name}=CH{}", order.iter().position(|wire| *wire == name).unwrap());
            let text = guess.map.to_string();
            for name in &up {
                assert!(
                    text.split(',').any(|entry| entry == place(name)),
                    "{} {scene}: {name}: {text}",
                    profile.name
                );
            }
            assert_eq!(guess.bus.profile.frame, profile.frame, "{scene}");
            assert_eq!(guess.bus.profile.bus, profile.bus, "{scene}");
        }
    }
}
