//! What can go wrong with a trace file: which file, where in it, and what to do.

use std::io;
use std::path::PathBuf;

use super::clock::ClockError;
use super::fst::{FstError, FstWriteError};
use super::saleae::{SaleaeError, SaleaeWriteError};
use super::sr::{SrError, SrWriteError};
use super::vcd::{VcdError, VcdWriteError};
use super::wiring::WiringError;

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
        "{}: neither a .camt trace (begins with CAMT) nor a value change dump (a $ keyword), a sigrok session (ZIP), \
         a Saleae export (Time [s], … or <SALEAE>) or an FST; give a trace, or use --image for a picture",
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
    /// A sigrok session is damaged.
    #[error("{}: {error}", .path.display())]
    Sr {
        /// The file.
        path: PathBuf,
        /// What and where.
        error: SrError,
    },
    /// An export of Saleae Logic 2 is damaged.
    #[error("{}: {error}", .path.display())]
    Saleae {
        /// The file or folder.
        path: PathBuf,
        /// What and where.
        error: SaleaeError,
    },
    /// An FST is damaged.
    #[error("{}: {error}", .path.display())]
    Fst {
        /// The file.
        path: PathBuf,
        /// What and where.
        error: FstError,
    },
    /// The wires are not found among the signals.
    #[error("{}: {error}", .path.display())]
    Wiring {
        /// The file.
        path: PathBuf,
        /// Which, and what there is.
        error: WiringError,
    },
    /// The clock cannot be recovered.
    #[error("{}: {error}", .path.display())]
    Clock {
        /// The file.
        path: PathBuf,
        /// Why.
        error: ClockError,
    },
    /// Channels that there are not, or too many.
    #[error("{}: the file has channels 0 to {}; ask for at most 63 of them at a time", .path.display(), .has.saturating_sub(1))]
    Channels {
        /// The file.
        path: PathBuf,
        /// Channels that it has.
        has: usize,
    },
    /// The trace has no such frame, or no index to find it by.
    #[error("{}: it has no index to jump to frame {mark}; convert it to .camt first", .path.display())]
    NoIndex {
        /// The file.
        path: PathBuf,
        /// The mark asked for.
        mark: u64,
    },
    /// The name says no format.
    #[error("{}: a trace to be written must end in .camt, .vcd, .sr, .fst, .csv, or .saleae for a folder of binary files", .path.display())]
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
    /// A sigrok session cannot be written.
    #[error("{}: {error}", .path.display())]
    WriteSr {
        /// The file.
        path: PathBuf,
        /// What.
        error: SrWriteError,
    },
    /// An FST cannot be written.
    #[error("{}: {error}", .path.display())]
    WriteFst {
        /// The file.
        path: PathBuf,
        /// What.
        error: FstWriteError,
    },
    /// A Saleae export cannot be written.
    #[error("{}: {error}", .path.display())]
    WriteSaleae {
        /// The file or folder.
        path: PathBuf,
        /// What.
        error: SaleaeWriteError,
    },
}
