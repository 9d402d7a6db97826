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

/// A channel on its way.
struct Lane<'a> {
    channel: &'a mut Channel,
    bits: u64,
    /// Its next change, whose time is kept with those of the other lanes.
    change: Change,
}

/// The time of the next change of a lane that has none.
const NEVER: u64 = u64::MAX;

/// The nearest unit of time; halves go up. (`f64::round` is a call where the processor's base has no instruction for it.)
#[inline]
fn nearest(ticks: f64) -> u64 {
    let whole = (ticks as u64).min(NEVER - 1);
    (whole + u64::from(ticks - whole as f64 >= 0.5)).min(NEVER - 1)
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
        let ticks = |seconds: f64| nearest((seconds - begin) * TICKS);
        let end = self.channels.iter().map(|channel| ticks(channel.end)).max().unwrap_or(0);
        let watched = sink.watched();
        let mut state = 0;
        let (mut lanes, mut times) = (Vec::new(), Vec::new());
        for (signal, channel) in self.channels.iter_mut().enumerate() {
            let bits =
                wires.iter().filter(|(tap, _)| tap.signal == signal).fold(0, |all, (_, bits)| all | bits);
            if bits == 0 {
                continue;
            }
            state |= if channel.initial { bits } else { 0 };
            if let Some(change) = channel.next().map_err(PlayError::Trace)? {
                times.push(ticks(change.seconds));
                lanes.push(Lane { channel, bits, change });
            }
        }
        let mut played = LevelsPlayed { end, unknown: 0 };
        sink.levels(0, state).map_err(PlayError::Sink)?;
        let mut told = state;
        for step in 0_u64.. {
            let now = times.iter().fold(NEVER, |least, &time| least.min(time));
            if now == NEVER {
                break;
            }
            for (lane, time) in lanes.iter_mut().zip(&mut times) {
                while *time == now {
                    state = if lane.change.high { state | lane.bits } else { state & !lane.bits };
                    played.unknown += u64::from(lane.change.after_gap);
                    *time = match lane.channel.next().map_err(PlayError::Trace)? {
                        Some(change) => {
                            lane.change = change;
                            ticks(change.seconds)
                        }
                        None => NEVER,
                    };
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

#[cfg(test)]
mod tests {
    use super::{NEVER, nearest};

    #[test]
    fn the_nearest_unit_is_that_of_round() {
        let odd = [0.0, 0.49999999999999994, 0.5, 1.5, 2.5, 4503599627370497.0, 9007199254740991.0, 1e19];
        for ticks in odd.into_iter().chain((0..1000).map(|step| f64::from(step) * 1.37e9 / 7.0)) {
            assert_eq!(nearest(ticks), ticks.round() as u64, "{ticks}");
        }
        assert_eq!(nearest(2e19), NEVER - 1);
        assert_eq!(nearest(-1.0), 0);
    }
}
