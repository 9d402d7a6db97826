//! Bytes to stretches.
//!
//! ```text
//! Read ─► one chunk in the lent buffer ─► CRC-32 ─► records, samples handed on where they lie
//! ```
//!
//! Nothing of a chunk is delivered before its checksum was right, so a damaged file never yields damaged pixels: the
//! stretches delivered before an error are a true beginning of the trace. Memory is the lent [`ChunkBuffer`] and some
//! 100 bytes. The one copy is that of `Read` into the buffer.

use core::borrow::BorrowMut;

use embedded_io::Read;

use super::StretchSink;
use super::checksum::{Checksum, small_table};
use super::error::{Error, Problem};
use super::layout::{
    CHUNK_BYTES, CHUNK_HEAD, CHUNK_TAIL, ChunkBuffer, ChunkType, FLAG_SKIPPABLE, HEADER_BYTES, Header,
    INDEX_HEAD, MARK_BYTES, PROFILE_BYTES, Totals, u16_at, u32_at, u64_at,
};
use super::record::{Kind, Record};
use crate::camif::pins::{Samples, Sync};

/// What a trace holds, in the order of the file.
#[derive(Clone, Copy, Debug)]
pub enum Item<'a> {
    /// The next part of the profile's text.
    Profile(&'a str),
    /// The next pixel clocks.
    Stretch(Sync, Samples<'a>),
    /// The end; it comes once, and reading stops.
    End(Totals),
}

/// Why [`Reader::play`] stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlayError<E, S> {
    /// The trace.
    Read(Error<E>),
    /// The sink wanted no more.
    Sink(S),
}

/// Reads a trace, a chunk at a time. `B` is the buffer: lent, boxed or given.
#[derive(Debug)]
pub struct Reader<R, B> {
    pub(super) inner: R,
    buffer: B,
    header: Header,
    /// Of the next chunk in the file.
    pub(super) offset: u64,
    /// Of the chunk in the buffer.
    chunk_offset: u64,
    /// The unread records in the buffer; empty unless it holds a DATA chunk.
    at: usize,
    end: usize,
    /// Number of the next clock.
    clock: u64,
    pub(super) progress: Progress,
    checksum: Checksum,
}

/// What has been seen of a file, to check that nothing is missing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Progress {
    /// The reader jumped here, so it cannot know how many marks came before.
    jumped: bool,
    pub(super) state: State,
    profile_bytes: usize,
    marks: u64,
    last_index: u64,
}

impl Progress {
    pub(super) fn after_jump() -> Self {
        Self { jumped: true, ..Self::default() }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum State {
    #[default]
    Open,
    Ended,
    Failed,
}

impl<R: Read, B: BorrowMut<ChunkBuffer>> Reader<R, B> {
    /// Reads the header.
    ///
    /// # Errors
    /// If there is none, or it is damaged, or of another version.
    pub fn new(inner: R, buffer: B) -> Result<Self, Error<R::Error>> {
        Self::with_checksum(inner, buffer, small_table)
    }

    /// Reads the header, with another way to compute CRC-32.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_checksum(mut inner: R, buffer: B, checksum: Checksum) -> Result<Self, Error<R::Error>> {
        let mut bytes = [0; HEADER_BYTES];
        read_exact(&mut inner, &mut bytes, 0)?;
        let header = Header::from_bytes(&bytes, checksum).map_err(|problem| problem.at(0))?;
        Ok(Self {
            inner,
            buffer,
            header,
            offset: HEADER_BYTES as u64,
            chunk_offset: 0,
            at: 0,
            end: 0,
            clock: 0,
            progress: Progress::default(),
            checksum,
        })
    }

    /// What the file says of itself.
    pub fn header(&self) -> Header {
        self.header
    }

    /// Number of the next clock, from 0.
    pub fn clock(&self) -> u64 {
        self.clock
    }

    /// Bytes of the file read so far (after a jump: its position).
    pub fn position(&self) -> u64 {
        self.offset
    }

    /// The next part of the file; `None` after the end. Samples lie in the lent buffer until the next call.
    ///
    /// # Errors
    /// [`Error::Io`] from the reader, [`Error::File`] if the file is damaged, malformed or ends too early. After an
    /// error every call fails with [`Problem::Stopped`].
    pub fn next_item(&mut self) -> Result<Option<Item<'_>>, Error<R::Error>> {
        match self.progress.state {
            State::Open => {}
            State::Ended => return Ok(None),
            State::Failed => return Err(Problem::Stopped.at(self.chunk_offset)),
        }
        self.progress.state = State::Failed; // until this call has gone well
        while self.at == self.end {
            match self.next_chunk()? {
                Some(ChunkType::Data) | None => {}
                Some(ChunkType::Index) => self.check_index()?,
                Some(ChunkType::Profile) => return self.profile().map(Some),
                Some(ChunkType::End) => {
                    let totals = self.check_end()?;
                    self.progress.state = State::Ended;
                    return Ok(Some(Item::End(totals)));
                }
            }
        }
        let (sync, samples) = self.record()?;
        Ok(Some(Item::Stretch(sync, samples)))
    }

