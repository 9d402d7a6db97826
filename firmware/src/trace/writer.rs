//! Stretches to bytes, with the index.
//!
//! ```text
//! stretch ─► runs ─► records in the lent buffer ─► chunk, CRC-32 ─► Write
//!                    at a VSYNC edge: a new chunk, and a mark ─► INDEX every 32 marks
//! ```
//!
//! Runs are looked for in blocks of 32 equal samples, which costs less than a copy and finds blanking and flat
//! areas; equal neighbours are joined, so how the caller cuts its stretches does not show in the file. Memory is the
//! lent [`ChunkBuffer`] and 32 marks (512 bytes).

use core::fmt;
use core::marker::PhantomData;

use embedded_io::Write;

use super::StretchSink;
use super::checksum::{Checksum, SmallTable};
use super::layout::{
    CHUNK_HEAD, CHUNK_TAIL, ChunkBuffer, ChunkType, Header, INDEX_HEAD, MARK_BYTES, Mark, PAYLOAD_BYTES,
    PROFILE_BYTES, Totals,
};
use super::record::{HEAD_BYTES, Kind, LONG_CLOCKS, Record, SHORT_CLOCKS};
use crate::camif::pins::{Samples, Sync};

/// Marks kept until an INDEX is written.
const MARKS: usize = 32;
/// Equal samples that make a run.
const RUN: usize = 32;
/// Where a chunk's records must end.
const RECORDS_END: usize = CHUNK_HEAD + PAYLOAD_BYTES;
/// Where a DATA chunk's records begin, after the clock number.
const RECORDS_START: usize = CHUNK_HEAD + 8;

/// Why writing stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteError<E> {
    /// The output failed; what was written is not a whole trace.
    Io(E),
    /// The header's bus is not 8, 10, 12 or 14 bits wide.
    BusBits(u8),
    /// The profile's text is longer than 64 KiB.
    Profile {
        /// Its bytes.
        bytes: usize,
    },
    /// A sample does not fit the bus.
    Sample {
        /// Number of its clock.
        clock: u64,
        /// The sample.
        value: u16,
        /// Width of the bus.
        bus_bits: u8,
    },
}

impl<E: fmt::Display> fmt::Display for WriteError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::BusBits(bits) => write!(f, "a bus of {bits} bits; it must be 8, 10, 12 or 14"),
            Self::Profile { bytes } => {
                write!(f, "a profile of {bytes} bytes; a trace carries at most {PROFILE_BYTES}")
            }
            Self::Sample { clock, value, bus_bits } => {
                write!(f, "sample 0x{value:X} at clock {clock} does not fit a bus of {bus_bits} bits")
            }
        }
    }
}

impl<E: fmt::Debug + fmt::Display> core::error::Error for WriteError<E> {}

/// Writes a trace. `C` computes the checksums. After an error the output is not a whole trace.
#[derive(Debug)]
pub struct Writer<'b, W, C = SmallTable> {
    inner: W,
    buffer: &'b mut ChunkBuffer,
    header: Header,
    /// Bytes written.
    offset: u64,
    /// End of the records in the buffer.
    fill: usize,
    /// Clocks in records.
    clock: u64,
    /// Clock of the first record in the buffer.
    chunk_clock: u64,
    /// The record last put, if it is a literal in the buffer: it can grow.
    literal: Option<(usize, Record)>,
    /// A repeat that may go on; not yet in the buffer.
    repeat: Option<(Sync, u16, u32)>,
    vsync: Option<bool>,
    marks: [Mark; MARKS],
    marks_held: usize,
    totals: Totals,
    checksum: PhantomData<C>,
}

/// A sample as it comes: a byte or a word.
trait BusSample: Copy {
    fn value(self) -> u16;
}

impl BusSample for u8 {
    fn value(self) -> u16 {
        u16::from(self)
    }
}

impl BusSample for u16 {
    fn value(self) -> u16 {
        self
    }
}

