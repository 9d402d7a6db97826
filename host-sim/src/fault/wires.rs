//! Data wires stuck, swapped, shorted, shifted, reversed.

use firmware::camif::pins::Pins;

use super::inject::Fault;
use super::kind::FaultKind;
use super::place::Place;
use super::spec::FaultSpec;
use crate::profile::Profile;

/// What becomes of a sample.
struct Wires<F>(F);

impl<F: FnMut(u16) -> u16 + Send> Fault for Wires<F> {
    fn clock(&mut self, _: &Place, pins: Pins, out: &mut Vec<Pins>) {
        out.push(Pins { data: (self.0)(pins.data), ..pins });
    }
}

pub(super) fn make(spec: &FaultSpec, profile: &Profile) -> Box<dyn Fault> {
    let bits = profile.bus.bits;
    let mask = (1u16 << bits.min(15)) - 1;
    let pair = || (spec.value("a") as u32, spec.value("b") as u32);
    match spec.kind {
        FaultKind::StuckBit => {
            let wire = 1u16 << spec.value("bit");
            let high = spec.word("level") == "high";
            Box::new(Wires(move |data| if high { data | wire } else { data & !wire }))
        }
        FaultKind::SwappedBits => {
            let (a, b) = pair();
            Box::new(Wires(move |data| swap_bits(data, a, b)))
        }
        FaultKind::ShortedBits => {
            let (a, b) = pair();
            let (both, low) = (1u16 << a | 1 << b, spec.word("wins") == "low");
            Box::new(Wires(move |data| match data & both {
                0 => data,
                set if set == both => data,
                _ if low => data & !both,
                _ => data | both,
            }))
        }
        FaultKind::ShiftedBits => {
            let places = spec.value("places") as u32;
            let up = spec.word("to") == "high";
            Box::new(Wires(move |data| if up { data << places & mask } else { data >> places }))
        }
        _ => Box::new(Wires(move |data| reverse_bits(data, bits))),
    }
}

/// Two bits change places.
pub(crate) fn swap_bits(data: u16, a: u32, b: u32) -> u16 {
    let differ = (data >> a ^ data >> b) & 1;
    data ^ (differ << a | differ << b)
}

/// The lowest bit becomes the highest.
pub(crate) fn reverse_bits(data: u16, bits: u32) -> u16 {
    data.reverse_bits() >> 16u32.saturating_sub(bits).min(15)
}
