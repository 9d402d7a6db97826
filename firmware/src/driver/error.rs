//! Why capture does not start.

use core::fmt;

use super::lint::Finding;
use crate::port::DmaError;

/// Why capture does not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StartError {
    /// The linter forbids this configuration on this part.
    Refused(Finding),
    /// A buffer is too small.
    BufferTooSmall {
        /// The buffer, by its place in the array.
        buffer: usize,
        /// Words needed. More than a frame where equal transfers do not fill it.
        needed: u64,
        /// Words that it has.
        words: u32,
    },
    /// The DMA was already lent memory in this slot.
    SlotTaken {
        /// The slot.
        slot: usize,
    },
    /// The DMA refused.
    Dma(DmaError),
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(finding) => write!(f, "{finding}"),
            Self::BufferTooSmall { buffer, needed, words } => {
                write!(
                    f,
                    "buffer {buffer} has {words} words and {needed} are needed; make it larger, or crop"
                )
            }
            Self::SlotTaken { slot } => {
                write!(f, "the DMA already holds memory in slot {slot}; take it back before making a camera")
            }
            Self::Dma(error) => write!(f, "the DMA refused to start: {error}"),
        }
    }
}

impl core::error::Error for StartError {}

impl From<DmaError> for StartError {
    fn from(error: DmaError) -> Self {
        Self::Dma(error)
    }
}