impl<'b, W: Write, C: Checksum> Writer<'b, W, C> {
    /// Writes header and profile.
    ///
    /// # Errors
    /// A bus width or a profile that the format has no room for, or the output's error.
    pub fn new(
        inner: W,
        header: Header,
        profile: &str,
        buffer: &'b mut ChunkBuffer,
    ) -> Result<Self, WriteError<W::Error>> {
        if !matches!(header.bus_bits, 8 | 10 | 12 | 14) {
            return Err(WriteError::BusBits(header.bus_bits));
        }
        if profile.len() > PROFILE_BYTES {
            return Err(WriteError::Profile { bytes: profile.len() });
        }
        let mut writer = Self {
            inner,
            buffer,
            header,
            offset: 0,
            fill: RECORDS_START,
            clock: 0,
            chunk_clock: 0,
            literal: None,
            repeat: None,
            vsync: None,
            marks: [Mark::default(); MARKS],
            marks_held: 0,
            totals: Totals::default(),
            checksum: PhantomData,
        };
        let bytes = header.to_bytes::<C>();
        writer.inner.write_all(&bytes).map_err(WriteError::Io)?;
        writer.offset = bytes.len() as u64;
        let mut rest = profile;
        while !rest.is_empty() {
            let mut cut = rest.len().min(PAYLOAD_BYTES);
            while !rest.is_char_boundary(cut) {
                cut -= 1;
            }
            let (part, tail) = rest.split_at(cut);
            writer.write_chunk(ChunkType::Profile, &[part.as_bytes()])?;
            rest = tail;
        }
        Ok(writer)
    }

    /// A frame begins with the next clock: it gets a mark to jump to. Edges of VSYNC are marked without being told;
    /// this is for buses without that wire.
    ///
    /// # Errors
    /// The output's.
    pub fn mark(&mut self) -> Result<(), WriteError<W::Error>> {
        self.flush_data()?;
        if self.marks_held == MARKS {
            self.write_index()?;
        }
        if let Some(mark) = self.marks.get_mut(self.marks_held) {
            *mark = Mark { offset: self.offset, clock: self.clock };
            self.marks_held += 1;
            self.totals.marks += 1;
        }
        Ok(())
    }

    /// Writes what is held, the index and END, and gives the output back.
    ///
    /// # Errors
    /// The output's.
    pub fn finish(mut self) -> Result<(W, Totals), WriteError<W::Error>> {
        self.flush_data()?;
        if self.marks_held > 0 {
            self.write_index()?;
        }
        self.totals.clocks = self.clock;
        let totals = self.totals;
        self.write_chunk(ChunkType::End, &[&totals.to_bytes()])?;
        self.inner.flush().map_err(WriteError::Io)?;
        Ok((self.inner, totals))
    }

    fn put_samples<T: BusSample>(&mut self, sync: Sync, samples: &[T]) -> Result<(), WriteError<W::Error>> {
        let max = self.header.sample_max();
        if samples.iter().fold(0, |all, sample| all | sample.value()) > max {
            let wide = samples.iter().position(|sample| sample.value() > max).unwrap_or_default();
            let value = samples.get(wide).map(|sample| sample.value()).unwrap_or_default();
            return self.too_wide(wide, value);
        }
        let mut rest = samples;
        while !rest.is_empty() {
            let uniform = |block: &&[T]| {
                let first = block[0].value();
                block.len() == RUN && block.iter().fold(0, |all, sample| all | (sample.value() ^ first)) == 0
            };
            let literal = rest.chunks(RUN).take_while(|block| !uniform(block)).map(<[T]>::len).sum();
            let (head, tail) = rest.split_at(literal);
            self.put_literal(sync, head)?;
            rest = tail;
            if let Some(&first) = rest.first() {
                let run = rest.iter().take_while(|sample| sample.value() == first.value()).count();
                self.put_repeat(sync, first.value(), run as u64)?;
                rest = &rest[run..];
            }
        }
        Ok(())
    }

