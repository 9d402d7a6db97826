//! A session file as levels: one pass, a block of samples in memory at a time.

use std::io::{Read, Seek};

use zip::ZipArchive;

use super::super::PlayError;
use super::super::levels::{LevelSink, LevelsPlayed};
use super::super::wiring::{Signal, Tap};
use super::archive::{self, Contents};
use super::error::SrError;
use super::gather::Gather;
use super::scan::{Lane, changes};

/// Bytes of samples in memory at a time: what a core's second-level cache holds beside the inflater's window.
const BLOCK: usize = 128 * 1024;

/// A session file whose metadata is read.
#[derive(Debug)]
pub struct SrFile<R> {
    archive: ZipArchive<R>,
    contents: Contents,
}

impl<R: Read + Seek> SrFile<R> {
    /// Reads the archive's directory, version and metadata.
    ///
    /// # Errors
    /// If it is no archive, no session of version 2, or one that was made to harm.
    pub fn new(file: R) -> Result<Self, SrError> {
        let mut archive = archive::open(file)?;
        let contents = archive::contents(&mut archive)?;
        Ok(Self { archive, contents })
    }

    /// The channels that were recorded, one bit each.
    #[must_use]
    pub fn signals(&self) -> Vec<Signal> {
        let probes = self.contents.device.probes.iter();
        probes.map(|probe| Signal { name: probe.name.clone(), width: 1, ..Signal::default() }).collect()
    }

    /// Samples a second, if the session says.
    #[must_use]
    pub fn sample_rate(&self) -> Option<u64> {
        self.contents.device.sample_rate
    }

    /// Plays the levels of the taps, each of which sets the bits of the state beside it. Times are numbers of samples; `progress` gets the
    /// bytes of the file that are done.
    ///
    /// # Errors
    /// If a piece is damaged or not as long as it should be, or the sink's.
    pub fn play<S: LevelSink>(
        &mut self,
        wires: &[(Tap, u64)],
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<LevelsPlayed, PlayError<SrError, S::Error>> {
        let Self { archive, contents } = self;
        let probes = &contents.device.probes;
        let bit = |tap: &Tap| probes.get(tap.signal).map(|probe| probe.bit);
        let taps = wires.iter().filter_map(|(tap, state)| Some((bit(tap)?, *state))).collect();
        let unit = contents.device.unit;
        let watched = sink.watched();
        let gather = Gather::new(unit, taps);
        let mut feed = Feed { archive, contents, progress, done: 0 };
        match unit {
            1 => feed.play::<1, u8, S>(&gather, gather.mask(watched), sink),
            2 => feed.play::<2, u16, S>(&gather, gather.mask(watched), sink),
            4 => feed.play::<4, u32, S>(&gather, gather.mask(watched), sink),
            8 => feed.play::<8, u64, S>(&gather, gather.mask(watched), sink),
            _ => feed.play_odd(&gather, watched, sink),
        }
    }
}

type Outcome<E> = Result<LevelsPlayed, PlayError<SrError, E>>;

/// The bytes of all pieces, one after the other.
struct Feed<'a, R> {
    archive: &'a mut ZipArchive<R>,
    contents: &'a Contents,
    progress: &'a mut dyn FnMut(u64),
    done: u64,
}

impl<R: Read + Seek> Feed<'_, R> {
    /// Hands on blocks of bytes. `take` says how many of them at the end it wants to see again in front of the next block.
    fn blocks<E>(
        &mut self,
        mut take: impl FnMut(&[u8]) -> Result<usize, E>,
    ) -> Result<usize, PlayError<SrError, E>> {
        let mut bytes = vec![0; BLOCK];
        let mut held = 0;
        for piece in &self.contents.pieces {
            let name = || piece.name.clone();
            let entry = self.archive.by_index(piece.index);
            let mut entry = entry.map_err(|error| {
                let error = std::io::Error::other(error.to_string());
                PlayError::Trace(SrError::Piece { name: name(), offset: 0, error })
            })?;
            let mut offset = 0;
            loop {
                let count = match entry.read(&mut bytes[held..]) {
                    Ok(count) => count,
                    Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                    Err(error) => {
                        return Err(PlayError::Trace(SrError::Piece { name: name(), offset, error }));
                    }
                };
                offset += count as u64;
                if offset > piece.size || count == 0 && offset < piece.size {
                    let error = SrError::Size { name: name(), said: piece.size, found: offset };
                    return Err(PlayError::Trace(error));
                }
                held += count;
                // A block that is nearly empty is not worth the way.
                if held == BLOCK || count == 0 {
                    let kept = take(&bytes[..held]).map_err(PlayError::Sink)?.min(BLOCK / 2);
                    bytes.copy_within(held - kept..held, 0);
                    held = kept;
                    let packed =
                        u128::from(piece.packed) * u128::from(offset) / u128::from(piece.size.max(1));
                    (self.progress)(self.done + packed as u64);
                }
                if count == 0 {
                    break;
                }
            }
            self.done += piece.packed;
        }
        Ok(held)
    }

    /// Samples that are as wide as a lane.
    fn play<const N: usize, L: Lane<N>, S: LevelSink>(
        &mut self,
        gather: &Gather,
        mask: [u8; N],
        sink: &mut S,
    ) -> Outcome<S::Error> {
        // Number of the first sample of a block, which after the first block is the last one of the block before.
        let mut number = 0_u64;
        let mut begun = false;
        let left = self.blocks(|bytes| {
            let (samples, broken) = bytes.as_chunks::<N>();
            let Some(first) = samples.first() else { return Ok(bytes.len()) };
            if !begun {
                begun = true;
                sink.levels(0, gather.state(first))?;
            }
            changes::<N, L, S::Error>(samples, mask, |at, sample| {
                sink.levels(number + at as u64, gather.state(sample))
            })?;
            number += samples.len() as u64 - 1;
            Ok(N + broken.len())
        })?;
        ended(left, N, begun, number)
    }

    /// Samples of another width: put together one by one.
    fn play_odd<S: LevelSink>(&mut self, gather: &Gather, watched: u64, sink: &mut S) -> Outcome<S::Error> {
        let unit = self.contents.device.unit;
        let (mut number, mut before) = (0_u64, None);
        let left = self.blocks(|bytes| {
            let samples = bytes.chunks_exact(unit);
            let broken = samples.remainder().len();
            for sample in samples {
                let state = gather.state(sample);
                if before.is_none_or(|before: u64| (before ^ state) & watched != 0) {
                    sink.levels(number, state)?;
                    before = Some(state);
                }
                number += 1;
            }
            Ok(broken)
        })?;
        let begun = number > 0;
        ended(left + if begun { unit } else { 0 }, unit, begun, number.saturating_sub(1))
    }
}

/// The end: `left` bytes are what was kept, of which a whole sample was played.
fn ended<E>(left: usize, unit: usize, begun: bool, last: u64) -> Outcome<E> {
    let broken = if begun { left.saturating_sub(unit) } else { left };
    if broken > 0 {
        return Err(PlayError::Trace(SrError::Broken { left: broken, unit }));
    }
    Ok(LevelsPlayed { end: last + u64::from(begun), unknown: 0 })
}
