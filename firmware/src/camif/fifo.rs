//! Between the pins' clock and the bus: bytes are packed into words, and four words wait for the bus.

/// Words that the FIFO holds.
pub const FIFO_WORDS: usize = 4;

/// Packs samples into 32-bit words, the first one in the least significant bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Packer {
    word: u32,
    bits: u32,
}

impl Packer {
    /// Adds a sample of `bits` (8 or 16, already masked); a full word comes out.
    #[inline]
    pub(super) fn push(&mut self, sample: u32, bits: u32) -> Option<u32> {
        self.word |= sample << self.bits;
        self.bits += bits;
        if self.bits < 32 {
            return None;
        }
        Some(core::mem::take(self).word)
    }

    /// The incomplete word, padded with zeros, if there is one.
    pub(super) fn flush(&mut self) -> Option<u32> {
        let packer = core::mem::take(self);
        (packer.bits > 0).then_some(packer.word)
    }

    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bits == 0
    }
}

/// Four words in order, each of which may be marked as the last of its line or frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Fifo {
    words: [u32; FIFO_WORDS],
    /// Bit n: word n (of `words`) is a last one.
    last: u8,
    head: u8,
    len: u8,
}

impl Fifo {
    pub(super) fn len(&self) -> usize {
        usize::from(self.len)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// A marked word waits: it must go to memory even if a burst is not full.
    #[inline]
    pub(super) fn holds_last(&self) -> bool {
        self.last != 0
    }

    /// Words that press for memory: those that wait, and the whole FIFO where a marked one does.
    #[inline]
    pub(super) fn pressure(&self) -> u8 {
        if self.last != 0 { FIFO_WORDS as u8 } else { self.len }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds a word; `false` if there is no room.
    #[inline]
    pub(super) fn push(&mut self, word: u32) -> bool {
        if self.len() == FIFO_WORDS {
            return false;
        }
        self.words[usize::from((self.head + self.len) % FIFO_WORDS as u8)] = word;
        self.len += 1;
        true
    }

    /// Marks the newest word as the last of its line or frame; `false` if there is none.
    pub(super) fn mark_last(&mut self) -> bool {
        if self.is_empty() {
            return false;
        }
        self.last |= 1 << ((self.head + self.len - 1) % FIFO_WORDS as u8);
        true
    }

    /// Takes the oldest word, and whether it is marked.
    #[inline]
    pub(super) fn pop(&mut self) -> Option<(u32, bool)> {
        if self.is_empty() {
            return None;
        }
        let head = self.head;
        let bit = 1 << head;
        let last = self.last & bit != 0;
        self.last &= !bit;
        self.len -= 1;
        // An empty FIFO has one representation, so that equal states compare equal.
        self.head = if self.len == 0 { 0 } else { (head + 1) % FIFO_WORDS as u8 };
        // `head` is a place; the compiler does not see that.
        let word = core::mem::take(&mut self.words[usize::from(head) % FIFO_WORDS]);
        Some((word, last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_byte_is_least_significant() {
        let mut packer = Packer::default();
        assert_eq!([1, 2, 3].map(|byte| packer.push(byte, 8)), [None; 3]);
        assert_eq!(packer.push(4, 8), Some(0x0403_0201));
        assert_eq!(packer.push(0x3FF, 16), None);
        assert_eq!(packer.flush(), Some(0x3FF));
        assert_eq!(packer.flush(), None);
    }

    #[test]
    fn fifo_keeps_order_and_marks_around_the_end() {
        let mut fifo = Fifo::default();
        for word in 0..3 {
            assert!(fifo.push(word));
        }
        assert_eq!(fifo.pop(), Some((0, false)));
        assert!(fifo.push(3) && fifo.push(4) && fifo.mark_last());
        assert!(!fifo.push(5), "four words are the limit");
        let rest: Vec<_> = core::iter::from_fn(|| fifo.pop()).collect();
        assert_eq!(rest, [(1, false), (2, false), (3, false), (4, true)]);
        assert_eq!(fifo, Fifo::default());
    }
}