    fn put_literal<T: BusSample>(&mut self, sync: Sync, samples: &[T]) -> Result<(), WriteError<W::Error>> {
        if !samples.is_empty() {
            self.flush_repeat()?;
        }
        let wide = self.header.sample_bytes();
        let mut rest = samples;
        while !rest.is_empty() {
            let (at, record) = match self.literal {
                Some((at, record))
                    if record.sync == sync
                        && record.clocks < SHORT_CLOCKS
                        && self.fill + wide <= RECORDS_END =>
                {
                    (at, record)
                }
                _ => {
                    self.make_room(HEAD_BYTES + wide)?;
                    let at = self.fill;
                    self.fill += HEAD_BYTES;
                    (at, Record { sync, kind: Kind::Literal, clocks: 0 })
                }
            };
            let room = (RECORDS_END - self.fill) / wide;
            let count = rest.len().min(room).min((SHORT_CLOCKS - record.clocks) as usize);
            let (head, tail) = rest.split_at(count);
            let target = &mut self.buffer.bytes_mut()[self.fill..self.fill + count * wide];
            if wide == 1 {
                for (byte, sample) in target.iter_mut().zip(head) {
                    *byte = sample.value() as u8;
                }
            } else {
                for (bytes, sample) in target.chunks_exact_mut(2).zip(head) {
                    bytes.copy_from_slice(&sample.value().to_le_bytes());
                }
            }
            let record = Record { clocks: record.clocks + count as u32, ..record };
            self.buffer.bytes_mut()[at..at + HEAD_BYTES].copy_from_slice(&record.head().0.to_le_bytes());
            self.literal = Some((at, record));
            self.fill += count * wide;
            self.clock += count as u64;
            rest = tail;
        }
        Ok(())
    }

    fn put_repeat(&mut self, sync: Sync, value: u16, clocks: u64) -> Result<(), WriteError<W::Error>> {
        let mut clocks = clocks;
        while clocks > 0 {
            let held = match self.repeat {
                Some((held_sync, held_value, held)) if (held_sync, held_value) == (sync, value) => held,
                _ => {
                    self.flush_repeat()?;
                    0
                }
            };
            let count = clocks.min(u64::from(LONG_CLOCKS - held));
            self.repeat = Some((sync, value, held + count as u32));
            clocks -= count;
            if held + count as u32 == LONG_CLOCKS {
                self.flush_repeat()?;
            }
        }
        Ok(())
    }

    /// Puts the repeat that is held into the buffer; a short one as a literal, which can join its neighbours.
    fn flush_repeat(&mut self) -> Result<(), WriteError<W::Error>> {
        let Some((sync, value, clocks)) = self.repeat.take() else { return Ok(()) };
        if clocks <= 4 {
            return self.put_literal(sync, &[value; 4][..clocks as usize]);
        }
        let wide = self.header.sample_bytes();
        self.make_room(HEAD_BYTES + 2 + wide)?;
        let (low, high) = Record { sync, kind: Kind::Repeat, clocks }.head();
        self.put(&low.to_le_bytes());
        if let Some(high) = high {
            self.put(&high.to_le_bytes());
        }
        self.put(&value.to_le_bytes()[..wide]);
        self.literal = None;
        self.clock += u64::from(clocks);
        Ok(())
    }

    /// Appends to the records; room has been made.
    fn put(&mut self, bytes: &[u8]) {
        self.buffer.bytes_mut()[self.fill..self.fill + bytes.len()].copy_from_slice(bytes);
        self.fill += bytes.len();
    }

    fn make_room(&mut self, bytes: usize) -> Result<(), WriteError<W::Error>> {
        if self.fill + bytes > RECORDS_END { self.write_data() } else { Ok(()) }
    }

    fn flush_data(&mut self) -> Result<(), WriteError<W::Error>> {
        self.flush_repeat()?;
        self.write_data()
    }

