//! Every access of the driver to the block and its DMA, in order: a running checksum, and the first of them in full.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use firmware::port::{Dma, DmaError, DmaEvents, Part, Port, Register, Registers, Target, Transfer};

use super::scenario::Scenario;

static CRC32: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Accesses that are kept in full.
pub const KEPT: usize = 24;

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// A register was read: its offset, what it read.
    #[default]
    Read,
    /// A register was written: its offset, the value.
    Write,
    /// Memory was lent: the slot, words.
    Lend,
    /// Memory was taken back: the slot, words; 0 if the DMA keeps it.
    TakeBack,
    /// A target was pointed: target and slot, the first word.
    Aim,
    /// The DMA was started: words, mode and burst.
    Start,
    /// The DMA was stopped.
    Stop,
    /// The DMA's events were read: their bits, words of the line.
    Events,
    /// The DMA's events were cleared: their bits.
    Acknowledge,
    /// The target in use was read.
    Target,
    /// The words left were read.
    Remaining,
}

impl Kind {
    /// In a word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Write => "write",
            Self::Lend => "lend",
            Self::TakeBack => "take back",
            Self::Aim => "aim",
            Self::Start => "start",
            Self::Stop => "stop",
            Self::Events => "events",
            Self::Acknowledge => "acknowledge",
            Self::Target => "target",
            Self::Remaining => "remaining",
        }
    }
}

/// One access.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// What was done.
    pub kind: Kind,
    /// To which register or slot.
    pub place: u32,
    /// The value read or written.
    pub value: u32,
}

/// All accesses so far.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    /// How many.
    pub count: u32,
    /// CRC-32 of all, nine bytes each.
    checksum: u32,
    /// The first of them.
    pub first: [Access; KEPT],
}

impl Record {
    /// Nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        const NONE: Access = Access { kind: Kind::Read, place: 0, value: 0 };
        Self { count: 0, checksum: 0, first: [NONE; KEPT] }
    }

    /// Takes note of an access.
    pub fn note(&mut self, access: Access) {
        if let Some(place) = self.first.get_mut(self.count as usize) {
            *place = access;
        }
        self.count = self.count.wrapping_add(1);
        let mut digest = CRC32.digest_with_initial(self.checksum.reverse_bits() ^ u32::MAX);
        digest.update(&[access.kind as u8]);
        digest.update(&access.place.to_le_bytes());
        digest.update(&access.value.to_le_bytes());
        self.checksum = digest.finalize();
    }

    /// The first accesses, which are told in full where nothing goes wrong: how capture starts is the same everywhere.
    #[must_use]
    pub fn told(&self, scenario: &Scenario) -> &[Access] {
        let kept = if scenario.seen.is_empty() { KEPT.min(self.count as usize) } else { 0 };
        self.first.get(..kept).unwrap_or_default()
    }

    /// The checksum of all accesses in their order.
    #[must_use]
    pub const fn checksum(&self) -> u32 {
        self.checksum
    }
}

impl Default for Record {
    fn default() -> Self {
        Self::new()
    }
}

/// Where accesses go.
pub trait Log {
    /// Takes note of one.
    fn note(&mut self, access: Access);
}

impl Log for &core::cell::RefCell<Record> {
    fn note(&mut self, access: Access) {
        self.borrow_mut().note(access);
    }
}

/// A port whose every access is logged.
#[derive(Debug)]
pub struct Recorded<P, L> {
    /// The port.
    pub port: P,
    /// The log.
    pub log: L,
}

impl<P, L: Log> Recorded<P, L> {
    fn note(&mut self, kind: Kind, place: u32, value: u32) {
        self.log.note(Access { kind, place, value });
    }
}

fn bits(events: DmaEvents) -> u32 {
    u32::from(events.half) | u32::from(events.complete) << 1 | u32::from(events.error) << 2
}

impl<P: Registers, L: Log> Registers for Recorded<P, L> {
    fn read(&mut self, register: Register) -> u32 {
        let value = self.port.read(register);
        self.note(Kind::Read, register as u32, value);
        value
    }

    fn write(&mut self, register: Register, value: u32) {
        self.port.write(register, value);
        self.note(Kind::Write, register as u32, value);
    }
}

impl<'m, P: Dma<'m>, L: Log> Dma<'m> for Recorded<P, L> {
    fn lend(&mut self, slot: usize, memory: &'m mut [u32]) -> Result<(), &'m mut [u32]> {
        self.note(Kind::Lend, slot as u32, memory.len() as u32);
        self.port.lend(slot, memory)
    }

    fn take_back(&mut self, slot: usize) -> Option<&'m mut [u32]> {
        let memory = self.port.take_back(slot);
        self.note(Kind::TakeBack, slot as u32, memory.as_ref().map_or(0, |memory| memory.len() as u32));
        memory
    }

    fn aim(&mut self, target: Target, slot: usize, start: usize) -> Result<(), DmaError> {
        self.note(Kind::Aim, u32::from(target == Target::One) << 8 | slot as u32, start as u32);
        self.port.aim(target, slot, start)
    }

    fn start(&mut self, transfer: Transfer) -> Result<(), DmaError> {
        let how = (transfer.mode as u32) << 8 | transfer.burst.words();
        self.note(Kind::Start, transfer.words, how);
        self.port.start(transfer)
    }

    fn stop(&mut self) {
        self.note(Kind::Stop, 0, 0);
        self.port.stop();
    }

    fn events(&mut self) -> DmaEvents {
        let events = self.port.events();
        self.note(Kind::Events, bits(events), events.line_words);
        events
    }

    fn acknowledge(&mut self, events: DmaEvents) {
        self.note(Kind::Acknowledge, bits(events), 0);
        self.port.acknowledge(events);
    }

    fn target(&mut self) -> Target {
        let target = self.port.target();
        self.note(Kind::Target, 0, u32::from(target == Target::One));
        target
    }

    fn remaining(&mut self) -> u32 {
        let words = self.port.remaining();
        self.note(Kind::Remaining, 0, words);
        words
    }
}

impl<'m, P: Port<'m>, L: Log> Port<'m> for Recorded<P, L> {
    fn part(&self) -> Part {
        self.port.part()
    }
}
