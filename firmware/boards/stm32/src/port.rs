//! DCMI and a DMA stream as the driver's port.

use core::marker::PhantomData;
use core::ptr::NonNull;
use core::slice;

use firmware::port::{
    Dma, DmaError, DmaEvents, DmaMode, Part, Port, Register, Registers, SLOTS, Target, Transfer,
};

use crate::chip::{Chip, Request};
use crate::silicon::Silicon;
use crate::stream::{self, Stream};

/// Times that EN is read, at most, until a stream that was stopped has written its last burst: some microseconds.
const POLLS: u32 = 1_000;

/// Memory in the DMA's hands: an address and a length, for a reference would claim that nobody else writes.
#[derive(Clone, Copy, Debug)]
struct Lent {
    memory: NonNull<u32>,
    words: usize,
}

/// The seam over the silicon.
#[derive(Debug)]
pub struct DcmiPort<'m, S> {
    silicon: S,
    chip: Chip,
    stream: Stream,
    lent: [Option<Lent>; SLOTS],
    /// Slot and first word of each target.
    aims: [Option<(usize, usize)>; 2],
    /// Both targets are used in turn.
    double: bool,
    /// Words of the transfers that run.
    words: u32,
    memory: PhantomData<&'m mut [u32]>,
}

// SAFETY: the addresses in `lent` came from `&mut [u32]`, which may be sent, and nobody but this port has them.
unsafe impl<S: Send> Send for DcmiPort<'_, S> {}

impl<S: Silicon> DcmiPort<'_, S> {
    /// The port of a chip. Both of DCMI and the DMA are clocked, and the pins are DCMI's.
    pub fn new(mut silicon: S, chip: Chip) -> Self {
        let stream = Stream { dma: chip.dma, number: chip.stream };
        if let Request::Multiplexer { register, request } = chip.request {
            silicon.write(register, request);
        }
        let lent = [None; SLOTS];
        Self { silicon, chip, stream, lent, aims: [None; 2], double: false, words: 0, memory: PhantomData }
    }

    fn control(&mut self) -> u32 {
        self.silicon.read(self.stream.control())
    }

    fn runs(&mut self) -> bool {
        self.control() & stream::ENABLE != 0
    }

    /// The address of a target, whose transfer lies within its buffer and the DMA's reach.
    fn aimed(&self, target: Target, words: u32) -> Result<u32, DmaError> {
        let nowhere = DmaError::Unsupported { what: "target that was never aimed" };
        let (slot, start) = self.aims[target as usize].ok_or(nowhere)?;
        let lent = self.lent.get(slot).copied().flatten().ok_or(DmaError::NotLent { slot })?;
        let needed = start.saturating_add(words as usize);
        if needed > lent.words {
            return Err(DmaError::OutOfBounds { slot, needed, lent: lent.words });
        }
        Ok(self.silicon.address(lent.memory.as_ptr()) + 4 * start as u32)
    }
}

impl<S: Silicon> Registers for DcmiPort<'_, S> {
    fn read(&mut self, register: Register) -> u32 {
        // What stands above DR is not DCMI's.
        if register > Register::Data { 0 } else { self.silicon.read(self.chip.dcmi + register.offset()) }
    }

    fn write(&mut self, register: Register, value: u32) {
        if register <= Register::Data {
            self.silicon.write(self.chip.dcmi + register.offset(), value);
        }
    }
}

