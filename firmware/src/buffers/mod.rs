//! Who holds which buffer: the books of frame buffers and line buffers, apart from the memory itself.
//!
//! | module | what lives there |
//! |---|---|
//! | [`pool`] | frame buffers: `Free → Filling → Ready → Leased` |
//! | [`ring`] | line buffers and the ends of frames between them, in order |
//!
//! The memory stays with the DMA until it is leased; a buffer's number here is its slot there. All calls take a time that
//! depends on the number of buffers only.

pub mod pool;
pub mod ring;
