//! Fast signal traces (FST): what GTKWave, Verilator, Icarus Verilog and others write.
//!
//! ```text
//! file      header │ value changes │ value changes … │ geometry │ hierarchy
//! changes   frame: how all signals stand │ a chain for each signal │ index of the chains │ table of times
//! chain     (times ahead, value) (times ahead, value) …                packed by itself, so that only those wanted are unpacked
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `bytes` | numbers of variable length out of bytes |
//! | `packed` | zlib, gzip, LZ4 and FastLZ, with their sizes checked first |
//! | `header` | blocks, geometry and hierarchy |
//! | `section` | a section of changes: times, frame, chains |
//! | `reader` | all of it: [`FstFile`] |
//! | `writer` | stretches to an FST: [`FstWriter`] |
//! | `error` | what can be wrong, and where |
//!
//! The crate `fst-reader` reads the same; this reader is our own because that one takes sizes out of the file on trust and panics on damaged
//! ones, which nobody outside can prevent. It is the oracle of the tests. A section is unpacked only for the wanted signals, so memory
//! depends on a section (as large as its writer made it, usually of 32 to 128 MiB of changes of all signals), not on the file.
//! Reference: GTKWave manual, appendix "FST", and `fstapi.c` of GTKWave 3.3.

mod bytes;
mod packed;
mod header;
mod section;
mod reader;
mod writer;
mod error;

pub use error::{FstError, FstProblem};
pub use reader::FstFile;
pub use writer::{FstWriteError, FstWriter};

/// The beginning of a file is that of an FST: a header block of its one length, or a wrapper.
pub(super) fn is_fst(head: &[u8]) -> bool {
    head.starts_with(&[0, 0, 0, 0, 0, 0, 0, 1, 0x49]) || head.first() == Some(&254)
}
