//! sigrok session files (`.sr`) of version 2: what sigrok-cli, PulseView and many analysers' own programs write.
//!
//! ```text
//! ZIP archive     version      "2"
//!                 metadata     INI text: [device 1] samplerate=96 MHz, probe1=PCLK, unitsize=2 …
//!                 logic-1-1    samples, little-endian, unitsize bytes each, bit i is channel i
//!                 logic-1-2    … in pieces that are to be ordered by number and may break a sample
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `archive` | the archive, checked before anything is inflated |
//! | `metadata` | the INI text |
//! | `gather` | from the bits of a sample to those of a state |
//! | `scan` | which of many samples differ from the one before |
//! | `reader` | all of it: [`SrFile`] |
//! | `writer` | stretches to a file: [`SrWriter`] |
//! | `error` | what can be wrong, and where |
//!
//! Nothing is ever unpacked to a disk, so names in the archive lead nowhere; those that look as if they were meant to are refused all the same. Memory does not depend
//! on what the archive says of its sizes: pieces are inflated a block at a time. Format: sigrok wiki, "File format:Sigrok/v2".

mod archive;
mod metadata;
mod gather;
mod scan;
mod reader;
mod writer;
mod error;

pub(super) use metadata::size;

pub use error::{MetadataProblem, SrError};
pub use reader::SrFile;
pub use writer::{SrWriteError, SrWriter, SrWriterOptions};