    /// Plays what is left of the trace into `sink`.
    ///
    /// # Errors
    /// Those of [`next_item`](Self::next_item), and the sink's.
    pub fn play<S: StretchSink>(&mut self, sink: &mut S) -> Result<(), PlayError<R::Error, S::Error>> {
        while let Some(item) = self.next_item().map_err(PlayError::Read)? {
            if let Item::Stretch(sync, samples) = item {
                sink.stretch(sync, samples).map_err(PlayError::Sink)?;
            }
        }
        Ok(())
    }

    /// Puts the next chunk into the buffer and checks it; `None` for one that may be skipped. Of a DATA chunk, the
    /// clock is checked and the records are made ready.
    fn next_chunk(&mut self) -> Result<Option<ChunkType>, Error<R::Error>> {
        let (at, end) = (CHUNK_HEAD, self.load_chunk()?);
        let bytes = self.buffer.borrow().bytes();
        let Some(kind) = ChunkType::from_code(bytes[0]) else {
            if bytes[1] & FLAG_SKIPPABLE != 0 {
                return Ok(None);
            }
            return Err(Problem::UnknownChunk { code: bytes[0] }.at(self.chunk_offset));
        };
        if kind == ChunkType::Data {
            let found = u64_at(bytes, at);
            if end < at + 8 {
                return Err(Problem::Record.at(self.chunk_offset));
            }
            if found != self.clock {
                return Err(Problem::Clock { expected: self.clock, found }.at(self.chunk_offset));
            }
            (self.at, self.end) = (at + 8, end);
        }
        Ok(Some(kind))
    }

    /// Reads a whole chunk, checks its length and checksum, and says where its payload ends in the buffer.
    pub(super) fn load_chunk(&mut self) -> Result<usize, Error<R::Error>> {
        (self.at, self.end) = (0, 0);
        self.chunk_offset = self.offset;
        let bytes = self.buffer.borrow_mut().bytes_mut();
        let (head, rest) = bytes.split_at_mut(CHUNK_HEAD);
        read_exact(&mut self.inner, head, self.chunk_offset)?;
        let length = u16_at(head, 2);
        let end = CHUNK_HEAD + usize::from(length);
        if end + CHUNK_TAIL > CHUNK_BYTES {
            return Err(Problem::ChunkLength { found: length }.at(self.chunk_offset));
        }
        read_exact(&mut self.inner, &mut rest[..usize::from(length) + CHUNK_TAIL], self.chunk_offset)?;
        if (self.checksum)(&bytes[..end]) != u32_at(bytes, end) {
            return Err(Problem::Damaged.at(self.chunk_offset));
        }
        self.offset += (end + CHUNK_TAIL) as u64;
        Ok(end)
    }

