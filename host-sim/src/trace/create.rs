//! A trace file to be written.
//!
//! The format is told by the name's end. The file is written under a temporary name in the same folder and renamed when it is
//! whole, so that what stands under the name is always a whole trace; a writer that is dropped leaves nothing.

use std::ffi::OsStr;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::{ChunkBuffer, Header, StretchSink, Writer};
use tempfile::{NamedTempFile, TempDir};

use super::camt::{StdIo, fast_crc32};
use super::error::TraceError;
use super::fst::FstWriter;
use super::saleae::{BinaryWriter, CsvWriter};
use super::sr::{SrWriter, SrWriterOptions};
use super::vcd::{VcdWriter, VcdWriterOptions};

/// Samples a pixel clock in a session of sigrok.
const SAMPLES_PER_CLOCK: u16 = 8;

/// What a trace to be written is to say of itself.
#[derive(Clone, Debug)]
pub struct TraceWriterOptions {
    /// Bus, clock, and how a VCD is laid out.
    pub vcd: VcdWriterOptions,
    /// VSYNC's active (blanking) level: a `.camt` marks frames where VSYNC goes to it.
    pub vsync_active: bool,
    /// TOML text of the profile; a `.camt` carries it.
    pub profile: String,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Created {
    /// Where.
    pub path: PathBuf,
    /// Pixel clocks.
    pub clocks: u64,
    /// Bytes of the file.
    pub bytes: u64,
}

type Output = BufWriter<NamedTempFile>;

/// Takes stretches and writes them to a file.
#[derive(Debug)]
pub struct TraceWriter {
    path: PathBuf,
    inner: Inner,
}

#[derive(Debug)]
enum Inner {
    Camt(Box<Writer<StdIo<Output>, Box<ChunkBuffer>>>),
    Vcd(Box<VcdWriter<Output>>),
    Sr(Box<SrWriter<Output>>),
    Fst(Box<FstWriter<Output>>),
    Csv(Box<CsvWriter<Output>>),
    Binary(Box<BinaryWriter>, TempDir),
}

/// Begins a trace file. Its name ends in `.camt`, `.vcd`, `.sr` (8 samples a clock), `.fst`, `.csv` (as Saleae's `digital.csv`) or
/// `.saleae` (a folder of Saleae's binary files, which must not exist or be empty).
///
/// # Errors
/// If the name ends otherwise, the folder cannot be written, or the options have no place in the format.
pub fn create(path: impl AsRef<Path>, options: &TraceWriterOptions) -> Result<TraceWriter, TraceError> {
    let path = path.as_ref().to_owned();
    let extension = path.extension().map(OsStr::to_ascii_lowercase);
    let extension = extension.as_ref().and_then(|extension| extension.to_str()).unwrap_or_default();
    let failed = |error| TraceError::Create { path: path.clone(), error };
    let saleae = |error| TraceError::WriteSaleae { path: path.clone(), error };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let output = || Ok(BufWriter::with_capacity(1 << 18, temporary(folder).map_err(failed)?));
    let vcd = &options.vcd;
    let inner = match extension {
        "camt" => {
            let header =
                Header { bus_bits: vcd.bus_bits, vsync_active: options.vsync_active, pclk_hz: vcd.pclk_hz };
            let buffer = Box::new(ChunkBuffer::new());
            let writer =
                Writer::with_checksum(StdIo(output()?), header, &options.profile, buffer, fast_crc32);
            let writer = writer.map_err(|error| TraceError::WriteCamt { path: path.clone(), error })?;
            Inner::Camt(Box::new(writer))
        }
        "vcd" => {
            let writer = VcdWriter::new(output()?, vcd.clone());
            Inner::Vcd(Box::new(writer.map_err(|error| TraceError::WriteVcd { path: path.clone(), error })?))
        }
        "sr" => {
            let session = SrWriterOptions {
                bus_bits: vcd.bus_bits,
                pclk_hz: vcd.pclk_hz,
                edge: vcd.edge,
                samples_per_clock: SAMPLES_PER_CLOCK,
            };
            let writer = SrWriter::new(output()?, session);
            Inner::Sr(Box::new(writer.map_err(|error| TraceError::WriteSr { path: path.clone(), error })?))
        }
        "fst" => {
            let writer = FstWriter::new(output()?, vcd);
            Inner::Fst(Box::new(writer.map_err(|error| TraceError::WriteFst { path: path.clone(), error })?))
        }
        "csv" => Inner::Csv(Box::new(CsvWriter::new(output()?, vcd).map_err(saleae)?)),
        "saleae" => {
            let files = tempfile::Builder::new().prefix(".trace-").tempdir_in(folder).map_err(failed)?;
            let writer = BinaryWriter::new(files.path(), vcd).map_err(saleae)?;
            Inner::Binary(Box::new(writer), files)
        }
        _ => return Err(TraceError::Extension { path }),
    };
    Ok(TraceWriter { path, inner })
}

/// A file that vanishes unless it is renamed, with the permissions of any new file.
fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".trace-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Gives a folder of files its name, which may be that of an empty folder.
fn place(files: TempDir, path: &Path) -> io::Result<()> {
    #[cfg(unix)]
    std::fs::set_permissions(files.path(), std::os::unix::fs::PermissionsExt::from_mode(0o755))?;
    std::fs::rename(files.path(), path)?;
    // The temporary name is gone.
    let _ = files.keep();
    Ok(())
}

impl TraceWriter {
    /// Completes the file and gives it its name; a file of that name is replaced.
    ///
    /// # Errors
    /// If it cannot be written or renamed; then it is removed.
    pub fn finish(self) -> Result<Created, TraceError> {
        let path = self.path;
        let (output, clocks) = match self.inner {
            Inner::Camt(writer) => match writer.finish() {
                Ok((output, totals)) => (output.0, totals.clocks),
                Err(error) => return Err(TraceError::WriteCamt { path, error }),
            },
            Inner::Vcd(writer) => match writer.finish() {
                Ok((output, clocks)) => (output, clocks),
                Err(error) => return Err(TraceError::WriteVcd { path, error }),
            },
            Inner::Sr(writer) => match writer.finish() {
                Ok((output, clocks)) => (output, clocks),
                Err(error) => return Err(TraceError::WriteSr { path, error }),
            },
            Inner::Fst(writer) => match writer.finish() {
                Ok((output, clocks)) => (output, clocks),
                Err(error) => return Err(TraceError::WriteFst { path, error }),
            },
            Inner::Csv(writer) => match writer.finish() {
                Ok((output, clocks)) => (output, clocks),
                Err(error) => return Err(TraceError::WriteSaleae { path, error }),
            },
            Inner::Binary(writer, files) => {
                let (clocks, bytes) = match writer.finish() {
                    Ok(totals) => totals,
                    Err(error) => return Err(TraceError::WriteSaleae { path, error }),
                };
                return match place(files, &path) {
                    Ok(()) => Ok(Created { path, clocks, bytes }),
                    Err(error) => Err(TraceError::Create { path, error }),
                };
            }
        };
        let renamed = output.into_inner().map_err(io::IntoInnerError::into_error).and_then(|file| {
            let bytes = file.as_file().metadata()?.len();
            file.persist(&path).map_err(|failed| failed.error)?;
            Ok(bytes)
        });
        match renamed {
            Ok(bytes) => Ok(Created { path, clocks, bytes }),
            Err(error) => Err(TraceError::Create { path, error }),
        }
    }
}

impl StretchSink for TraceWriter {
    type Error = TraceError;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), TraceError> {
        match &mut self.inner {
            Inner::Camt(writer) => writer
                .stretch(sync, samples)
                .map_err(|error| TraceError::WriteCamt { path: self.path.clone(), error }),
            Inner::Vcd(writer) => writer
                .stretch(sync, samples)
                .map_err(|error| TraceError::WriteVcd { path: self.path.clone(), error }),
            Inner::Sr(writer) => writer
                .stretch(sync, samples)
                .map_err(|error| TraceError::WriteSr { path: self.path.clone(), error }),
            Inner::Fst(writer) => writer
                .stretch(sync, samples)
                .map_err(|error| TraceError::WriteFst { path: self.path.clone(), error }),
            Inner::Csv(writer) => writer
                .stretch(sync, samples)
                .map_err(|error| TraceError::WriteSaleae { path: self.path.clone(), error }),
            Inner::Binary(writer, _) => writer
                .stretch(sync, samples)
                .map_err(|error| TraceError::WriteSaleae { path: self.path.clone(), error }),
        }
    }
}
