//! The block as software sees it: register accesses, the DMA seam, and a shared handle.
//!
//! An access takes the bus for one clock, so that software which polls sees the FIFO drain, as on silicon.

use core::cell::RefCell;

use super::block::Camif;
use super::part::Part;
use super::registers::{
    Control, CropSize, CropStart, DmaAddress, DmaControl, DmaStatus, Events, Extension, Register, Registers,
    Status, SyncCodes,
};
use crate::port::{Dma, DmaError, DmaEvents, Port, SLOTS, Target, Transfer};

/// Bits of CR that exist on every part, and those of parts that can select bytes and lines.
const CONTROL_MASK: u32 = 0x4FFF;
const SELECTION_MASK: u32 = 0x1F_0000;

/// Width of a bus access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccessWidth {
    /// 8 bits.
    Byte,
    /// 16 bits.
    HalfWord,
    /// 32 bits.
    Word,
}

/// An access that the block answers with a bus error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusError {
    /// The registers are 32 bits wide and are accessed whole.
    Width {
        /// The width tried.
        width: AccessWidth,
        /// The byte offset tried.
        offset: u32,
    },
    /// No register is there, or the offset is not a multiple of 4.
    NoRegister {
        /// The byte offset tried.
        offset: u32,
    },
}

impl core::fmt::Display for BusError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Width { width, offset } => {
                write!(f, "{width:?} access at offset {offset:#x}: only 32-bit accesses are allowed")
            }
            Self::NoRegister { offset } => write!(f, "no register at offset {offset:#x}"),
        }
    }
}

impl core::error::Error for BusError {}

fn decode(offset: u32, width: AccessWidth) -> Result<Register, BusError> {
    if width != AccessWidth::Word {
        return Err(BusError::Width { width, offset });
    }
    Register::at(offset).ok_or(BusError::NoRegister { offset })
}

impl<'m> Camif<'m> {
    /// A read by address, as a bus makes it.
    ///
    /// # Errors
    /// If the access is not 32 bits wide or meets no register.
    pub fn bus_read(&mut self, offset: u32, width: AccessWidth) -> Result<u32, BusError> {
        decode(offset, width).map(|register| self.read(register))
    }

    /// A write by address, as a bus makes it.
    ///
    /// # Errors
    /// If the access is not 32 bits wide or meets no register.
    pub fn bus_write(&mut self, offset: u32, width: AccessWidth, value: u32) -> Result<(), BusError> {
        decode(offset, width).map(|register| self.write(register, value))
    }

    /// What a register would read, without the effects of reading it: no time passes, and DR keeps its word (it shows
    /// as 0).
    #[must_use]
    pub fn peek(&self, register: Register) -> u32 {
        match register {
            Register::Control => self.control.raw_value(),
            Register::Status => Status::default()
                .with_hsync(self.between_lines())
                .with_vsync(self.between_frames())
                .with_fifo_not_empty(!self.fifo.is_empty())
                .raw_value(),
            Register::RawInterrupt => self.raised.raw_value(),
            Register::InterruptEnable => self.enabled_events.raw_value(),
            Register::MaskedInterrupt => self.raised.raw_value() & self.enabled_events.raw_value(),
            Register::SyncCode => self.codes.raw_value(),
            Register::SyncUnmask => self.unmask.raw_value(),
            Register::CropStart => self.crop_start.raw_value(),
            Register::CropSize => self.crop_size.raw_value(),
            Register::Extension => self.extension.raw_value(),
            Register::LineBytes if self.part.counters => self.line_bytes,
            Register::FrameBytes if self.part.counters => self.frame_bytes,
            Register::FrameLines if self.part.counters => self.frame_lines,
            Register::InterruptClear
            | Register::Data
            | Register::DmaClear
            | Register::LineBytes
            | Register::FrameBytes
            | Register::FrameLines => 0,
            Register::DmaControl => self.dma.control.raw_value(),
            Register::DmaStatus => self.dma.status.raw_value(),
            Register::DmaCount => {
                if self.dma.enabled() {
                    self.dma.remaining
                } else {
                    self.dma.count
                }
            }
            Register::DmaTarget0 => self.dma.targets[0].raw_value(),
            Register::DmaTarget1 => self.dma.targets[1].raw_value(),
        }
    }

