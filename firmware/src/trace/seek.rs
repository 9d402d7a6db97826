//! Jumps to a frame.
//!
//! ```text
//! … INDEX ◄──── INDEX ◄──── INDEX ◄── END        each INDEX names the one before it, END the last
//!     marks 0…31   32…63       64…70
//! ```
//!
//! The chain is walked from the end, so a recorder needs room for the marks of one INDEX only. A jump costs one
//! read an INDEX; files of a few thousand frames have about a hundred.

use embedded_io::{Read, Seek, SeekFrom};

use super::checksum::Checksum;
use super::error::{Error, Problem};
use super::layout::{
    CHUNK_HEAD, CHUNK_TAIL, ChunkType, END_BYTES, HEADER_BYTES, INDEX_HEAD, MARK_BYTES, Mark, Totals, u64_at,
};
use super::reader::{Progress, Reader, State};

impl<R: Read + Seek, C: Checksum> Reader<'_, R, C> {
    /// Back to the first clock.
    ///
    /// # Errors
    /// [`Error::Io`] if the reader cannot seek.
    pub fn rewind(&mut self) -> Result<(), Error<R::Error>> {
        self.go_to(HEADER_BYTES as u64)?;
        self.stand_at(HEADER_BYTES as u64, 0, Progress::default());
        Ok(())
    }

    /// Reads END without playing the trace; the reader must then be rewound or sent to a mark.
    ///
    /// # Errors
    /// If the file does not end with an undamaged END.
    pub fn totals(&mut self) -> Result<Totals, Error<R::Error>> {
        self.progress.state = State::Failed;
        let length = CHUNK_HEAD + END_BYTES + CHUNK_TAIL;
        let end = self.seek(SeekFrom::End(0))?;
        let Some(offset) = end.checked_sub(length as u64).filter(|&offset| offset >= HEADER_BYTES as u64)
        else {
            return Err(Problem::Truncated.at(end));
        };
        self.go_to(offset)?;
        // A file cut elsewhere ends with other bytes, whatever they look like.
        let truncated = |error| match error {
            Error::File { .. } => Problem::Truncated.at(offset),
            error @ Error::Io { .. } => error,
        };
        self.load_chunk().map_err(truncated)?;
        match (self.chunk_type(), Totals::from_bytes(self.payload())) {
            (Some(ChunkType::End), Some(totals)) => Ok(totals),
            _ => Err(Problem::Truncated.at(offset)),
        }
    }

    /// Goes to mark `number`: the next stretch is the first of that frame. Mark 0 is the first clock of the trace;
    /// the others are where VSYNC goes to its active level.
    ///
    /// # Errors
    /// [`Problem::NoMark`] if the trace has fewer; those of [`totals`](Self::totals), or a damaged index.
    pub fn seek_mark(&mut self, number: u64) -> Result<Mark, Error<R::Error>> {
        let totals = self.totals()?;
        if number >= totals.marks {
            return Err(Problem::NoMark { marks: totals.marks }.at(self.offset));
        }
        let mut offset = totals.last_index;
        let mark = loop {
            self.go_to(offset)?;
            self.load_chunk()?;
            let payload = self.payload();
            let (before, first) = (u64_at(payload, 0), u64_at(payload, 8));
            if self.chunk_type() != Some(ChunkType::Index) {
                return Err(Problem::Index.at(offset));
            }
            if number >= first {
                let at = usize::try_from(number - first)
                    .ok()
                    .and_then(|index| index.checked_mul(MARK_BYTES)?.checked_add(INDEX_HEAD));
                let Some(entry) = at.and_then(|at| payload.get(at..)?.get(..MARK_BYTES)) else {
                    return Err(Problem::Index.at(offset));
                };
                break Mark { offset: u64_at(entry, 0), clock: u64_at(entry, 8) };
            }
            // The chain runs towards the start, so a forged one cannot go round for ever.
            if before >= offset || before < HEADER_BYTES as u64 {
                return Err(Problem::Index.at(offset));
            }
            offset = before;
        };
        self.go_to(mark.offset)?;
        self.stand_at(mark.offset, mark.clock, Progress::after_jump());
        Ok(mark)
    }

    fn go_to(&mut self, offset: u64) -> Result<(), Error<R::Error>> {
        self.seek(SeekFrom::Start(offset))?;
        self.offset = offset;
        Ok(())
    }

    fn seek(&mut self, to: SeekFrom) -> Result<u64, Error<R::Error>> {
        let offset = self.offset;
        self.inner.seek(to).map_err(|error| Error::Io { offset, error })
    }
}
