//! Stretches to an export of Saleae Logic 2.
//!
//! The levels are those of `halves`: PCLK, HSYNC, VSYNC, then the lines of the bus from D0 on.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::super::halves::{Halves, HalvesError, each};
use super::super::vcd::VcdWriterOptions;
use super::TICKS;

/// Why an export could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaleaeWriteError {
    /// The output failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// What is to be written has no levels.
    #[error(transparent)]
    Halves(#[from] HalvesError),
}

/// Writes a `digital.csv`. After an error the output is not a whole one.
#[derive(Debug)]
pub struct CsvWriter<W> {
    out: W,
    halves: Halves,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the header. Of the options, those of the layout of a VCD do not matter.
    ///
    /// # Errors
    /// If the options have no export, or the output fails.
    pub fn new(mut out: W, options: &VcdWriterOptions) -> Result<Self, SaleaeWriteError> {
        let halves = Halves::new(options)?;
        let names: Vec<String> = halves.names().collect();
        writeln!(out, "Time [s],{}", names.join(","))?;
        Ok(Self { out, halves })
    }

    fn row(&mut self, (time, levels): (u64, u32)) -> io::Result<()> {
        let second = TICKS as u64;
        write!(self.out, "{}.{:012}", time / second, time % second)?;
        let mut values = [b','; 2 * 17];
        let channels = self.halves.channels();
        for (channel, value) in values.iter_mut().skip(1).step_by(2).enumerate().take(channels) {
            *value = b'0' + (levels >> channel & 1) as u8;
        }
        self.out.write_all(&values[..2 * channels])?;
        self.out.write_all(b"\n")
    }

    /// Writes the last row, and gives the output back with the number of clocks.
    ///
    /// # Errors
    /// The output's.
    pub fn finish(mut self) -> Result<(W, u64), SaleaeWriteError> {
        self.row(self.halves.rest())?;
        self.out.flush()?;
        Ok((self.out, self.halves.clocks))
    }
}

impl<W: Write> StretchSink for CsvWriter<W> {
    type Error = SaleaeWriteError;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), SaleaeWriteError> {
        each(samples, |value| {
            let [first, second] = self.halves.clock(sync, value)?;
            self.row(first)?;
            Ok(self.row(second)?)
        })
    }
}

/// Writes binary files of version 0 to a folder. After an error they are not whole ones.
#[derive(Debug)]
pub struct BinaryWriter {
    files: Vec<(PathBuf, BufWriter<File>, u64)>,
    halves: Halves,
    before: Option<u32>,
}

/// Byte at which a file's end time stands; the number of changes is behind it.
const END: u64 = 8 + 4 + 4 + 4 + 8;

impl BinaryWriter {
    /// Makes `digital_0.bin` and so on in a folder that exists.
    ///
    /// # Errors
    /// If the options have no export, or a file cannot be made.
    pub fn new(folder: &Path, options: &VcdWriterOptions) -> Result<Self, SaleaeWriteError> {
        let halves = Halves::new(options)?;
        let mut files = Vec::new();
        for channel in 0..halves.channels() {
            let path = folder.join(format!("digital_{channel}.bin"));
            files.push((path.clone(), BufWriter::with_capacity(1 << 16, File::create_new(path)?), 0));
        }
        Ok(Self { files, halves, before: None })
    }

    /// The beginning of all files: the levels that they begin with.
    fn begin(&mut self, levels: u32) -> io::Result<()> {
        for (channel, (_, file, _)) in self.files.iter_mut().enumerate() {
            file.write_all(b"<SALEAE>")?;
            file.write_all(&[0; 8])?;
            file.write_all(&(levels >> channel & 1).to_le_bytes())?;
            // Begin, end, changes: the last two are put in when they are known.
            file.write_all(&[0; 24])?;
        }
        self.before = Some(levels);
        Ok(())
    }

    fn levels(&mut self, (time, levels): (u64, u32)) -> io::Result<()> {
        let Some(before) = self.before.replace(levels) else { return self.begin(levels) };
        let seconds = (time as f64 / TICKS).to_le_bytes();
        let mut changed = levels ^ before;
        while changed != 0 {
            if let Some((_, file, changes)) = self.files.get_mut(changed.trailing_zeros() as usize) {
                file.write_all(&seconds)?;
                *changes += 1;
            }
            changed &= changed - 1;
        }
        Ok(())
    }

    /// Completes the files; gives back the number of clocks and the bytes of all files.
    ///
    /// # Errors
    /// The files'.
    pub fn finish(mut self) -> Result<(u64, u64), SaleaeWriteError> {
        let rest = self.halves.rest();
        self.levels(rest)?;
        let mut bytes = 0;
        for (_, mut file, changes) in self.files {
            file.seek(SeekFrom::Start(END))?;
            file.write_all(&(rest.0 as f64 / TICKS).to_le_bytes())?;
            file.write_all(&changes.to_le_bytes())?;
            file.flush()?;
            bytes += file.get_ref().metadata()?.len();
        }
        Ok((self.halves.clocks, bytes))
    }
}

impl StretchSink for BinaryWriter {
    type Error = SaleaeWriteError;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), SaleaeWriteError> {
        each(samples, |value| {
            let [first, second] = self.halves.clock(sync, value)?;
            self.levels(first)?;
            Ok(self.levels(second)?)
        })
    }
}
