//! Bytes into packets, whatever happened to them on the way.

use super::crc::Checksum;
use super::framing::{Closed, Damage, Deframer};
use super::packet::{Content, Packet};

/// What came in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received<'a> {
    /// A packet of this version.
    Packet(Packet<'a>),
    /// Bytes that are no packet.
    Damaged(Damage),
    /// A packet whose length or fields contradict the protocol; its kind.
    Malformed(u8),
    /// A kind of a later day.
    UnknownKind(u8),
    /// A sender that speaks another version.
    OtherVersion {
        /// The version of the packet.
        version: u8,
        /// From its HELLO, the oldest and the newest version that it speaks.
        spoken: Option<(u8, u8)>,
    },
}

/// How many of each came in; wraps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Packets of this version.
    pub received: u32,
    /// Stretches of bytes that are no packet.
    pub damaged: u32,
    /// Packets that contradict the protocol.
    pub malformed: u32,
    /// Packets of an unknown kind.
    pub unknown_kind: u32,
    /// Packets of another version.
    pub other_version: u32,
}

impl Counts {
    fn add(&mut self, received: &Received<'_>) {
        let count = match received {
            Received::Packet(_) => &mut self.received,
            Received::Damaged(_) => &mut self.damaged,
            Received::Malformed(_) => &mut self.malformed,
            Received::UnknownKind(_) => &mut self.unknown_kind,
            Received::OtherVersion { .. } => &mut self.other_version,
        };
        *count = count.wrapping_add(1);
    }
}

/// Takes bytes and hands out packets, one at a time, in memory for one body.
#[derive(Debug)]
pub struct Inbox<'m> {
    deframer: Deframer<'m>,
    closed: Option<Closed>,
    counts: Counts,
}

impl<'m> Inbox<'m> {
    /// Takes bodies of as many bytes as `memory` has.
    pub fn new(memory: &'m mut [u8], checksum: Checksum) -> Self {
        Self { deframer: Deframer::new(memory, checksum), closed: None, counts: Counts::default() }
    }

    /// Takes bytes up to and with the next end of a packet, and says how many. If a packet or something damaged came to
    /// its end with them, [`Inbox::received`] has it until the next call.
    pub fn push(&mut self, bytes: &[u8]) -> usize {
        let (taken, closed) = self.deframer.push(bytes);
        self.closed = closed;
        let mut counts = self.counts;
        if let Some(received) = self.received() {
            counts.add(&received);
        }
        self.counts = counts;
        taken
    }

    /// What came to its end with the last [`Inbox::push`].
    #[must_use]
    pub fn received(&self) -> Option<Received<'_>> {
        Some(match self.closed? {
            Closed::Damaged(damage) => Received::Damaged(damage),
            Closed::Body => match Content::read(self.deframer.body()) {
                Content::Packet(packet) => Received::Packet(packet),
                Content::Malformed { kind } => Received::Malformed(kind),
                Content::UnknownKind { kind } => Received::UnknownKind(kind),
                Content::OtherVersion { version, spoken } => Received::OtherVersion { version, spoken },
            },
        })
    }

    /// What came in so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Hands all packets in some bytes to `each`.
    pub fn feed(&mut self, mut bytes: &[u8], mut each: impl FnMut(Received<'_>)) {
        while !bytes.is_empty() {
            let taken = self.push(bytes);
            if let Some(received) = self.received() {
                each(received);
            }
            bytes = bytes.get(taken..).unwrap_or_default();
        }
    }
}
