//! Faults of the pixel clock.

use firmware::camif::pins::{Pins, Sync};

use super::inject::Fault;
use super::kind::FaultKind;
use super::place::{Part, Place};
use super::random::Random;
use super::spec::FaultSpec;
use crate::profile::Profile;

pub(super) fn make(spec: &FaultSpec, profile: &Profile, random: Random) -> Box<dyn Fault> {
    match spec.kind {
        FaultKind::ClockGlitch => Box::new(Edges { hits: Hits::new(spec, profile, random), twice: true }),
        FaultKind::MissingClock => Box::new(Edges { hits: Hits::new(spec, profile, random), twice: false }),
        FaultKind::ClockJitter => {
            Box::new(Blur { hit: spec.value("permille") as u64, bit: 500, random, before: None })
        }
        FaultKind::WrongEdge => {
            Box::new(Blur { hit: 1000, bit: 10 * spec.value("percent") as u64, random, before: None })
        }
        FaultKind::Undersampling => Box::new(Undersampling { percent: spec.value("percent"), sum: 0 }),
        _ => Box::new(Untouched),
    }
}

/// Samples of a frame that are hit, drawn when the frame begins.
pub(super) struct Hits {
    count: usize,
    lines: u32,
    /// Columns from the first to before the second.
    columns: (u32, u32),
    random: Random,
    frame: Option<u64>,
    places: Vec<(u32, u32)>,
}

impl Hits {
    pub(super) fn new(spec: &FaultSpec, profile: &Profile, random: Random) -> Self {
        // A marker stands in column 0, and is not to be hit by chance.
        let columns = (1, profile.samples_per_line());
        Self {
            count: spec.value("count") as usize,
            lines: profile.frame.height,
            columns,
            random,
            frame: None,
            places: Vec::new(),
        }
    }

    /// Hits no closer than so many samples to either end of a line, where the line is long enough.
    pub(super) fn within(mut self, first: u32, last: u32) -> Self {
        let (start, end) = self.columns;
        self.columns = (first.min(end.saturating_sub(1)).max(start), end.saturating_sub(last).max(first + 1));
        self
    }

    /// Hits lines before the last ones only.
    pub(super) fn but_last(mut self, lines: u32) -> Self {
        self.lines = self.lines.saturating_sub(lines);
        self
    }

    /// The columns of this line that are hit.
    pub(super) fn of_line(&mut self, place: &Place) -> impl Iterator<Item = u32> + '_ {
        if self.frame != Some(place.frame) {
            self.frame = Some(place.frame);
            let (first, end) = self.columns;
            let random = &mut self.random;
            self.places.clear();
            for _ in 0..self.count {
                let line = random.below(self.lines.into()) as u32;
                self.places.push((line, first + random.below(u64::from(end.saturating_sub(first))) as u32));
            }
        }
        let line = place.line;
        self.places.iter().filter(move |(hit, _)| *hit == line).map(|(_, column)| *column)
    }

    pub(super) fn hits_line(&mut self, place: &Place) -> bool {
        self.of_line(place).next().is_some()
    }
}

struct Untouched;

impl Fault for Untouched {
    fn clock(&mut self, _: &Place, pins: Pins, out: &mut Vec<Pins>) {
        out.push(pins);
    }
}

struct Edges {
    hits: Hits,
    twice: bool,
}

impl Fault for Edges {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        let hit = place.part == Part::Data && self.hits.of_line(place).any(|column| column == place.column);
        if !hit {
            out.push(pins);
        } else if self.twice {
            out.extend([pins, pins]);
        }
    }
}

/// Samples taken while the wires change: each wire shows the clock before or this one.
struct Blur {
    /// Samples in a thousand that are hit.
    hit: u64,
    /// Wires in a thousand that then show the clock before.
    bit: u64,
    random: Random,
    before: Option<Pins>,
}

impl Fault for Blur {
    fn clock(&mut self, _: &Place, pins: Pins, out: &mut Vec<Pins>) {
        let before = self.before.replace(pins).unwrap_or(pins);
        if before == pins || !self.random.permille(self.hit) {
            return out.push(pins);
        }
        let mut old = 0u16;
        for bit in 0..16 {
            old |= u16::from(self.random.permille(self.bit)) << bit;
        }
        let level = |old: bool, before: bool, now: bool| if old { before } else { now };
        let sync = Sync {
            hsync: level(old >> 14 & 1 == 1, before.sync.hsync, pins.sync.hsync),
            vsync: level(old >> 15 == 1, before.sync.vsync, pins.sync.vsync),
        };
        out.push(Pins { sync, data: before.data & old | pins.data & !old });
    }
}

struct Undersampling {
    percent: i64,
    sum: i64,
}

impl Fault for Undersampling {
    fn clock(&mut self, _: &Place, pins: Pins, out: &mut Vec<Pins>) {
        self.sum += self.percent;
        if self.sum >= 100 {
            self.sum -= 100;
            out.push(pins);
        }
    }
}
