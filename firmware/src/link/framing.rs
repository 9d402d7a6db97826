//! Packets on the wire: a body, its CRC, stuffed, closed by a zero; and back.
//!
//! ```text
//! memory of a Framer    ├ 0 ┤ slack ├──────── body ────────┤
//! after it              ├ 0 ├──────── stuffed body ───────┤ 0 ┤     in place, from left to right
//! ```

use memchr::memchr;

use super::crc::Checksum;
use super::stuffing::{Unstuffer, overhead, stuff};

/// The version of the protocol.
pub const VERSION: u8 = 1;
/// Bytes of the shortest body: version, kind, length, CRC.
pub const BODY_MIN: usize = 8;
/// Bytes of the largest body.
pub const BODY_MAX: usize = 4096;
/// Bytes of the largest body that goes to a device, if its HELLO does not say otherwise.
pub const COMMAND_BODY_MAX: usize = 512;
/// Bytes before what depends on the kind.
pub(super) const HEAD: usize = 4;
/// Bytes of the CRC.
const CRC: usize = 4;

/// Bytes on the wire of a body of so many at most, with the zeros before and after it: memory of a [`Framer`].
#[must_use]
pub const fn wire_bytes(body: usize) -> usize {
    1 + overhead(body) + body + 1
}

/// A packet does not fit the memory that was lent for it, or the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

impl core::fmt::Display for TooLong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the packet is too long for the memory lent for it")
    }
}

impl core::error::Error for TooLong {}

/// Makes packets, one at a time, in lent memory.
#[derive(Debug)]
pub struct Framer<'m> {
    memory: &'m mut [u8],
    checksum: Checksum,
    body_max: usize,
}

impl<'m> Framer<'m> {
    /// Packets as large as `memory` has room for; see [`wire_bytes`].
    pub fn new(memory: &'m mut [u8], checksum: Checksum) -> Self {
        let room = memory.len().saturating_sub(2);
        // The largest body with room for its overhead.
        let body_max = (room - room.div_ceil(255)).min(BODY_MAX);
        Self { memory, checksum, body_max }
    }

    /// Bytes of the largest body that fits.
    #[must_use]
    pub const fn body_max(&self) -> usize {
        self.body_max
    }

    /// Makes a packet: `fill` writes what comes after the first four bytes and says how much that is.
    /// `led`: with a zero before it.
    ///
    /// # Errors
    /// [`TooLong`] if `fill` says so, or if it does not fit.
    pub fn frame(
        &mut self,
        kind: u8,
        led: bool,
        fill: impl FnOnce(&mut [u8]) -> Option<usize>,
    ) -> Result<&[u8], TooLong> {
        self.try_frame(kind, led, fill).ok_or(TooLong)
    }

    fn try_frame(
        &mut self,
        kind: u8,
        led: bool,
        fill: impl FnOnce(&mut [u8]) -> Option<usize>,
    ) -> Option<&[u8]> {
        let start = 1 + overhead(self.body_max);
        let body = self.memory.get_mut(start..)?.get_mut(..self.body_max)?;
        let (head, rest) = body.split_first_chunk_mut::<HEAD>()?;
        let content_max = rest.len().checked_sub(CRC)?;
        let length = fill(rest.get_mut(..content_max)?)?;
        let [low, high] = u16::try_from(length).ok()?.to_le_bytes();
        *head = [VERSION, kind, low, high];
        let checked = HEAD + length;
        let crc = (self.checksum)(0, body.get(..checked)?);
        body.get_mut(checked..)?.first_chunk_mut::<CRC>()?.copy_from_slice(&crc.to_le_bytes());
        *self.memory.first_mut()? = 0;
        let end = stuff(self.memory, start, checked + CRC, 1)?;
        self.memory.get(usize::from(!led)..end)
    }
}

/// Why bytes between two zeros were no packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// More bytes than a packet can have, or than there is memory for.
    TooLong,
    /// Stuffing whose last group is cut.
    Stuffing,
    /// Fewer bytes than a packet has.
    TooShort,
    /// The CRC is not that of the bytes.
    Crc,
}

/// What a [`Deframer`] came upon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closed {
    /// A body whose CRC is right: [`Deframer::body`].
    Body,
    /// Something else.
    Damaged(Damage),
}

/// Cuts a stream of bytes into bodies. It is in step again at every zero.
#[derive(Debug)]
pub struct Deframer<'m> {
    body: &'m mut [u8],
    checksum: Checksum,
    filled: usize,
    unstuffer: Unstuffer,
    /// Bytes since the last zero, stuffed.
    taken: usize,
    overflow: bool,
    /// The body was handed out; what comes begins a new one.
    closed: bool,
}