    /// The memory lent in a slot, to look at.
    #[must_use]
    pub fn lent(&self, slot: usize) -> Option<&[u32]> {
        self.dma.memory.get(slot)?.as_deref()
    }

    fn write_control(&mut self, value: u32) {
        let mask = CONTROL_MASK | if self.part.selection { SELECTION_MASK } else { 0 };
        let capture_was = self.control.capture();
        let enable_was = self.control.enable();
        let control = Control::new_with_raw_value(value & mask);
        self.control = control.with_capture(capture_was);
        self.data_mask = (1 << control.bus_width().bits()) - 1;
        self.sample_bits = control.bus_width().bytes_per_sample() * 8;
        if enable_was && !control.enable() {
            self.reset_capture();
        }
        self.set_capture(control.capture());
    }

    fn write_address(&mut self, index: usize, value: u32) {
        // While the DMA runs, the target in use is locked (as M0AR and M1AR are).
        if !(self.dma.enabled() && self.dma.current() == index) {
            self.dma.targets[index] = DmaAddress::new_with_raw_value(value & 0x7FFF_FFFF);
        }
    }
}

impl Registers for Camif<'_> {
    fn read(&mut self, register: Register) -> u32 {
        self.elapse(1);
        if register == Register::Data {
            return self.fifo.pop().map_or(0, |(word, _)| word);
        }
        self.peek(register)
    }

    fn write(&mut self, register: Register, value: u32) {
        self.elapse(1);
        match register {
            Register::Control => self.write_control(value),
            Register::InterruptEnable => {
                self.enabled_events = Events::new_with_raw_value(value & Events::MASK);
            }
            Register::InterruptClear => {
                self.raised = Events::new_with_raw_value(self.raised.raw_value() & !value);
            }
            Register::SyncCode => self.codes = SyncCodes::new_with_raw_value(value),
            Register::SyncUnmask => self.unmask = SyncCodes::new_with_raw_value(value),
            Register::CropStart => self.crop_start = CropStart::new_with_raw_value(value & 0x1FFF_3FFF),
            Register::CropSize => self.crop_size = CropSize::new_with_raw_value(value & 0x3FFF_3FFF),
            Register::Extension if self.part.marker => {
                self.extension = Extension::new_with_raw_value(value & 1);
            }
            Register::DmaControl => {
                let control = DmaControl::new_with_raw_value(value & 0x331F);
                let control = control.with_line_by_line(control.line_by_line() && self.part.line_by_line);
                if !control.enable() {
                    self.withdraw_request();
                }
                self.dma.set_control(control);
            }
            Register::DmaClear => {
                let kept = self.dma.status.raw_value() & !(value & DmaStatus::MASK);
                self.dma.status = DmaStatus::new_with_raw_value(kept);
            }
            Register::DmaCount => {
                if !self.dma.enabled() {
                    // The counter has as many bits as the limit: a longer count is cut off, as on silicon.
                    self.dma.count = value & self.part.transfer_limit;
                }
            }
            Register::DmaTarget0 => self.write_address(0, value),
            Register::DmaTarget1 => self.write_address(1, value),
            Register::Status
            | Register::RawInterrupt
            | Register::MaskedInterrupt
            | Register::Data
            | Register::Extension
            | Register::LineBytes
            | Register::FrameBytes
            | Register::FrameLines
            | Register::DmaStatus => {}
        }
    }
}

/// The register that points a target.
const fn target_register(target: Target) -> Register {
    match target {
        Target::Zero => Register::DmaTarget0,
        Target::One => Register::DmaTarget1,
    }
}

