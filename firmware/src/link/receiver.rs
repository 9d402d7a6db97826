//! Packets out of a reader.

use super::crc::Checksum;
use super::inbox::{Counts, Inbox, Received};

/// Reads packets, in memory for one body and for some bytes as they come.
#[derive(Debug)]
pub struct Receiver<'m, R> {
    reader: R,
    inbox: Inbox<'m>,
    chunk: &'m mut [u8],
    start: usize,
    end: usize,
}

impl<'m, R> Receiver<'m, R> {
    /// Reads up to `chunk.len()` bytes at a time, and bodies of as many bytes as `body` has.
    pub fn new(reader: R, body: &'m mut [u8], chunk: &'m mut [u8], checksum: Checksum) -> Self {
        Self { reader, inbox: Inbox::new(body, checksum), chunk, start: 0, end: 0 }
    }

    /// What came in so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.inbox.counts()
    }

    /// The reader.
    pub fn reader_mut(&mut self) -> &mut R {
        &mut self.reader
    }

    /// Goes on with the bytes at hand: true if something came to its end.
    fn advance(&mut self) -> bool {
        let bytes = self.chunk.get(self.start..self.end).unwrap_or_default();
        self.start += self.inbox.push(bytes);
        self.inbox.received().is_some()
    }

    fn filled(&mut self, count: usize) {
        (self.start, self.end) = (0, count);
    }
}

impl<R: embedded_io::Read> Receiver<'_, R> {
    /// Waits for the next packet, or for the end of something damaged. `None` at the end of the reader.
    ///
    /// # Errors
    /// The reader's; what was begun goes on with the next call.
    pub fn receive(&mut self) -> Result<Option<Received<'_>>, R::Error> {
        loop {
            if self.start == self.end {
                let count = self.reader.read(self.chunk)?;
                if count == 0 {
                    return Ok(None);
                }
                self.filled(count);
            }
            if self.advance() {
                return Ok(self.inbox.received());
            }
        }
    }
}

impl<R: embedded_io_async::Read> Receiver<'_, R> {
    /// Waits for the next packet, or for the end of something damaged. `None` at the end of the reader.
    ///
    /// # Errors
    /// The reader's; what was begun goes on with the next call.
    pub async fn receive_async(&mut self) -> Result<Option<Received<'_>>, R::Error> {
        loop {
            if self.start == self.end {
                let count = self.reader.read(self.chunk).await?;
                if count == 0 {
                    return Ok(None);
                }
                self.filled(count);
            }
            if self.advance() {
                return Ok(self.inbox.received());
            }
        }
    }
}
