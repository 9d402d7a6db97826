//! A file as a row of blocks, of which one is in memory.
//!
//! ```text
//! bytes   │ done │ to be read …            │ \n × 64 │
//!         0      at                       end
//! refill: what is left moves to the front, the rest is read anew; lines that leave are counted
//! ```
//!
//! The blank tail lets the parser look ahead without asking whether there is anything.

use std::io::{self, Read};

use super::error::Problem;
use super::scan;

/// Bytes of a file in memory at a time. Fits a core's second-level cache.
const BLOCK: usize = 256 * 1024;
/// Blank bytes behind the block.
pub(super) const TAIL: usize = 64;

/// A block of a file and where in the file it is.
#[derive(Debug)]
pub(super) struct Blocks<R> {
    inner: R,
    bytes: Vec<u8>,
    /// First byte not parsed.
    pub(super) at: usize,
    end: usize,
    eof: bool,
    /// File offset of the block, and lines before it.
    offset: u64,
    lines: u64,
}

/// A line (from 1) and byte (from 0) of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: u64,
    /// Byte, from 0.
    pub offset: u64,
}

impl<R: Read> Blocks<R> {
    pub(super) fn new(inner: R) -> Self {
        Self { inner, bytes: vec![b'\n'; BLOCK + TAIL], at: 0, end: 0, eof: false, offset: 0, lines: 0 }
    }

    /// The block with its blank tail.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes[..self.end + TAIL]
    }

    /// Bytes of the block that are the file's.
    pub(super) fn end(&self) -> usize {
        self.end
    }

    /// The block ends where the file does.
    pub(super) fn is_last(&self) -> bool {
        self.eof
    }

    /// The place of a byte of the block.
    pub(super) fn place(&self, at: usize) -> Place {
        let before = self.bytes.get(..at).unwrap_or_default();
        Place { line: 1 + self.lines + newlines(before), offset: self.offset + at as u64 }
    }

    /// Bytes of the file that are parsed.
    pub(super) fn position(&self) -> u64 {
        self.offset + self.at as u64
    }

    /// Reads on; `false` if the rest of the block fills it, so that nothing could be read.
    pub(super) fn refill(&mut self) -> io::Result<bool> {
        let done = self.at.min(self.end);
        self.lines += newlines(&self.bytes[..done]);
        self.offset += done as u64;
        self.bytes.copy_within(done..self.end, 0);
        (self.at, self.end) = (0, self.end - done);
        let room = self.end < BLOCK;
        while self.end < BLOCK && !self.eof {
            match self.inner.read(&mut self.bytes[self.end..BLOCK]) {
                Ok(0) => self.eof = true,
                Ok(count) => self.end += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.bytes[self.end..self.end + TAIL].fill(b'\n');
        Ok(room)
    }

    /// The next token, as a range of the block; `None` at the end of the file.
    pub(super) fn token(&mut self) -> io::Result<Result<Option<(usize, usize)>, Problem>> {
        loop {
            let block = &self.bytes[..self.end];
            let from = self.at
                + block[self.at..].iter().position(|&b| !scan::is_blank(b)).unwrap_or(self.end - self.at);
            let to = scan::token_end(block, from);
            self.at = from;
            if to < self.end || self.eof {
                self.at = to;
                return Ok(Ok((from < to).then_some((from, to))));
            }
            if !self.refill()? {
                return Ok(Err(Problem::TokenTooLong));
            }
        }
    }
}

fn newlines(bytes: &[u8]) -> u64 {
    // Sums of at most 255 fit a byte, so that the compiler can add sixteen at a time.
    bytes
        .chunks(255)
        .map(|chunk| u64::from(chunk.iter().map(|&byte| u8::from(byte == b'\n')).sum::<u8>()))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_and_lines_survive_block_borders() {
        let mut text = String::new();
        for number in 0..120_000 {
            text.push_str(&format!("{number}{}", ["\n", " ", "\r\n", "\t\n\n"][number % 4]));
        }
        assert!(text.len() > 2 * BLOCK);
        let mut blocks = Blocks::new(text.as_bytes());
        for number in 0..120_000 {
            let (from, to) = blocks.token().unwrap().unwrap().unwrap();
            assert_eq!(std::str::from_utf8(&blocks.bytes()[from..to]).unwrap(), number.to_string());
            if number % 9_999 == 0 {
                let place = blocks.place(from);
                let before = &text.as_bytes()[..place.offset as usize];
                assert!(text[place.offset as usize..].starts_with(&number.to_string()));
                assert_eq!(place.line, 1 + before.iter().filter(|&&b| b == b'\n').count() as u64);
            }
        }
        assert_eq!(blocks.token().unwrap().unwrap(), None);
    }

    #[test]
    fn a_token_larger_than_memory_is_refused() {
        let text = vec![b'x'; BLOCK + 1];
        assert_eq!(Blocks::new(&text[..]).token().unwrap(), Err(Problem::TokenTooLong));
    }
}