impl<'m> Dma<'m> for Camif<'m> {
    fn lend(&mut self, slot: usize, memory: &'m mut [u32]) -> Result<(), &'m mut [u32]> {
        match self.dma.memory.get_mut(slot) {
            Some(place @ None) => {
                *place = Some(memory);
                Ok(())
            }
            _ => Err(memory),
        }
    }

    fn take_back(&mut self, slot: usize) -> Option<&'m mut [u32]> {
        if self.dma.aims_at(slot) { None } else { self.dma.memory.get_mut(slot)?.take() }
    }

    fn aim(&mut self, target: Target, slot: usize, start: usize) -> Result<(), DmaError> {
        let lent = self.lent(slot).ok_or(DmaError::NotLent { slot })?.len();
        if start >= lent {
            return Err(DmaError::OutOfBounds { slot, needed: start.saturating_add(1), lent });
        }
        let register = target_register(target);
        self.write(register, (slot as u32) << 28 | start as u32);
        Ok(())
    }

    fn start(&mut self, transfer: Transfer) -> Result<(), DmaError> {
        let limit = self.part.transfer_limit;
        if transfer.words == 0 || transfer.words > limit {
            return Err(DmaError::TransferLength { words: transfer.words, limit });
        }
        if transfer.line_by_line && !self.part.line_by_line {
            return Err(DmaError::Unsupported { what: "transfer line by line" });
        }
        let double = transfer.mode == super::registers::DmaMode::Double;
        for target in &self.dma.targets[..if double { 2 } else { 1 }] {
            let slot = usize::from(target.slot().value());
            let lent = self.lent(slot).ok_or(DmaError::NotLent { slot })?.len();
            let needed = target.word().value() as usize + transfer.words as usize;
            if needed > lent {
                return Err(DmaError::OutOfBounds { slot, needed, lent });
            }
        }
        let control = DmaControl::default()
            .with_enable(true)
            .with_half_interrupt(transfer.half_interrupt)
            .with_complete_interrupt(true)
            .with_error_interrupt(true)
            .with_line_by_line(transfer.line_by_line)
            .with_mode(transfer.mode)
            .with_burst(transfer.burst);
        self.write(Register::DmaControl, 0);
        self.write(Register::DmaClear, DmaStatus::MASK);
        self.write(Register::DmaCount, transfer.words);
        self.write(Register::DmaControl, control.raw_value());
        Ok(())
    }

    fn stop(&mut self) {
        self.write(Register::DmaControl, 0);
    }

    fn events(&mut self) -> DmaEvents {
        let status = DmaStatus::new_with_raw_value(self.read(Register::DmaStatus));
        DmaEvents {
            half: status.half(),
            complete: status.complete(),
            error: status.error(),
            line_words: u32::from(status.line_words()),
        }
    }

    fn acknowledge(&mut self, events: DmaEvents) {
        let flags = DmaStatus::default()
            .with_half(events.half)
            .with_complete(events.complete)
            .with_error(events.error);
        self.write(Register::DmaClear, flags.raw_value());
    }

    fn target(&mut self) -> Target {
        let status = DmaStatus::new_with_raw_value(self.read(Register::DmaStatus));
        if status.target() { Target::One } else { Target::Zero }
    }

    fn remaining(&mut self) -> u32 {
        self.read(Register::DmaCount)
    }
}

impl<'m> Port<'m> for Camif<'m> {
    fn part(&self) -> Part {
        self.part
    }
}

// The driver owns its port, while whoever clocks the model needs the model too: both hold a shared reference.

impl Registers for &RefCell<Camif<'_>> {
    fn read(&mut self, register: Register) -> u32 {
        self.borrow_mut().read(register)
    }

    fn write(&mut self, register: Register, value: u32) {
        self.borrow_mut().write(register, value);
    }
}

impl<'m> Dma<'m> for &RefCell<Camif<'m>> {
    fn lend(&mut self, slot: usize, memory: &'m mut [u32]) -> Result<(), &'m mut [u32]> {
        self.borrow_mut().lend(slot, memory)
    }

    fn take_back(&mut self, slot: usize) -> Option<&'m mut [u32]> {
        self.borrow_mut().take_back(slot)
    }

    fn aim(&mut self, target: Target, slot: usize, start: usize) -> Result<(), DmaError> {
        self.borrow_mut().aim(target, slot, start)
    }

    fn start(&mut self, transfer: Transfer) -> Result<(), DmaError> {
        self.borrow_mut().start(transfer)
    }

    fn stop(&mut self) {
        self.borrow_mut().stop();
    }

    fn events(&mut self) -> DmaEvents {
        self.borrow_mut().events()
    }

    fn acknowledge(&mut self, events: DmaEvents) {
        self.borrow_mut().acknowledge(events);
    }

    fn target(&mut self) -> Target {
        self.borrow_mut().target()
    }

    fn remaining(&mut self) -> u32 {
        self.borrow_mut().remaining()
    }
}

impl<'m> Port<'m> for &RefCell<Camif<'m>> {
    fn part(&self) -> Part {
        self.borrow().part
    }
}

const _: () = assert!(SLOTS <= 8, "the slot field of an address has three bits");
