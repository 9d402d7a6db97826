//! The binary files of a folder, merged in time.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::super::PlayError;
use super::super::capture::About;
use super::super::levels::{LevelSink, LevelsPlayed};
use super::super::wiring::{Signal, Tap};
use super::TICKS;
use super::channel::{Change, Channel};
use super::error::SaleaeError;

/// Files that are open at a time.
const FILES: usize = 63;
/// Calls between two of `progress`.
const STEPS: u64 = 1 << 14;

/// An export whose headers are read.
#[derive(Debug)]
pub struct BinaryExport {
    files: Vec<PathBuf>,
    channels: Vec<Channel>,
    bytes: u64,
}

/// A channel on its way: the next change, in units of time.
struct Lane<'a> {
    channel: &'a mut Channel,
    bits: u64,
    next: Option<(u64, Change)>,
}

impl BinaryExport {
    /// Opens the digital channels in a folder, or a file together with its siblings `digital_0.bin`, `digital_1.bin`, …
    ///
    /// # Errors
    /// If a file cannot be read or is malformed at its beginning.
    pub fn open(path: &Path) -> Result<Self, SaleaeError> {
        let files = if path.is_dir() {
            files(path)?
        } else {
            let folder =
                path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let siblings = if number(path).is_some() { files(folder)? } else { Vec::new() };
            if siblings.iter().any(|sibling| sibling.file_name() == path.file_name()) {
                siblings
            } else {
                vec![path.to_owned()]
            }
        };
        Self::of(files)
    }

    /// Opens these files, each a channel.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn of(files: Vec<PathBuf>) -> Result<Self, SaleaeError> {
        if files.len() > FILES {
            return Err(SaleaeError::TooManyFiles(files.len()));
        }
        let channels = files.iter().map(|file| Channel::open(file)).collect::<Result<_, _>>()?;
        let mut bytes = 0;
        for file in &files {
            bytes += file.metadata()?.len();
        }
        Ok(Self { files, channels, bytes })
    }

    pub(in super::super) fn about(&self) -> About {
        let name = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let signal = |file: &PathBuf| Signal { name: name(file), width: 1, ..Signal::default() };
        let signals = self.files.iter().map(signal).collect();
        let sample_rate = self.channels.iter().find_map(|channel| channel.sample_rate);
        About { signals, ticks_per_second: Some(TICKS), sample_rate, sampled: true }
    }

    /// Bytes of all files.
    #[must_use]
    pub fn file_bytes(&self) -> u64 {
        self.bytes
    }

    /// Plays the levels of the taps.
    ///
    /// # Errors
    /// If a file is malformed or cut short, or the sink's.
    pub fn play<S: LevelSink>(
        mut self,
        wires: &[(Tap, u64)],
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<LevelsPlayed, PlayError<SaleaeError, S::Error>> {
        let begin = self.channels.iter().map(|channel| channel.begin).fold(f64::INFINITY, f64::min);
        let ticks = |seconds: f64| ((seconds - begin) * TICKS).round() as u64;
        let end = self.channels.iter().map(|channel| ticks(channel.end)).max().unwrap_or(0);
        let watched = sink.watched();
        let mut state = 0;
        let mut lanes = Vec::new();
        for (signal, channel) in self.channels.iter_mut().enumerate() {
            let bits =
                wires.iter().filter(|(tap, _)| tap.signal == signal).fold(0, |all, (_, bits)| all | bits);
            if bits == 0 {
                continue;
            }
            state |= if channel.initial { bits } else { 0 };
            let next =
                channel.next().map_err(PlayError::Trace)?.map(|change| (ticks(change.seconds), change));
            lanes.push(Lane { channel, bits, next });
        }
        let mut played = LevelsPlayed { end, unknown: 0 };
        sink.levels(0, state).map_err(PlayError::Sink)?;
        let mut told = state;
        for step in 0_u64.. {
            let times = lanes.iter().filter_map(|lane| lane.next.map(|(time, _)| time));
            let Some(now) = times.min() else { break };
            for lane in &mut lanes {
                while let Some((time, change)) = lane.next.filter(|(time, _)| *time == now) {
                    debug_assert_eq!(time, now);
                    state = if change.high { state | lane.bits } else { state & !lane.bits };
                    played.unknown += u64::from(change.after_gap);
                    let next = lane.channel.next().map_err(PlayError::Trace)?;
                    lane.next = next.map(|change| (ticks(change.seconds), change));
                }
            }
            if (state ^ told) & watched != 0 {
                sink.levels(now, state).map_err(PlayError::Sink)?;
                told = state;
            }
            played.end = played.end.max(now);
            if step % STEPS == 0 {
                progress(lanes.iter().map(|lane| lane.channel.offset).sum());
            }
        }
        progress(self.bytes);
        Ok(played)
    }
}

/// The digital channels in a folder, by their numbers.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>, SaleaeError> {
    let mut found = Vec::new();
    for entry in folder.read_dir()? {
        let path = entry?.path();
        let Some(number) = number(&path) else { continue };
        let mut head = [0; 16];
        let digital = std::fs::File::open(&path)?.read(&mut head)? == 16
            && head.starts_with(b"<SALEAE>")
            && head[12] == 0;
        if digital {
            found.push((number, path));
        }
        if found.len() > 2 * FILES {
            return Err(SaleaeError::TooManyFiles(found.len()));
        }
    }
    found.sort();
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

/// The number in `digital_3.bin`.
fn number(path: &Path) -> Option<u32> {
    let name = path.file_name()?.to_str()?.to_ascii_lowercase();
    name.strip_prefix("digital_")?.strip_suffix(".bin")?.parse().ok()
}