impl<'m> Deframer<'m> {
    /// Takes bodies of up to as many bytes as `body` has.
    pub fn new(body: &'m mut [u8], checksum: Checksum) -> Self {
        let unstuffer = Unstuffer::default();
        Self { body, checksum, filled: 0, unstuffer, taken: 0, overflow: false, closed: false }
    }

    /// Takes bytes up to and with the next end of a packet. Returns how many, and what came to its end with them.
    pub fn push(&mut self, bytes: &[u8]) -> (usize, Option<Closed>) {
        if core::mem::take(&mut self.closed) {
            (self.filled, self.taken, self.overflow) = (0, 0, false);
            self.unstuffer = Unstuffer::default();
        }
        let mut start = 0;
        if self.taken == 0 {
            // Zeros between packets.
            start = bytes.iter().position(|&byte| byte != 0).unwrap_or(bytes.len());
        }
        let rest = bytes.get(start..).unwrap_or_default();
        let end = memchr(0, rest);
        let piece = rest.get(..end.unwrap_or(rest.len())).unwrap_or_default();
        self.taken = self.taken.saturating_add(piece.len());
        if !self.overflow {
            self.overflow = self.unstuffer.take(piece, self.body, &mut self.filled).is_err();
        }
        match end {
            None => (bytes.len(), None),
            Some(end) => {
                self.closed = true;
                (start + end + 1, Some(self.close()))
            }
        }
    }

    fn close(&self) -> Closed {
        let damaged = if self.overflow {
            Damage::TooLong
        } else if !self.unstuffer.is_whole() {
            Damage::Stuffing
        } else if self.filled < BODY_MIN {
            Damage::TooShort
        } else {
            let Some((checked, crc)) = self.content().split_last_chunk::<CRC>() else {
                return Closed::Damaged(Damage::TooShort);
            };
            if (self.checksum)(0, checked) == u32::from_le_bytes(*crc) {
                return Closed::Body;
            }
            Damage::Crc
        };
        Closed::Damaged(damaged)
    }

    fn content(&self) -> &[u8] {
        self.body.get(..self.filled).unwrap_or_default()
    }

    /// The body that was [closed](Closed::Body) last, with its CRC; until the next [`Deframer::push`].
    #[must_use]
    pub fn body(&self) -> &[u8] {
        if self.closed { self.content() } else { &[] }
    }
}

#[cfg(test)]
mod tests {
    use super::super::crc::small_table;
    use super::*;

    #[test]
    fn memory_holds_just_what_was_asked_for() {
        for body in [8, 64, 253, 254, 255, 508, 509, 512, 1938, 4095, BODY_MAX] {
            let mut memory = std::vec![0; wire_bytes(body)];
            let mut framer = Framer::new(&mut memory, small_table);
            assert_eq!(framer.body_max(), body);
            let wire = framer.frame(9, true, |content| {
                content.fill(0xA5);
                Some(content.len())
            });
            let wire = wire.unwrap().to_vec();
            assert!(wire.len() <= wire_bytes(body) && wire[0] == 0 && *wire.last().unwrap() == 0);
            let mut body_memory = std::vec![0; body];
            let mut deframer = Deframer::new(&mut body_memory, small_table);
            assert_eq!(deframer.push(&wire), (wire.len(), Some(Closed::Body)));
            assert_eq!(deframer.body().len(), body);
            let mut short_memory = std::vec![0; body - 1];
            let mut deframer = Deframer::new(&mut short_memory, small_table);
            assert_eq!(deframer.push(&wire).1, Some(Closed::Damaged(Damage::TooLong)));
        }
    }

    #[test]
    fn too_little_memory_is_an_error() {
        for size in 0..wire_bytes(BODY_MIN) {
            let mut memory = std::vec![0; size];
            assert_eq!(Framer::new(&mut memory, small_table).frame(1, true, |_| Some(0)), Err(TooLong));
        }
        let mut memory = std::vec![0; wire_bytes(20)];
        let mut framer = Framer::new(&mut memory, small_table);
        assert_eq!(framer.frame(1, true, |content| Some(content.len() + 1)), Err(TooLong));
        assert_eq!(framer.frame(1, true, |_| None), Err(TooLong));
        assert!(framer.frame(1, true, |_| Some(0)).is_ok());
    }
}
