//! `.camt` files on the host: the firmware's reader and writer over files, with a fast checksum.

use std::io;

use firmware::trace::{ChunkBuffer, Error, Item, Reader};

use super::PlayError;
use super::capture::About;
use super::levels::{LevelSink, LevelsPlayed};
use super::wiring::{Signal, Tap};

/// CRC-32 by the processor's carry-less multiplication where it has one.
#[must_use]
pub fn fast_crc32(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}

/// A standard reader, writer or file as the `embedded-io` one that the firmware takes.
#[derive(Debug)]
pub struct StdIo<T>(pub T);

impl<T> embedded_io::ErrorType for StdIo<T> {
    type Error = io::Error;
}

impl<T: io::Read> embedded_io::Read for StdIo<T> {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, io::Error> {
        retried(|| self.0.read(buf))
    }
}

impl<T: io::Write> embedded_io::Write for StdIo<T> {
    fn write(&mut self, buf: &[u8]) -> Result<usize, io::Error> {
        match retried(|| self.0.write(buf))? {
            // The other trait has no answer for this, and would panic.
            0 if !buf.is_empty() => Err(io::ErrorKind::WriteZero.into()),
            count => Ok(count),
        }
    }

    fn flush(&mut self) -> Result<(), io::Error> {
        self.0.flush()
    }
}

impl<T: io::Seek> embedded_io::Seek for StdIo<T> {
    fn seek(&mut self, pos: embedded_io::SeekFrom) -> Result<u64, io::Error> {
        self.0.seek(pos.into())
    }
}

fn retried(mut call: impl FnMut() -> io::Result<usize>) -> io::Result<usize> {
    loop {
        match call() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

/// A trace as levels, as if it had been recorded: the wires change at 2k, PCLK rises at 2k + 1.
pub(super) fn about<R: io::Read>(file: R) -> Result<About, Error<io::Error>> {
    let reader = Reader::with_checksum(StdIo(file), ChunkBuffer::new(), fast_crc32)?;
    let header = reader.header();
    let lines = (0..header.bus_bits).map(|line| format!("D{line}"));
    let names = SYNCS.map(str::to_owned).into_iter().chain(lines);
    let signals = names.map(|name| Signal { name, width: 1, ..Signal::default() }).collect();
    let ticks_per_second = (header.pclk_hz > 0).then(|| 2.0 * f64::from(header.pclk_hz));
    Ok(About { signals, ticks_per_second, sample_rate: None, sampled: false })
}

/// Channels before the lines of the bus.
const SYNCS: [&str; 3] = ["PCLK", "HSYNC", "VSYNC"];

/// Plays the levels of the taps.
pub(super) fn levels<R: io::Read, S: LevelSink>(
    file: R,
    wires: &[(Tap, u64)],
    sink: &mut S,
    progress: &mut dyn FnMut(u64),
) -> Result<LevelsPlayed, PlayError<Error<io::Error>, S::Error>> {
    // Bit i of a sample's levels is channel i.
    let state = |levels: u32| {
        wires
            .iter()
            .filter(|(tap, _)| levels >> (tap.signal % 32) & 1 == 1)
            .fold(0, |all, (_, bits)| all | bits)
    };
    let watched = sink.watched();
    let mut reader =
        Reader::with_checksum(StdIo(file), ChunkBuffer::new(), fast_crc32).map_err(PlayError::Trace)?;
    let (mut time, mut before, mut told) = (0, None, 0);
    while let Some(item) = reader.next_item().map_err(PlayError::Trace)? {
        let Item::Stretch(sync, samples) = item else { continue };
        let syncs = u32::from(sync.hsync) << 1 | u32::from(sync.vsync) << 2;
        for index in 0..samples.len() {
            let levels = syncs | u32::from(samples.get(index).unwrap_or_default()) << SYNCS.len();
            for (time, levels) in [(time, levels), (time + 1, levels | 1)] {
                let state = state(levels);
                if before.is_none_or(|before: u64| (before ^ state) & watched != 0) {
                    before = Some(state);
                    sink.levels(time, state).map_err(PlayError::Sink)?;
                }
            }
            time += 2;
        }
        told += 1;
        if told % 4096 == 0 {
            progress(reader.position());
        }
    }
    progress(reader.position());
    Ok(LevelsPlayed { end: time, unknown: 0 })
}
