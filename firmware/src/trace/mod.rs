//! Recorded pins: the `.camt` trace, read and written as a stream with 4 KiB of lent memory.
//!
//! A *stretch* is a run of pixel clocks during which the sync wires do not change. A trace is a header, the text of
//! the profile it was made with, and stretches:
//!
//! ```text
//! file   header │ PROFILE… │ DATA DATA DATA │ INDEX │ DATA … │ INDEX │ END
//! chunk  type, flags, length │ payload │ CRC-32          at most 4,096 bytes
//! record vsync hsync kind clocks │ sample(s)             literal or repeated
//! ```
//!
//! The map, from the bytes up:
//!
//! | module | what lives there |
//! |---|---|
//! | [`checksum`] | CRC-32, small for a microcontroller; a host brings its own fast one |
//! | [`layout`] | header, chunks, totals: what stands where in the file |
//! | [`record`] | one stretch as bytes, and back |
//! | [`error`] | what can be wrong with a file, and where |
//! | [`reader`] | bytes to stretches, every chunk verified before anything in it is delivered |
//! | [`seek`] | jumps to a frame by the index |
//! | [`writer`] | stretches to bytes, with the index |
//!
//! The format is specified in `docs/camt-format.md`.

pub mod checksum;
pub mod layout;
pub mod record;
pub mod error;
pub mod reader;
pub mod seek;
pub mod writer;

pub use error::{Error, Problem};
pub use layout::{ChunkBuffer, Header, Totals};
pub use reader::{Item, PlayError, Reader};
pub use writer::{WriteError, Writer};

use crate::camif::pins::{Samples, Sync};

/// Takes stretches in the order of time: what a trace is played into.
pub trait StretchSink {
    /// Why the sink wants no more.
    type Error;

    /// The next pixel clocks, all with the same sync levels. One level may come in several stretches; an empty
    /// stretch means nothing. The samples are the sink's only for the length of the call.
    ///
    /// # Errors
    /// Whatever the sink has; the player stops and hands it on.
    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Self::Error>;
}

impl<S: StretchSink + ?Sized> StretchSink for &mut S {
    type Error = S::Error;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Self::Error> {
        (**self).stretch(sync, samples)
    }
}

#[cfg(test)]
mod tests;
