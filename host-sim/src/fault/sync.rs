//! HSYNC and VSYNC missing, spurious or upside down, where they are wires.

use firmware::camif::pins::{Pins, Sync};

use super::clock::Hits;
use super::inject::Fault;
use super::kind::FaultKind;
use super::place::{Part, Place};
use super::random::Random;
use super::spec::FaultSpec;
use crate::profile::{Profile, SyncMode};

/// Samples at either end of a line that a pulse in its middle leaves alone, where the line is long enough.
pub(super) const MARGIN: u32 = 8;

pub(super) fn make(spec: &FaultSpec, profile: &Profile, random: Random) -> Box<dyn Fault> {
    let gated = profile.bus.sync == SyncMode::Gated;
    let (hsync, vsync) = (profile.bus.hsync_blank.is_high(), profile.bus.vsync_blank.is_high());
    let pulse = |random, hsync, vsync| {
        let clocks = spec.value("clocks") as u32;
        let hits = Hits::new(spec, profile, random).within(MARGIN, MARGIN + clocks);
        Box::new(Pulse { hits, clocks, hsync, vsync })
    };
    match spec.kind {
        FaultKind::MissingHsync => {
            let hits = Hits::new(spec, profile, random).but_last(1);
            Box::new(MissingHsync { gated, level: hsync, hits, merge: false })
        }
        FaultKind::SpuriousHsync => pulse(random, Some(hsync), None),
        FaultKind::SpuriousVsync => pulse(random, None, Some(vsync)),
        FaultKind::MissingVsync => {
            let every = spec.value("every") as u64;
            Box::new(MissingVsync { gated, level: vsync, every, frame: 0, seen: 0 })
        }
        FaultKind::VsyncInFrame => {
            let timing = &profile.timing;
            let clocks = if gated { timing.vblank - timing.vfront - timing.vback } else { 1 };
            let line = (i64::from(profile.frame.height) * spec.value("percent") / 100).max(1) as u32;
            Box::new(InFrame { level: vsync, line, clocks, left: 0, done: None })
        }
        kind => Box::new(Inverted(kind == FaultKind::InvertedHsync)),
    }
}

struct MissingHsync {
    gated: bool,
    /// HSYNC's level in blanking, or as a marker.
    level: bool,
    hits: Hits,
    merge: bool,
}

impl Fault for MissingHsync {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        let quiet = Pins { sync: Sync { hsync: !self.level, ..pins.sync }, ..pins };
        let inside = place.part == Part::Data;
        let lost =
            if self.gated { place.part == Part::LineBlank } else { place.column == 0 && place.line > 0 };
        out.push(if lost && self.merge { quiet } else { pins });
        if inside {
            self.merge = self.hits.hits_line(place);
        }
    }
}

/// A pulse within a line.
struct Pulse {
    hits: Hits,
    clocks: u32,
    hsync: Option<bool>,
    vsync: Option<bool>,
}

impl Fault for Pulse {
    fn clock(&mut self, place: &Place, mut pins: Pins, out: &mut Vec<Pins>) {
        let clocks = self.clocks;
        let inside = |column: u32| (column..column + clocks).contains(&place.column);
        if place.part == Part::Data && self.hits.of_line(place).any(inside) {
            pins.sync.hsync = self.hsync.unwrap_or(pins.sync.hsync);
            pins.sync.vsync = self.vsync.unwrap_or(pins.sync.vsync);
        }
        out.push(pins);
    }
}

struct MissingVsync {
    gated: bool,
    level: bool,
    every: u64,
    frame: u64,
    /// Ends of frames seen; the one with which a stream begins is none.
    seen: u64,
}

impl MissingVsync {
    fn is_lost(&self) -> bool {
        self.seen > 0 && self.seen % self.every == 1 % self.every
    }
}

impl Fault for MissingVsync {
    fn clock(&mut self, place: &Place, mut pins: Pins, out: &mut Vec<Pins>) {
        if place.frame != self.frame {
            self.frame = place.frame;
            // A gated stream begins with VSYNC in blanking, which ends nothing.
            self.seen = if self.gated { place.frame - 1 } else { place.frame };
        }
        let here =
            if self.gated { place.part == Part::FrameBlank } else { place.line == 0 && place.column == 0 };
        if here && self.is_lost() {
            pins.sync.vsync = !self.level;
        }
        out.push(pins);
    }
}

/// VSYNC for its usual time from the end of a line on.
struct InFrame {
    level: bool,
    line: u32,
    clocks: u32,
    left: u32,
    done: Option<u64>,
}

impl Fault for InFrame {
    fn clock(&mut self, place: &Place, mut pins: Pins, out: &mut Vec<Pins>) {
        if place.line == self.line && self.done != Some(place.frame) {
            (self.done, self.left) = (Some(place.frame), self.clocks);
        }
        if self.left > 0 {
            self.left -= 1;
            pins.sync.vsync = self.level;
        }
        out.push(pins);
    }
}

struct Inverted(bool);

impl Fault for Inverted {
    fn clock(&mut self, _: &Place, mut pins: Pins, out: &mut Vec<Pins>) {
        if self.0 {
            pins.sync.hsync ^= true;
        } else {
            pins.sync.vsync ^= true;
        }
        out.push(pins);
    }
}
