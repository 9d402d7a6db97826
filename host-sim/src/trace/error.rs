//! What can go wrong with a trace file: which file, where in it, and what to do.

use std::io;
use std::path::PathBuf;

use super::vcd::{VcdError, VcdWriteError};

/// Why a trace could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// The file cannot be opened or read.
    #[error("{}: {error}", .path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// The file is none of the formats.
    #[error(
        "{}: neither a .camt trace (begins with CAMT) nor a value change dump (begins with a $ keyword); \
         give a trace, or use --image for a picture",
        .path.display()
    )]
    Unknown {
        /// The file.
        path: PathBuf,
    },
    /// A `.camt` file is damaged.
    #[error("{}: {error}", .path.display())]
    Camt {
        /// The file.
        path: PathBuf,
        /// What and where.
        error: firmware::trace::Error<io::Error>,
    },
    /// A VCD is damaged, or its wires are not found.
    #[error("{}: {error}", .path.display())]
    Vcd {
        /// The file.
        path: PathBuf,
        /// What and where.
        error: VcdError,
    },
    /// The trace has no such frame, or no index to find it by.
    #[error("{}: a VCD has no index to jump to frame {mark}; convert it to .camt first", .path.display())]
    NoIndex {
        /// The file.
        path: PathBuf,
        /// The mark asked for.
        mark: u64,
    },
    /// The name says no format.
    #[error("{}: a trace to be written must end in .camt or .vcd", .path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be made.
    #[error("{}: cannot be written: {error}", .path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A `.camt` file cannot be written.
    #[error("{}: {error}", .path.display())]
    WriteCamt {
        /// The file.
        path: PathBuf,
        /// What.
        error: firmware::trace::WriteError<io::Error>,
    },
    /// A VCD cannot be written.
    #[error("{}: {error}", .path.display())]
    WriteVcd {
        /// The file.
        path: PathBuf,
        /// What.
        error: VcdWriteError,
    },
}
