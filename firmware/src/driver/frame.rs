//! A captured frame, leased from its camera.

use core::fmt;
use core::ops::Deref;

use crc::{CRC_32_ISO_HDLC, Crc};

use super::frame_camera::FrameCamera;
use super::verdict::Verdict;
use crate::port::Port;

/// The IEEE CRC-32, as in Ethernet, zip and PNG.
static CRC32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// CRC-32 (IEEE) of some bytes.
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    CRC32.checksum(bytes)
}

/// A frame in its buffer; reads as bytes. Dropping it gives the buffer back, and wakes a capture that waits for one.
pub struct Frame<'c, 'm, P: Port<'m>, const N: usize> {
    camera: &'c FrameCamera<'m, P, N>,
    memory: Option<&'m mut [u32]>,
    slot: usize,
    /// Bytes of the frame that are in memory.
    length: usize,
    verdict: Verdict,
}

impl<'c, 'm, P: Port<'m>, const N: usize> Frame<'c, 'm, P, N> {
    pub(super) fn new(
        camera: &'c FrameCamera<'m, P, N>,
        memory: &'m mut [u32],
        slot: usize,
        length: usize,
        verdict: Verdict,
    ) -> Self {
        Self { camera, memory: Some(memory), slot, length, verdict }
    }

    /// What is known of the frame.
    #[must_use]
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Its bytes as the DMA wrote them. An incomplete word at a frame's end does not reach memory, and of a frame that is
    /// too long no more is kept than the buffer holds.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.words()).get(..self.length).unwrap_or(&[])
    }

    /// The words that hold the bytes.
    #[must_use]
    pub fn words(&self) -> &[u32] {
        self.memory.as_deref().and_then(|memory| memory.get(..self.length.div_ceil(4))).unwrap_or(&[])
    }

    /// All of the buffer, to work in.
    pub fn words_mut(&mut self) -> &mut [u32] {
        self.memory.as_deref_mut().unwrap_or_default()
    }

    /// CRC-32 (IEEE) of the bytes.
    #[must_use]
    pub fn crc32(&self) -> u32 {
        crc32(self.bytes())
    }
}

impl<'m, P: Port<'m>, const N: usize> Deref for Frame<'_, 'm, P, N> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.bytes()
    }
}

impl<'m, P: Port<'m>, const N: usize> fmt::Debug for Frame<'_, 'm, P, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Frame")
            .field("slot", &self.slot)
            .field("verdict", &self.verdict)
            .finish_non_exhaustive()
    }
}

impl<'m, P: Port<'m>, const N: usize> Drop for Frame<'_, 'm, P, N> {
    fn drop(&mut self) {
        if let Some(memory) = self.memory.take() {
            self.camera.give_back(self.slot, memory);
        }
    }
}
