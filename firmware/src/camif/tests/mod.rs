//! The rules of the specification, a test a rule, on waves drawn as text.
//!
//! Gated: `=` both wires blank, `-` HSYNC blank, `~` VSYNC blank, any other character is a valid clock that carries its
//! ASCII code. Marker: a capital carries an HSYNC marker, a digit both markers, any other character none.

mod capture;
mod dma;
mod interrupts;
mod select;
mod software;
mod sync;
mod two_speeds;

use super::pins::{Pins, Sync};
use super::registers::{Burst, Control, DmaMode, Events, Extension, Register, Registers, Status};
use super::{Bus, Camif, Part};
use crate::port::{Dma, Target, Transfer};

/// A block that is enabled, with DMA into one buffer.
pub(super) struct Bench<'m> {
    pub(super) camif: Camif<'m>,
}

/// Continuous capture from gated wires that are high in blanking.
pub(super) fn gated() -> Control {
    Control::default()
        .with_capture(true)
        .with_enable(true)
        .with_hsync_blank_high(true)
        .with_vsync_blank_high(true)
}

pub(super) const fn single(words: u32) -> Transfer {
    Transfer { words, mode: DmaMode::Single, burst: Burst::One, line_by_line: false, half_interrupt: false }
}

impl<'m> Bench<'m> {
    /// A block with this control word, and DMA of `transfer` into `memory` at both targets.
    pub(super) fn new(control: Control, transfer: Transfer, memory: &'m mut [u32]) -> Self {
        let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
        let second = memory.len() - transfer.words as usize;
        camif.lend(0, memory).unwrap();
        camif.aim(Target::Zero, 0, 0).unwrap();
        camif.aim(Target::One, 0, second).unwrap();
        camif.start(transfer).unwrap();
        camif.write(Register::Control, control.raw_value());
        Self { camif }
    }

    /// In marker mode, with markers that are high.
    pub(super) fn marker(transfer: Transfer, memory: &'m mut [u32]) -> Self {
        let mut bench = Self::new(Control::default(), transfer, memory);
        bench.camif.write(Register::Extension, Extension::default().with_marker(true).raw_value());
        bench.camif.write(Register::Control, gated().raw_value());
        bench
    }

    /// Plays a wave, one character a clock.
    pub(super) fn play(&mut self, wave: &str) -> &mut Self {
        let marker = self.camif.extension.marker();
        for byte in wave.bytes() {
            let (hsync, vsync) = if marker {
                (byte.is_ascii_uppercase() || byte.is_ascii_digit(), byte.is_ascii_digit())
            } else {
                (matches!(byte, b'=' | b'-'), matches!(byte, b'=' | b'~'))
            };
            self.camif.step(Pins { sync: Sync { hsync, vsync }, data: u16::from(byte) });
        }
        self
    }

    /// Plays bytes with the wires at rest, as embedded synchronisation has it.
    pub(super) fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        for &byte in bytes {
            self.camif.step(Pins { sync: Sync::default(), data: u16::from(byte) });
        }
        self
    }

    /// The lent memory as text, up to the first zero byte.
    pub(super) fn memory(&mut self) -> String {
        self.camif.elapse(100);
        let bytes = self.camif.lent(0).unwrap().iter().flat_map(|word| word.to_le_bytes());
        bytes.take_while(|&byte| byte != 0).map(char::from).collect()
    }

    /// RIS as the manual's names, then cleared.
    pub(super) fn events(&mut self) -> String {
        let events = Events::new_with_raw_value(self.camif.read(Register::RawInterrupt));
        self.camif.write(Register::InterruptClear, Events::MASK);
        [
            (events.frame(), "FRAME"),
            (events.overrun(), "OVR"),
            (events.error(), "ERR"),
            (events.vsync(), "VSYNC"),
            (events.line(), "LINE"),
        ]
        .iter()
        .filter_map(|&(set, name)| set.then_some(name))
        .collect::<Vec<_>>()
        .join(" ")
    }

    pub(super) fn status(&mut self) -> Status {
        Status::new_with_raw_value(self.camif.read(Register::Status))
    }

    pub(super) fn control(&mut self) -> Control {
        Control::new_with_raw_value(self.camif.read(Register::Control))
    }
}
