//! Stretches to a session file.
//!
//! ```text
//!             clock k           clock k+1          samples: `samples_per_clock` of them
//! PCLK    ____┌────┐____┌────┐____┌────            the second half of them with the clock at its active level
//! data    X         X         X                    changes half a period before it is sampled
//! ```
//!
//! Channels: the lines of the bus from D0 on, then PCLK, HSYNC and VSYNC.

use std::io::{self, Seek, Write};

use firmware::camif::pins::{Edge, Samples, Sync};
use firmware::trace::StretchSink;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Bytes of a piece, as libsigrok has it.
const PIECE: usize = 4 << 20;

/// How a session is to be written.
#[derive(Clone, Debug)]
pub struct SrWriterOptions {
    /// Width of the data bus: 8, 10, 12 or 14.
    pub bus_bits: u8,
    /// Pixel clock in hertz, not 0.
    pub pclk_hz: u32,
    /// The active edge of the pixel clock.
    pub edge: Edge,
    /// Samples a pixel clock, even, 2 to 256.
    pub samples_per_clock: u16,
}

/// Why a session could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SrWriteError {
    /// The output failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The archive cannot be written.
    #[error("{0}")]
    Archive(String),
    /// A bus of no width that there is.
    #[error("a bus of {0} bits; it must be 8, 10, 12 or 14")]
    BusBits(u8),
    /// A clock of 0 Hz has no sample rate.
    #[error(
        "the pixel clock is unknown, and a sigrok session needs a sample rate; give pclk_hz in the profile"
    )]
    NoClock,
    /// Too few or too many samples.
    #[error("{0} samples a clock; they must be an even number from 2 to 256")]
    Samples(u16),
    /// A sample does not fit the bus.
    #[error("sample 0x{value:X} at clock {clock} does not fit a bus of {bus_bits} bits")]
    Wide {
        /// Number of its clock.
        clock: u64,
        /// The sample.
        value: u16,
        /// Width of the bus.
        bus_bits: u8,
    },
}

/// Writes a session. After an error the output is not a whole one.
pub struct SrWriter<W: Write + Seek> {
    zip: ZipWriter<W>,
    options: SrWriterOptions,
    unit: usize,
    /// Samples not yet written, at most a piece and a clock of them.
    piece: Vec<u8>,
    pieces: u64,
    clocks: u64,
    idle: u32,
}

impl<W: Write + Seek> std::fmt::Debug for SrWriter<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SrWriter")
            .field("options", &self.options)
            .field("clocks", &self.clocks)
            .finish_non_exhaustive()
    }
}

fn packed() -> SimpleFileOptions {
    SimpleFileOptions::default().compression_method(CompressionMethod::Deflated)
}

impl<W: Write + Seek> SrWriter<W> {
    /// Writes version and metadata.
    ///
    /// # Errors
    /// If the options have no session, or the output fails.
    pub fn new(out: W, options: SrWriterOptions) -> Result<Self, SrWriteError> {
        let bits = options.bus_bits;
        if !matches!(bits, 8 | 10 | 12 | 14) {
            return Err(SrWriteError::BusBits(bits));
        }
        if options.pclk_hz == 0 {
            return Err(SrWriteError::NoClock);
        }
        if !(2..=256).contains(&options.samples_per_clock) || options.samples_per_clock % 2 == 1 {
            return Err(SrWriteError::Samples(options.samples_per_clock));
        }
        let probes = usize::from(bits) + 3;
        let unit = probes.div_ceil(8);
        let rate = u64::from(options.pclk_hz) * u64::from(options.samples_per_clock);
        let mut metadata = format!(
            "[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\ntotal probes={probes}\n\
             samplerate={rate} Hz\ntotal analog=0\n"
        );
        let lines = (0..bits).map(|line| format!("D{line}"));
        for (number, name) in lines.chain(["PCLK", "HSYNC", "VSYNC"].map(str::to_owned)).enumerate() {
            metadata.push_str(&format!("probe{}={name}\n", number + 1));
        }
        metadata.push_str(&format!("unitsize={unit}\n"));
        let mut zip = ZipWriter::new(out);
        for (name, text, options) in [
            ("version", "2", SimpleFileOptions::default().compression_method(CompressionMethod::Stored)),
            ("metadata", &metadata, packed()),
        ] {
            zip.start_file(name, options).map_err(archive)?;
            zip.write_all(text.as_bytes())?;
        }
        let piece = Vec::with_capacity(PIECE + 256 * unit);
        let idle = if options.edge == Edge::Falling { 1 << bits } else { 0 };
        Ok(Self { zip, options, unit, piece, pieces: 0, clocks: 0, idle })
    }

    fn clock(&mut self, sync: Sync, value: u16) -> Result<(), SrWriteError> {
        let bits = self.options.bus_bits;
        if value >> bits != 0 {
            return Err(SrWriteError::Wide { clock: self.clocks, value, bus_bits: bits });
        }
        let half = usize::from(self.options.samples_per_clock / 2);
        let levels =
            u32::from(value) | u32::from(sync.hsync) << (bits + 1) | u32::from(sync.vsync) << (bits + 2);
        for sample in [levels | self.idle, levels | self.idle ^ 1 << bits] {
            let sample = sample.to_le_bytes();
            for _ in 0..half {
                self.piece.extend_from_slice(&sample[..self.unit]);
            }
        }
        self.clocks += 1;
        if self.piece.len() >= PIECE { self.write_piece(PIECE) } else { Ok(()) }
    }

    fn write_piece(&mut self, bytes: usize) -> Result<(), SrWriteError> {
        self.pieces += 1;
        self.zip.start_file(format!("logic-1-{}", self.pieces), packed()).map_err(archive)?;
        self.zip.write_all(&self.piece[..bytes])?;
        self.piece.drain(..bytes);
        Ok(())
    }

    /// Writes what is held and the archive's directory, and gives the output back with the number of clocks.
    ///
    /// # Errors
    /// The output's.
    pub fn finish(mut self) -> Result<(W, u64), SrWriteError> {
        // One sample at least, with the clock at rest again, so that the last active level has an end.
        let mut last = [0; 4];
        let from = self.piece.len().checked_sub(self.unit);
        if let Some(sample) = from.and_then(|from| self.piece.get(from..)) {
            last[..self.unit].copy_from_slice(sample);
        }
        let rest = u32::from_le_bytes(last) & !(1 << self.options.bus_bits) | self.idle;
        self.piece.extend_from_slice(&rest.to_le_bytes()[..self.unit]);
        self.write_piece(self.piece.len())?;
        let out = self.zip.finish().map_err(archive)?;
        Ok((out, self.clocks))
    }
}

#[expect(clippy::needless_pass_by_value, reason = "what map_err hands over")]
fn archive(error: zip::result::ZipError) -> SrWriteError {
    SrWriteError::Archive(error.to_string())
}

impl<W: Write + Seek> StretchSink for SrWriter<W> {
    type Error = SrWriteError;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), SrWriteError> {
        match samples {
            Samples::Bytes(bytes) => bytes.iter().try_for_each(|&byte| self.clock(sync, u16::from(byte))),
            Samples::Words(words) => words.iter().try_for_each(|&word| self.clock(sync, word)),
            Samples::Repeat { value, clocks } => (0..clocks).try_for_each(|_| self.clock(sync, value)),
        }
    }
}
