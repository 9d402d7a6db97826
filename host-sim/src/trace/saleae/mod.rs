//! Raw data exported from Saleae Logic 2: `digital.csv`, and the binary files of versions 0 and 1.
//!
//! ```text
//! digital.csv        Time [s],PCLK,HREF,D0          a row whenever a channel changes; X where nothing was recorded
//!                    0.000000000,0,1,0
//! digital_0.bin      <SALEAE> version type          a file a channel, in one folder: the times at which it changes
//!                    version 0: initial begin end count times…
//!                    version 1: chunks { initial rate begin end count times… }…
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `csv` | the text: [`CsvExport`] |
//! | `channel` | one binary file as a row of changes |
//! | `binary` | the files of a folder merged in time: [`BinaryExport`] |
//! | `writer` | stretches to either: [`CsvWriter`], [`BinaryWriter`] |
//! | `error` | what can be wrong, and where |
//!
//! Times are counted in picoseconds from the beginning of the capture. A binary file has no name for its channel but its
//! own, `digital_0`; `--map PCLK=CH0` finds it. Reference: Saleae's support articles "Binary Export Format – Logic 2" and "Binary and CSV
//! Export Formats – Logic 2 – 2025 Update".

mod csv;
mod channel;
mod binary;
mod writer;
mod error;

pub use binary::BinaryExport;
pub use csv::CsvExport;
pub use error::{SaleaeError, SaleaeProblem};
pub use writer::{BinaryWriter, CsvWriter, SaleaeWriteError};

use std::path::{Path, PathBuf};

use super::open::Format;

/// Units of time a second.
const TICKS: f64 = 1e12;

/// What a folder holds: the file or folder to be opened, and its format. A `digital.csv`, which has the channels' names, wins.
pub(super) fn in_folder(folder: &Path) -> Result<(PathBuf, Format), SaleaeError> {
    let text = folder.join("digital.csv");
    if text.is_file() {
        return Ok((text, Format::SaleaeCsv));
    }
    if binary::files(folder)?.is_empty() {
        return Err(SaleaeError::EmptyFolder);
    }
    Ok((folder.to_owned(), Format::SaleaeBinary))
}

/// The beginning of a text is that of a `digital.csv`.
pub(super) fn is_csv(head: &[u8]) -> bool {
    let line = head.split(|&byte| byte == b'\n').next().unwrap_or_default().to_ascii_lowercase();
    line.starts_with(b"time") && line.contains(&b',')
}

/// The changes of one binary file in memory, for tests.
#[cfg(test)]
pub(super) fn changes_of_one(bytes: &[u8]) -> Result<super::levels::Levels, SaleaeError> {
    let mut channel = channel::Channel::new(Path::new("digital_0.bin"), bytes, bytes.len() as u64)?;
    let mut levels = super::levels::Levels::at_most(usize::MAX);
    while let Some(change) = channel.next()? {
        levels.times.push(((change.seconds + 1e7) * 1e3) as u64);
        levels.states.push(u64::from(change.high));
    }
    Ok(levels)
}
