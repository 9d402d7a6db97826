//! Lent words, cut into typed pieces.

use algos_nostd::image::{Error, Rgb};

use super::settings::bytes;

/// What is left of the memory that was lent.
pub(super) struct Memory<'m> {
    rest: &'m mut [u32],
}

impl<'m> Memory<'m> {
    pub(super) fn new(words: &'m mut [u32]) -> Self {
        Self { rest: words }
    }

    /// So many words.
    pub(super) fn words(&mut self, length: usize) -> Result<&'m mut [u32], Error> {
        let got = self.rest.len();
        match core::mem::take(&mut self.rest).split_at_mut_checked(length) {
            Some((words, rest)) => {
                self.rest = rest;
                Ok(words)
            }
            None => Err(Error::BufferLength { name: "memory", expected: length, got }),
        }
    }

    /// So many bytes.
    pub(super) fn bytes(&mut self, length: usize) -> Result<&'m mut [u8], Error> {
        let words = self.words(bytes(length))?;
        let whole: &mut [u8] = bytemuck::try_cast_slice_mut(words).unwrap_or_default();
        let got = whole.len();
        whole.get_mut(..length).ok_or(Error::BufferLength { name: "memory", expected: length, got })
    }

    /// So many pixels.
    pub(super) fn pixels(&mut self, length: usize) -> Result<&'m mut [Rgb], Error> {
        let whole = self.bytes(length.saturating_mul(3))?;
        let got = whole.len();
        let refused = Error::BufferLength { name: "memory", expected: length, got };
        bytemuck::try_cast_slice_mut(whole).map_err(|_| refused)
    }
}
