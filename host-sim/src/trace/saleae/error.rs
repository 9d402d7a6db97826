//! What can be wrong with an export of Saleae Logic 2.

use std::io;
use std::path::PathBuf;

/// Why an export could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaleaeError {
    /// The file could not be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A folder with neither form of an export.
    #[error(
        "a folder without digital.csv or digital_0.bin …; give a trace file, or the folder of a raw data export of Logic 2"
    )]
    EmptyFolder,
    /// More files than any analyser has channels.
    #[error("{0} binary files; an export has at most 63 channels: give a folder with those of the camera")]
    TooManyFiles(usize),
    /// The text is wrong.
    #[error("line {line}: {problem}")]
    Text {
        /// From 1.
        line: u64,
        /// What.
        problem: SaleaeProblem,
    },
    /// A binary file is wrong.
    #[error("{}: byte {offset}: {problem}", .file.display())]
    Binary {
        /// Which of the files.
        file: PathBuf,
        /// From 0.
        offset: u64,
        /// What.
        problem: SaleaeProblem,
    },
}

/// What is wrong with an export.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SaleaeProblem {
    /// The first line is no header.
    #[error("not the header of a digital.csv, which begins with `Time [s],`")]
    Header,
    /// More channels than fit, or none.
    #[error("{0} channels; an export has 1 to 512")]
    Channels(usize),
    /// A line longer than any row.
    #[error("a line of more than 64 KiB; this is not a digital.csv")]
    LongLine,
    /// A row with another number of values.
    #[error(
        "{found} values where the header has {expected} channels; the file has been cut short or damaged: export it again"
    )]
    Columns {
        /// In this row.
        found: usize,
        /// In the header.
        expected: usize,
    },
    /// A value that is no level.
    #[error("`{0}` is no level (0, 1 or X); export digital channels only")]
    Level(String),
    /// A time that cannot be understood.
    #[error("`{0}` is neither seconds nor an ISO 8601 time")]
    Time(String),
    /// Time runs backwards.
    #[error("time {0} comes after a later one; the file is damaged or two are joined")]
    Backwards(String),
    /// Not a file of Logic 2 at all.
    #[error("not a binary export of Logic 2, which begins with <SALEAE>")]
    Magic,
    /// Another version.
    #[error("version {0} of the binary export; versions 0 and 1 are read: export as CSV instead")]
    Version(i32),
    /// An analog channel.
    #[error("an analog channel (type {0}); export the digital channels")]
    Type(i32),
    /// The file ends early.
    #[error("the file ends where {0} more bytes should be; it has been cut short: export it again")]
    Short(u64),
    /// A level that is neither.
    #[error("initial state {0} is neither 0 nor 1; the file is damaged")]
    Initial(u32),
    /// Bytes behind the last chunk.
    #[error("{0} bytes behind the last change; the file is damaged or two are joined")]
    Behind(u64),
}