    fn profile(&mut self) -> Result<Item<'_>, Error<R::Error>> {
        let payload = self.payload();
        let length = payload.len();
        if self.clock != 0 {
            return Err(Problem::Order.at(self.chunk_offset));
        }
        if self.progress.profile_bytes + length > PROFILE_BYTES || core::str::from_utf8(payload).is_err() {
            return Err(Problem::Profile.at(self.chunk_offset));
        }
        self.progress.profile_bytes += length;
        self.progress.state = State::Open;
        Ok(Item::Profile(core::str::from_utf8(self.payload()).unwrap_or_default()))
    }

    fn record(&mut self) -> Result<(Sync, Samples<'_>), Error<R::Error>> {
        let sample_bytes = self.header.sample_bytes();
        let bytes = self.buffer.borrow().bytes().get(..self.end).unwrap_or_default();
        let (record, from, to) =
            Record::parse(bytes, self.at, sample_bytes).map_err(|problem| problem.at(self.chunk_offset))?;
        let clocks = u64::from(record.clocks);
        self.at = to;
        let wide = sample_bytes == 2;
        if wide {
            // `from` and `to` are even: the payload starts so, and all that stands in it has an even length.
            let words = self.buffer.borrow_mut().0.get_mut(from / 2..to / 2).unwrap_or_default();
            let mut all = 0;
            for word in &mut *words {
                *word = u16::from_le(*word);
                all |= *word;
            }
            if all > self.header.sample_max() {
                let value = words.iter().copied().max().unwrap_or(all);
                return Err(Problem::Sample { value }.at(self.chunk_offset));
            }
        }
        self.clock += clocks;
        self.progress.state = State::Open;
        let words = self.buffer.borrow().0.get(from / 2..to / 2).unwrap_or_default();
        let bytes = self.buffer.borrow().bytes().get(from..to).unwrap_or_default();
        let samples = match (record.kind, wide) {
            (Kind::Literal, false) => Samples::Bytes(bytes),
            (Kind::Literal, true) => Samples::Words(words),
            (Kind::Repeat, _) => {
                let value = if wide { words.first().copied() } else { bytes.first().map(|&b| u16::from(b)) };
                Samples::Repeat { value: value.unwrap_or_default(), clocks: record.clocks }
            }
        };
        Ok((record.sync, samples))
    }

    /// An INDEX follows the one before it and numbers its marks on from there.
    fn check_index(&mut self) -> Result<(), Error<R::Error>> {
        let payload = self.payload();
        let (before, first) = (u64_at(payload, 0), u64_at(payload, 8));
        let marks = payload.len().saturating_sub(INDEX_HEAD) / MARK_BYTES;
        let shaped = marks > 0 && payload.len() == INDEX_HEAD + marks * MARK_BYTES;
        let seen = &mut self.progress;
        if !shaped || !seen.jumped && (before, first) != (seen.last_index, seen.marks) {
            return Err(Problem::Index.at(self.chunk_offset));
        }
        seen.last_index = self.chunk_offset;
        seen.marks = first.saturating_add(marks as u64);
        Ok(())
    }

    fn check_end(&mut self) -> Result<Totals, Error<R::Error>> {
        let totals = Totals::from_bytes(self.payload()).ok_or(Problem::Index.at(self.chunk_offset))?;
        let seen = self.progress;
        if totals.clocks != self.clock {
            return Err(Problem::Clock { expected: self.clock, found: totals.clocks }.at(self.chunk_offset));
        }
        if !seen.jumped && (totals.marks, totals.last_index) != (seen.marks, seen.last_index) {
            return Err(Problem::Index.at(self.chunk_offset));
        }
        Ok(totals)
    }

    /// The payload of the chunk in the buffer.
    pub(super) fn payload(&self) -> &[u8] {
        let bytes = self.buffer.borrow().bytes();
        bytes.get(CHUNK_HEAD..CHUNK_HEAD + usize::from(u16_at(bytes, 2))).unwrap_or_default()
    }

    /// The type byte of the chunk in the buffer.
    pub(super) fn chunk_type(&self) -> Option<ChunkType> {
        ChunkType::from_code(self.buffer.borrow().bytes()[0])
    }

    /// The reader stands before the chunk at `offset`, whose first clock is `clock`.
    pub(super) fn stand_at(&mut self, offset: u64, clock: u64, progress: Progress) {
        (self.offset, self.clock, self.progress) = (offset, clock, progress);
        (self.at, self.end) = (0, 0);
    }

    /// What it was made of.
    pub fn into_parts(self) -> (R, B) {
        (self.inner, self.buffer)
    }

    /// What it reads from.
    pub fn into_inner(self) -> R {
        self.inner
    }
}

/// Reads all of `bytes`; an early end is a truncation of what begins at `offset`.
pub(super) fn read_exact<R: Read>(
    inner: &mut R,
    bytes: &mut [u8],
    offset: u64,
) -> Result<(), Error<R::Error>> {
    // Not the reader's own `read_exact`: that one panics if a read claims more bytes than it had room for.
    let mut left = bytes;
    while !left.is_empty() {
        let count = inner.read(left).map_err(|error| Error::Io { offset, error })?;
        left = match left.split_at_mut_checked(count) {
            Some((_, rest)) if count > 0 => rest,
            _ => return Err(Problem::Truncated.at(offset)),
        };
    }
    Ok(())
}
