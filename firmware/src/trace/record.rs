//! One stretch as bytes.
//!
//! ```text
//! bit   15     14     13 12   11 … 0
//!       vsync  hsync  kind    clocks − 1, low bits
//!
//! kind  0 literal       clocks samples follow
//!       1 repeat        one sample follows
//!       2 long repeat   clocks − 1, bits 27 … 12 (two bytes), then one sample
//!       3 none          refused
//! ```
//!
//! A sample is one byte on an 8-bit bus, else two; then every record starts at an even offset.

use super::error::Problem;
use super::layout::u16_at;
use crate::camif::pins::Sync;

/// Most clocks of a literal or short repeat.
pub const SHORT_CLOCKS: u32 = 1 << 12;
/// Most clocks of a long repeat.
pub const LONG_CLOCKS: u32 = 1 << 28;
/// Bytes before the first sample of a literal or short repeat.
pub const HEAD_BYTES: usize = 2;

/// What a record's samples mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A sample a clock.
    Literal,
    /// One sample for all clocks.
    Repeat,
}

/// A record but for its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Levels of the sync wires.
    pub sync: Sync,
    /// What the samples mean.
    pub kind: Kind,
    /// Pixel clocks, at least 1.
    pub clocks: u32,
}

impl Record {
    /// The first two bytes, and the two that follow in a long repeat. Clocks outside 1 … [`LONG_CLOCKS`]
    /// (or [`SHORT_CLOCKS`] for a literal) are the caller's fault and lose their upper bits.
    #[must_use]
    pub fn head(&self) -> (u16, Option<u16>) {
        let count = self.clocks.wrapping_sub(1);
        let long = self.kind == Kind::Repeat && self.clocks > SHORT_CLOCKS;
        let kind = match self.kind {
            Kind::Literal => 0,
            Kind::Repeat if !long => 1,
            Kind::Repeat => 2,
        };
        let sync = u16::from(self.sync.vsync) << 15 | u16::from(self.sync.hsync) << 14;
        let low = sync | kind << 12 | (count & 0xFFF) as u16;
        (low, long.then_some((count >> 12) as u16))
    }

    /// The record at `at`, and where its samples begin and end.
    ///
    /// # Errors
    /// [`Problem::Record`] if it is of no known kind or runs past the end of `bytes`.
    pub fn parse(bytes: &[u8], at: usize, sample_bytes: usize) -> Result<(Self, usize, usize), Problem> {
        if at + HEAD_BYTES > bytes.len() {
            return Err(Problem::Record);
        }
        let head = u16_at(bytes, at);
        let sync = Sync { vsync: head >> 15 != 0, hsync: head >> 14 & 1 != 0 };
        let short = u32::from(head & 0xFFF) + 1;
        let from = at + HEAD_BYTES;
        let (kind, clocks, from, samples) = match head >> 12 & 3 {
            0 => (Kind::Literal, short, from, short as usize),
            1 => (Kind::Repeat, short, from, 1),
            2 => (Kind::Repeat, short + (u32::from(u16_at(bytes, from)) << 12), from + 2, 1),
            _ => return Err(Problem::Record),
        };
        let to = from + samples * sample_bytes;
        if to > bytes.len() {
            return Err(Problem::Record);
        }
        Ok((Self { sync, kind, clocks }, from, to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_length_survives() {
        let sync = Sync { hsync: true, vsync: false };
        for (kind, clocks) in [
            (Kind::Literal, 1),
            (Kind::Literal, 3),
            (Kind::Repeat, 1),
            (Kind::Repeat, SHORT_CLOCKS),
            (Kind::Repeat, SHORT_CLOCKS + 1),
            (Kind::Repeat, LONG_CLOCKS),
        ] {
            let record = Record { sync, kind, clocks };
            let (low, high) = record.head();
            let mut bytes = [0; 7];
            bytes[..2].copy_from_slice(&low.to_le_bytes());
            bytes[2..4].copy_from_slice(&high.unwrap_or(0).to_le_bytes());
            let (parsed, from, to) = Record::parse(&bytes, 0, 1).unwrap();
            assert_eq!(parsed, record);
            assert_eq!(from, if high.is_some() { 4 } else { 2 });
            assert_eq!(to - from, if kind == Kind::Literal { clocks as usize } else { 1 });
        }
    }

    #[test]
    fn records_past_the_end_or_of_no_kind_are_refused() {
        assert_eq!(Record::parse(&[0x01, 0x00, 7], 0, 1), Err(Problem::Record));
        assert_eq!(Record::parse(&[0x00], 0, 1), Err(Problem::Record));
        assert_eq!(Record::parse(&[0x00, 0x30, 7], 0, 1), Err(Problem::Record));
        assert_eq!(Record::parse(&[0x00, 0x20, 7], 0, 1), Err(Problem::Record));
    }
}
