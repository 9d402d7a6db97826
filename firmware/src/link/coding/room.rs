/// Lent memory that fills from the front; `None` where it is full.
#[derive(Debug)]
pub(super) struct Room<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl<'a> Room<'a> {
    pub(super) fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Bytes in it.
    pub(super) fn length(&self) -> usize {
        self.at
    }

    /// The next `count` bytes, to be filled.
    pub(super) fn take(&mut self, count: usize) -> Option<&mut [u8]> {
        let start = self.at;
        let end = start.checked_add(count)?;
        let taken = self.bytes.get_mut(start..end)?;
        self.at = end;
        Some(taken)
    }

    pub(super) fn put(&mut self, bytes: &[u8]) -> Option<()> {
        self.take(bytes.len())?.copy_from_slice(bytes);
        Some(())
    }

    pub(super) fn byte(&mut self, byte: u8) -> Option<()> {
        *self.bytes.get_mut(self.at)? = byte;
        self.at += 1;
        Some(())
    }
}
