//! Stretches to an export of Saleae Logic 2.
//!
//! ```text
//!             t(2k)      t(2k+1)     t(2k+2)         t(n) = n half periods, to the picosecond
//! PCLK    ────┐          ┌───────────┐
//!             └──────────┘           └────
//! data        ╳ changes here         ╳
//! ```
//!
//! Channels: PCLK, HSYNC, VSYNC, then the lines of the bus from D0 on.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use firmware::camif::pins::{Edge, Samples, Sync};
use firmware::trace::StretchSink;

use super::super::vcd::{Ticks, VcdWriterOptions};
use super::TICKS;

/// Channels before the lines of the bus.
const NAMES: [&str; 3] = ["PCLK", "HSYNC", "VSYNC"];

/// Why an export could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaleaeWriteError {
    /// The output failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A bus of no width that there is.
    #[error("a bus of {0} bits; it must be 8, 10, 12 or 14")]
    BusBits(u8),
    /// A clock of 0 Hz has no times.
    #[error("the pixel clock is unknown, and an export needs times; give pclk_hz in the profile")]
    NoClock,
    /// A sample does not fit the bus.
    #[error("sample 0x{value:X} at clock {clock} does not fit a bus of {bus_bits} bits")]
    Sample {
        /// Number of its clock.
        clock: u64,
        /// The sample.
        value: u16,
        /// Width of the bus.
        bus_bits: u8,
    },
}

/// Pixel clocks as levels of all channels, twice a clock.
#[derive(Debug)]
struct Halves {
    bus_bits: u8,
    idle: u32,
    ticks: Ticks,
    clocks: u64,
    last: u32,
}

impl Halves {
    fn new(options: &VcdWriterOptions) -> Result<Self, SaleaeWriteError> {
        if !matches!(options.bus_bits, 8 | 10 | 12 | 14) {
            return Err(SaleaeWriteError::BusBits(options.bus_bits));
        }
        if options.pclk_hz == 0 {
            return Err(SaleaeWriteError::NoClock);
        }
        let idle = u32::from(options.edge == Edge::Falling);
        let ticks = Ticks::in_picoseconds(options.pclk_hz);
        Ok(Self { bus_bits: options.bus_bits, idle, ticks, clocks: 0, last: idle })
    }

    fn channels(&self) -> usize {
        NAMES.len() + usize::from(self.bus_bits)
    }

    fn names(&self) -> impl Iterator<Item = String> {
        NAMES.map(str::to_owned).into_iter().chain((0..self.bus_bits).map(|line| format!("D{line}")))
    }

    /// Both halves of a clock: when, and the levels of all channels, the first one in bit 0.
    fn clock(&mut self, sync: Sync, value: u16) -> Result<[(u64, u32); 2], SaleaeWriteError> {
        let bus_bits = self.bus_bits;
        if value >> bus_bits != 0 {
            return Err(SaleaeWriteError::Sample { clock: self.clocks, value, bus_bits });
        }
        self.clocks += 1;
        let levels =
            u32::from(value) << NAMES.len() | u32::from(sync.vsync) << 2 | u32::from(sync.hsync) << 1;
        self.last = levels | self.idle;
        let first = (self.ticks.now, self.last);
        self.ticks.advance();
        let second = (self.ticks.now, self.last ^ 1);
        self.ticks.advance();
        Ok([first, second])
    }

    /// The clock at rest again, behind the last one.
    fn rest(&self) -> (u64, u32) {
        (self.ticks.now, self.last)
    }
}

/// Plays samples into `each`.
fn each<E>(samples: Samples<'_>, mut each: impl FnMut(u16) -> Result<(), E>) -> Result<(), E> {
    match samples {
        Samples::Bytes(bytes) => bytes.iter().try_for_each(|&byte| each(u16::from(byte))),
        Samples::Words(words) => words.iter().try_for_each(|&word| each(word)),
        Samples::Repeat { value, clocks } => (0..clocks).try_for_each(|_| each(value)),
    }
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
