//! Lines too short, too long, late, and their blanking.
//!
//! Where sync has a level, HSYNC moves and the clocks stay; where it has not, samples go or come.

use firmware::camif::pins::{Pins, Sync};

use super::clock::Hits;
use super::inject::Fault;
use super::kind::FaultKind;
use super::place::{Part, Place};
use super::random::Random;
use super::spec::FaultSpec;
use crate::profile::{Profile, SyncMode};

pub(super) fn make(spec: &FaultSpec, profile: &Profile, random: Random) -> Box<dyn Fault> {
    let wires = Wires {
        gated: profile.bus.sync == SyncMode::Gated,
        blank: profile.bus.hsync_blank.is_high(),
        line: profile.samples_per_line(),
    };
    let samples = || spec.value("samples") as u32;
    match spec.kind {
        FaultKind::ShortLine => {
            // At least a sample is left.
            let kept = wires.line.saturating_sub(samples()).max(1);
            Box::new(Short { wires, hits: Hits::new(spec, profile, random), kept })
        }
        FaultKind::LongLine => {
            let room = if wires.gated { profile.timing.hblank.saturating_sub(1).max(1) } else { u32::MAX };
            let samples = samples().min(room);
            Box::new(Long { wires, hits: Hits::new(spec, profile, random), samples, grow: false, last: None })
        }
        FaultKind::LineStartLoss => {
            let lost = samples().min(wires.line.saturating_sub(1));
            Box::new(Late { wires, lost })
        }
        _ => {
            let percent = spec.value("percent") as u32;
            let kept = (u64::from(profile.timing.hblank) * u64::from(percent) / 100).max(1) as u32;
            Box::new(Blanking { kept, lines: profile.frame.height })
        }
    }
}

struct Wires {
    gated: bool,
    blank: bool,
    /// Samples a line.
    line: u32,
}

impl Wires {
    /// The same clock in blanking; the bus is idle.
    fn blank(&self, pins: Pins) -> Pins {
        Pins { sync: Sync { hsync: self.blank, ..pins.sync }, data: 0 }
    }
}

struct Short {
    wires: Wires,
    hits: Hits,
    kept: u32,
}

impl Fault for Short {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        let cut = place.part == Part::Data && place.column >= self.kept && self.hits.hits_line(place);
        if !cut {
            out.push(pins);
        } else if self.wires.gated {
            out.push(self.wires.blank(pins));
        }
    }
}

struct Long {
    wires: Wires,
    hits: Hits,
    samples: u32,
    /// The line that just ended is one that grows.
    grow: bool,
    last: Option<Pins>,
}

impl Fault for Long {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        let data = place.part == Part::Data;
        if self.wires.gated {
            if data {
                self.grow = self.hits.hits_line(place);
            }
            let stretched = self.grow && place.part == Part::LineBlank && place.column < self.samples;
            return out.push(if stretched {
                Pins { sync: Sync { hsync: !self.wires.blank, ..pins.sync }, data: pins.data }
            } else {
                pins
            });
        }
        // The first clock that is not the line's.
        let over = if data { place.column == 0 } else { place.column == self.wires.line };
        if over && std::mem::take(&mut self.grow) {
            let sync = self.last.map_or(pins.sync, |last| last.sync);
            let data = self.last.map_or(0, |last| last.data);
            out.extend(std::iter::repeat_n(Pins { sync, data }, self.samples as usize));
        }
        if data {
            self.grow = self.hits.hits_line(place);
            self.last = Some(pins);
        }
        out.push(pins);
    }
}

struct Late {
    wires: Wires,
    lost: u32,
}

impl Fault for Late {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        if place.part != Part::Data {
            out.push(pins);
        } else if self.wires.gated {
            out.push(if place.column < self.lost { self.wires.blank(pins) } else { pins });
        } else if !(1..=self.lost).contains(&place.column) {
            // A marker stands at column 0 and stays.
            out.push(pins);
        }
    }
}

struct Blanking {
    kept: u32,
    lines: u32,
}

impl Fault for Blanking {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        let between = place.part == Part::LineBlank && (1..self.lines).contains(&place.line);
        if !between || place.column < self.kept {
            out.push(pins);
        }
    }
}