    /// Writes the records in the buffer as a DATA chunk.
    fn write_data(&mut self) -> Result<(), WriteError<W::Error>> {
        self.literal = None;
        if self.fill == RECORDS_START {
            return Ok(());
        }
        let length = (self.fill - CHUNK_HEAD) as u16;
        let bytes = self.buffer.bytes_mut();
        bytes[0] = ChunkType::Data.code();
        bytes[1] = 0;
        bytes[2..4].copy_from_slice(&length.to_le_bytes());
        bytes[4..12].copy_from_slice(&self.chunk_clock.to_le_bytes());
        let crc = C::crc32(&bytes[..self.fill]);
        let end = self.fill + CHUNK_TAIL;
        bytes[self.fill..end].copy_from_slice(&crc.to_le_bytes());
        self.inner.write_all(&bytes[..end]).map_err(WriteError::Io)?;
        self.offset += end as u64;
        self.fill = RECORDS_START;
        self.chunk_clock = self.clock;
        Ok(())
    }

    fn write_index(&mut self) -> Result<(), WriteError<W::Error>> {
        let mut marks = [0; MARKS * MARK_BYTES];
        for (bytes, mark) in marks.chunks_exact_mut(MARK_BYTES).zip(&self.marks[..self.marks_held]) {
            bytes[..8].copy_from_slice(&mark.offset.to_le_bytes());
            bytes[8..].copy_from_slice(&mark.clock.to_le_bytes());
        }
        let first = self.totals.marks - self.marks_held as u64;
        let mut head = [0; INDEX_HEAD];
        head[..8].copy_from_slice(&self.totals.last_index.to_le_bytes());
        head[8..].copy_from_slice(&first.to_le_bytes());
        let offset = self.offset;
        self.write_chunk(ChunkType::Index, &[&head, &marks[..self.marks_held * MARK_BYTES]])?;
        self.totals.last_index = offset;
        self.marks_held = 0;
        Ok(())
    }

    /// Writes a chunk made of `parts` through the buffer, which must hold no records.
    fn write_chunk(&mut self, kind: ChunkType, parts: &[&[u8]]) -> Result<(), WriteError<W::Error>> {
        let bytes = self.buffer.bytes_mut();
        let mut end = CHUNK_HEAD;
        for part in parts {
            bytes[end..end + part.len()].copy_from_slice(part);
            end += part.len();
        }
        bytes[0] = kind.code();
        bytes[1] = 0;
        bytes[2..4].copy_from_slice(&((end - CHUNK_HEAD) as u16).to_le_bytes());
        let crc = C::crc32(&bytes[..end]);
        bytes[end..end + CHUNK_TAIL].copy_from_slice(&crc.to_le_bytes());
        self.inner.write_all(&bytes[..end + CHUNK_TAIL]).map_err(WriteError::Io)?;
        self.offset += (end + CHUNK_TAIL) as u64;
        Ok(())
    }

    fn too_wide(&self, index: usize, value: u16) -> Result<(), WriteError<W::Error>> {
        let held = self.repeat.map_or(0, |(_, _, clocks)| u64::from(clocks));
        let clock = self.clock + held + index as u64;
        Err(WriteError::Sample { clock, value, bus_bits: self.header.bus_bits })
    }
}

impl<W: Write, C: Checksum> StretchSink for Writer<'_, W, C> {
    type Error = WriteError<W::Error>;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Self::Error> {
        if samples.is_empty() {
            return Ok(());
        }
        let edge = self.vsync != Some(sync.vsync) && sync.vsync == self.header.vsync_active;
        if edge || self.vsync.is_none() {
            self.mark()?;
        }
        self.vsync = Some(sync.vsync);
        match samples {
            Samples::Bytes(bytes) => self.put_samples(sync, bytes),
            Samples::Words(words) => self.put_samples(sync, words),
            Samples::Repeat { value, .. } if value > self.header.sample_max() => self.too_wide(0, value),
            Samples::Repeat { value, clocks } => self.put_repeat(sync, value, u64::from(clocks)),
        }
    }
}
