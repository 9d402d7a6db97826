//! Samples that slip or change places.

use std::collections::VecDeque;

use firmware::camif::pins::{Pins, Sync};

use super::inject::Fault;
use super::kind::FaultKind;
use super::place::{Part, Place};
use super::spec::FaultSpec;
use crate::profile::{Profile, SyncMode};

pub(super) fn make(spec: &FaultSpec, profile: &Profile) -> Box<dyn Fault> {
    if spec.kind == FaultKind::ByteSwap {
        return Box::new(Swap { held: None });
    }
    let samples = spec.value("samples") as u32;
    if profile.bus.sync == SyncMode::Embedded {
        let line = profile.samples_per_line();
        return Box::new(SlipCodes { samples: samples.min(line - 1), line });
    }
    Box::new(SlipWires { samples: samples as usize, held: VecDeque::new() })
}

/// The sync wires come late against the data.
struct SlipWires {
    samples: usize,
    held: VecDeque<Sync>,
}

impl Fault for SlipWires {
    fn clock(&mut self, _: &Place, pins: Pins, out: &mut Vec<Pins>) {
        if self.held.is_empty() {
            self.held.extend(std::iter::repeat_n(pins.sync, self.samples));
        }
        self.held.push_back(pins.sync);
        let sync = self.held.pop_front().unwrap_or(pins.sync);
        out.push(Pins { sync, data: pins.data });
    }

    fn finish(&mut self, out: &mut Vec<Pins>) {
        out.extend(self.held.drain(..).map(|sync| Pins { sync, data: 0 }));
    }
}

/// The codes come late against the data: a line lacks its first samples and ends with filler.
struct SlipCodes {
    samples: u32,
    line: u32,
}

impl Fault for SlipCodes {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        if place.part == Part::Data && place.column < self.samples {
            return;
        }
        if place.part == Part::Code && place.column == self.line && pins.data == 0xFF {
            let filler = |number| if number % 2 == 0 { 0x80 } else { 0x10 };
            out.extend((0..self.samples).map(|number| Pins { data: filler(number), ..pins }));
        }
        out.push(pins);
    }
}

/// The first of two samples waits for the second.
struct Swap {
    held: Option<Pins>,
}

impl Fault for Swap {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        let is_data = place.part == Part::Data;
        match self.held.take() {
            Some(first) if is_data && place.column % 2 == 1 => {
                out.push(Pins { data: pins.data, ..first });
                return out.push(Pins { data: first.data, ..pins });
            }
            Some(first) => out.push(first),
            None => {}
        }
        if is_data && place.column.is_multiple_of(2) {
            self.held = Some(pins);
        } else {
            out.push(pins);
        }
    }

    fn finish(&mut self, out: &mut Vec<Pins>) {
        out.extend(self.held.take());
    }
}
