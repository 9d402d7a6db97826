//! The seams between the driver and a camera interface: its registers, and the DMA that empties its FIFO.
//!
//! The model implements them (`camif`), and so does each board over its own registers. The DMA owns what it is lent:
//! `lend` moves a buffer in, `take_back` moves it out, and nobody else can touch it between the two.

pub use crate::camif::Part;
pub use crate::camif::registers::{Burst, DmaMode, Register, Registers};

/// Buffers that can be lent to the DMA at one time.
pub const SLOTS: usize = 8;

/// One of the two places that a double-buffered DMA fills in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Filled first.
    Zero,
    /// Filled second.
    One,
}

impl Target {
    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Zero => Self::One,
            Self::One => Self::Zero,
        }
    }
}

/// How the DMA is to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transfer {
    /// Words a transfer.
    pub words: u32,
    /// What follows a transfer.
    pub mode: DmaMode,
    /// Words a burst.
    pub burst: Burst,
    /// A transfer is a line; see [`Part::line_by_line`].
    pub line_by_line: bool,
    /// Interrupt at half of a transfer as well as at its end and on an error.
    pub half_interrupt: bool,
}

/// What has happened in the DMA since it was last [acknowledged](Dma::acknowledge).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DmaEvents {
    /// Half of a transfer is done.
    pub half: bool,
    /// A transfer is done.
    pub complete: bool,
    /// The DMA met an error and stopped.
    pub error: bool,
    /// Words of the line that completed last (line by line only).
    pub line_words: u32,
}

/// Why the DMA did not do as told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DmaError {
    /// No buffer is lent in this slot.
    NotLent {
        /// The slot.
        slot: usize,
    },
    /// The transfer reaches past the end of the lent buffer.
    OutOfBounds {
        /// The slot.
        slot: usize,
        /// Words from the start of the buffer to the end of the transfer.
        needed: usize,
        /// Words lent.
        lent: usize,
    },
    /// A transfer of more words than the part can count, or of none.
    TransferLength {
        /// Words asked for.
        words: u32,
        /// Most that the part can count.
        limit: u32,
    },
    /// The part can't do this.
    Unsupported {
        /// What was asked for.
        what: &'static str,
    },
}

impl core::fmt::Display for DmaError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::NotLent { slot } => write!(f, "no buffer is lent to the DMA in slot {slot}"),
            Self::OutOfBounds { slot, needed, lent } => {
                write!(f, "the transfer needs {needed} words of slot {slot}, which holds {lent}")
            }
            Self::TransferLength { words, limit } => {
                write!(f, "a transfer of {words} words; the part takes 1 to {limit}")
            }
            Self::Unsupported { what } => write!(f, "the part's DMA has no {what}"),
        }
    }
}

impl core::error::Error for DmaError {}

/// A DMA channel that empties the FIFO of the camera interface into lent memory.
pub trait Dma<'m> {
    /// Hands `memory` over. It is the DMA's until [`Dma::take_back`].
    ///
    /// # Errors
    /// The memory itself, if the slot is not free or does not exist.
    fn lend(&mut self, slot: usize, memory: &'m mut [u32]) -> Result<(), &'m mut [u32]>;

    /// Gives memory back, with all that was written to it.
    ///
    /// `None` if nothing is lent in the slot, or if the DMA runs and either target aims at it: aim elsewhere, or stop,
    /// first.
    fn take_back(&mut self, slot: usize) -> Option<&'m mut [u32]>;

    /// Points a target at word `start` of the buffer in `slot`. While the DMA runs only the target that is not in use
    /// may be moved.
    ///
    /// # Errors
    /// [`DmaError::NotLent`], or [`DmaError::OutOfBounds`] for a start past the end.
    fn aim(&mut self, target: Target, slot: usize, start: usize) -> Result<(), DmaError>;

    /// Starts at target 0 with cleared events.
    ///
    /// # Errors
    /// Whatever the part can't do, and a target whose transfer does not fit its buffer.
    fn start(&mut self, transfer: Transfer) -> Result<(), DmaError>;

    /// Stops at once; what was moved so far stays in memory.
    fn stop(&mut self);

    /// What has happened since it was last acknowledged.
    fn events(&mut self) -> DmaEvents;

    /// Clears the given flags.
    fn acknowledge(&mut self, events: DmaEvents);

    /// The target in use.
    fn target(&mut self) -> Target;

    /// Words that are left of the transfer in progress.
    fn remaining(&mut self) -> u32;
}

/// All that the driver needs of a camera interface.
pub trait Port<'m>: Registers + Dma<'m> {
    /// What it can do.
    fn part(&self) -> Part;
}