impl<'m, S: Silicon> Dma<'m> for DcmiPort<'m, S> {
    fn lend(&mut self, slot: usize, memory: &'m mut [u32]) -> Result<(), &'m mut [u32]> {
        let Some(place @ None) = self.lent.get_mut(slot) else { return Err(memory) };
        let words = memory.len();
        *place = Some(Lent { memory: NonNull::from(memory).cast(), words });
        Ok(())
    }

    fn take_back(&mut self, slot: usize) -> Option<&'m mut [u32]> {
        self.lent.get(slot).copied().flatten()?;
        let used = if self.double { 2 } else { 1 };
        if self.aims[..used].iter().flatten().any(|aim| aim.0 == slot) && self.runs() {
            return None;
        }
        let lent = self.lent[slot].take()?;
        // What the DMA wrote before is what is read behind it.
        self.silicon.fence();
        // SAFETY: `lend` made this address and length of a `&'m mut [u32]` that it consumed, and the slot is empty now, so
        // this is the only reference again. The DMA does not write there: it is stopped, or neither target aims at it, and
        // `aim` and `start` need the slot to be lent.
        Some(unsafe { slice::from_raw_parts_mut(lent.memory.as_ptr(), lent.words) })
    }

    fn aim(&mut self, target: Target, slot: usize, start: usize) -> Result<(), DmaError> {
        let lent = self.lent.get(slot).copied().flatten().ok_or(DmaError::NotLent { slot })?;
        if start >= lent.words {
            return Err(DmaError::OutOfBounds { slot, needed: start.saturating_add(1), lent: lent.words });
        }
        let address = self.silicon.address(lent.memory.as_ptr());
        if !self.chip.reaches(address, lent.words) {
            let what = "way to this memory (a core's own, such as DTCM or CCM): place the buffers elsewhere";
            return Err(DmaError::Unsupported { what });
        }
        let control = self.control();
        if control & stream::ENABLE != 0 {
            let in_use = usize::from(control & stream::CURRENT_TARGET != 0) == target as usize;
            if in_use {
                // It has come here before it was told where to go. The register must not be written now, and the caller,
                // who asks for the target in use next, sees that it was late.
                return Ok(());
            }
            let needed = start.saturating_add(self.words as usize);
            if needed > lent.words {
                return Err(DmaError::OutOfBounds { slot, needed, lent: lent.words });
            }
            self.aims[target as usize] = Some((slot, start));
            self.silicon.fence();
            self.silicon.write(self.stream.memory(target as usize), address + 4 * start as u32);
        } else {
            self.aims[target as usize] = Some((slot, start));
        }
        Ok(())
    }

    fn start(&mut self, transfer: Transfer) -> Result<(), DmaError> {
        let limit = self.chip.part.transfer_limit;
        if transfer.words == 0 || transfer.words > limit {
            return Err(DmaError::TransferLength { words: transfer.words, limit });
        }
        if transfer.line_by_line {
            return Err(DmaError::Unsupported { what: "transfers that end with a line" });
        }
        let double = transfer.mode == DmaMode::Double;
        let first = self.aimed(Target::Zero, transfer.words)?;
        let second = if double { self.aimed(Target::One, transfer.words)? } else { first };
        self.stop();
        if self.runs() {
            return Err(DmaError::Unsupported { what: "second transfer while the first does not end" });
        }
        (self.double, self.words) = (double, transfer.words);
        let stream = self.stream;
        let channel = match self.chip.request {
            Request::Channel(channel) => channel,
            Request::Multiplexer { .. } => 0,
        };
        let aligned = (first | second).is_multiple_of(16);
        let control = stream::control(transfer, aligned, channel);
        let data = self.chip.dcmi + Register::Data.offset();
        self.silicon.write(stream.peripheral(), data);
        self.silicon.write(stream.memory(0), first);
        self.silicon.write(stream.memory(1), second);
        self.silicon.write(stream.count(), transfer.words);
        self.silicon.write(stream.fifo(), stream::FIFO);
        self.silicon.write(stream.control(), control);
        // The buffers are as the processor left them before the DMA touches them.
        self.silicon.fence();
        self.silicon.write(stream.control(), control | stream::ENABLE);
        Ok(())
    }

    fn stop(&mut self) {
        let control = self.control();
        self.silicon.write(self.stream.control(), control & !stream::ENABLE);
        for _ in 0..POLLS {
            if !self.runs() {
                break;
            }
        }
        self.silicon.fence();
        self.silicon.write(self.stream.clear(), stream::FLAGS << self.stream.shift());
    }

    fn events(&mut self) -> DmaEvents {
        let status = self.silicon.read(self.stream.status());
        self.stream.events(status)
    }

    fn acknowledge(&mut self, events: DmaEvents) {
        self.silicon.write(self.stream.clear(), self.stream.clearing(events));
    }

    fn target(&mut self) -> Target {
        if self.control() & stream::CURRENT_TARGET == 0 { Target::Zero } else { Target::One }
    }

    fn remaining(&mut self) -> u32 {
        self.silicon.read(self.stream.count())
    }
}

impl<'m, S: Silicon> Port<'m> for DcmiPort<'m, S> {
    fn part(&self) -> Part {
        self.chip.part
    }
}
