//! From a trace file to a guess.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::bus::{self, BusGuess, Known, NothingFits};
use super::format::ambiguous;
use super::wires::{self, NoWires, Wires};
use crate::profile::{Choice, DEFAULT, Profile, ProfileError};
use crate::trace::wiring::{WiringError, wire};
use crate::trace::{self, Capture, CaptureOptions, PlayError, SignalMap, TraceError, Wanted};

/// The word for a profile that is to be guessed.
pub const AUTO: &str = "auto";

/// Why a trace's profile could not be guessed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GuessError {
    /// The trace.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// It shows no frame, or none that is of a known format.
    #[error("{}: {why}", path.display())]
    Nothing {
        /// The trace.
        path: PathBuf,
        /// Why.
        why: NothingFits,
    },
    /// Its names say nothing, and its wires can't be told by what they do.
    #[error("{}: {why}", path.display())]
    Wires {
        /// The trace.
        path: PathBuf,
        /// Why.
        why: NoWires,
    },
    /// The profile that was named.
    #[error(transparent)]
    Profile(#[from] ProfileError),
}

/// What was guessed of a trace file.
#[derive(Clone, Debug)]
pub struct FileGuess {
    /// Sync, format, profile.
    pub bus: BusGuess,
    /// Which signals are the wires: as it was given, or as it was guessed.
    pub map: SignalMap,
    /// The wires, if their names did not say which they are.
    pub wires: Option<Wires>,
}

/// Guesses the profile of a trace file, and its wires if their names say nothing and `map` is empty. A profile that the trace
/// carries is not looked at.
///
/// # Errors
/// [`GuessError`] if the trace cannot be read or shows no frame.
pub fn guess_file(path: &Path, map: &SignalMap) -> Result<FileGuess, GuessError> {
    let capture = Capture::open(path)?;
    let unnamed = match wire(capture.signals(), &wanted(map)) {
        Err(WiringError::Missing(missing)) if *map == SignalMap::default() => {
            TraceError::Wiring { path: path.to_owned(), error: missing.into() }
        }
        // Another error is said by who opens the trace.
        _ => return guess_mapped(path, map).map(|bus| FileGuess { bus, map: map.clone(), wires: None }),
    };
    let wires = match wires::find(&capture)? {
        Ok(wires) => wires,
        // A bus that lacks a wire is told by its name rather than by what its other wires look like.
        Err(NoWires::NoBus { .. }) => return Err(unnamed.into()),
        Err(why) => return Err(GuessError::Wires { path: path.to_owned(), why }),
    };
    let mut best: Option<FileGuess> = None;
    let mut failed = None;
    for map in wires.maps().map_err(|error| GuessError::Wires { path: path.to_owned(), why: error.into() })? {
        match guess_mapped(path, &map) {
            Ok(bus) => {
                if best.as_ref().is_none_or(|best| bits(&bus) < bits(&best.bus)) {
                    best = Some(FileGuess { bus, map, wires: Some(wires.clone()) });
                }
            }
            Err(error @ GuessError::Nothing { .. }) => failed = Some(error),
            Err(error) => return Err(error),
        }
    }
    let mut best = best.ok_or_else(|| failed.unwrap_or_else(|| unnamed.into()))?;
    best.bus.doubts.extend(wires.doubts());
    Ok(best)
}

/// Any bus, with sync wires or without.
fn wanted(map: &SignalMap) -> Wanted {
    Wanted { map: map.clone(), bus_bits: None, no_sync_wires: true }
}

/// What a sample takes in the most likely format.
fn bits(guess: &BusGuess) -> u64 {
    guess.formats.first().map_or(u64::MAX, |format| format.millibits)
}

fn guess_mapped(path: &Path, map: &SignalMap) -> Result<BusGuess, GuessError> {
    let options = CaptureOptions { wanted: wanted(map), ..CaptureOptions::default() };
    let mut trace = trace::open(path, &options)?;
    let edge = trace.still_edge()?;
    if let Some(edge) = edge.filter(|&edge| edge != options.edge) {
        trace = trace::open(path, &CaptureOptions { edge, ..options })?;
    }
    let known = Known { bits: trace.info().bus_bits, pclk_hz: trace.info().pclk_hz, edge };
    let guessed = bus::guess(known, |mut sink| match trace.play(&mut sink, &mut |_| {}) {
        Ok(_) | Err(PlayError::Sink(_)) => Ok(()),
        Err(PlayError::Trace(error)) => Err(error),
    })?;
    guessed.map_err(|why| GuessError::Nothing { path: path.to_owned(), why })
}

/// By what a trace is read.
#[derive(Clone, Debug, Default)]
pub struct ReadBy {
    /// The profile; nothing where the trace carries one.
    pub profile: Option<Profile>,
    /// Which signals are the wires.
    pub map: SignalMap,
    /// What to tell the user of it.
    pub notes: Vec<String>,
}

/// By what a trace is to be read: the profile that is named; or, if [`AUTO`] is named, or nothing is and the trace carries none, a
/// guessed one.
///
/// # Errors
/// If the profile that is named cannot be read, or guessing was asked for and failed.
pub fn profile_for(path: &Path, named: Option<&str>, map: &SignalMap) -> Result<ReadBy, GuessError> {
    let read_by = |profile: Option<Profile>, notes| ReadBy { profile, map: map.clone(), notes };
    if let Some(name) = named
        && name != AUTO
    {
        return Ok(read_by(Some(Profile::find(name)?), Vec::new()));
    }
    if named.is_none() && carries_profile(path) {
        return Ok(read_by(None, Vec::new()));
    }
    match guess_file(path, map) {
        Ok(guess) => {
            let notes = notes(&guess);
            Ok(ReadBy { profile: Some(guess.bus.profile), map: guess.map, notes })
        }
        Err(error) if named.is_some() => Err(error),
        // What is wrong with the file will be said by who plays it.
        Err(GuessError::Nothing { why, .. }) => {
            let note = format!("the profile can't be guessed ({why}); {DEFAULT} is taken");
            Ok(read_by(Some(Profile::find(DEFAULT)?), vec![note]))
        }
        Err(GuessError::Wires { why, .. }) => {
            Ok(read_by(None, vec![format!("the wires can't be guessed: {why}")]))
        }
        Err(_) => Ok(read_by(None, Vec::new())),
    }
}

fn carries_profile(path: &Path) -> bool {
    let options = CaptureOptions {
        wanted: Wanted { no_sync_wires: true, ..Wanted::default() },
        ..CaptureOptions::default()
    };
    trace::open(path, &options).is_ok_and(|trace| trace.info().profile.is_some())
}

fn notes(FileGuess { bus: guess, map, wires }: &FileGuess) -> Vec<String> {
    let (Some(sync), Some(format)) = (guess.readings.first(), guess.formats.first()) else {
        return Vec::new();
    };
    let mut notes: Vec<String> =
        wires.iter().map(|_| format!("the names of the wires say nothing; guessed --map {map}")).collect();
    notes.push(format!(
        "no profile is given; guessed {format} ({} % sure), {} ({} % sure); `host-sim guess` shows the rivals",
        format.confidence / 10,
        sync.reading,
        sync.confidence / 10
    ));
    notes.extend(guess.doubts.iter().filter(|doubt| doubt.contains("can't be told")).cloned());
    notes
}

/// What was guessed, as JSON.
#[derive(Debug, Serialize)]
pub struct Answer {
    /// The trace file.
    pub trace: String,
    /// Which signals are the wires, as `--map` takes it; nothing where their names say so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// The most likely profile, as TOML text.
    pub profile: String,
    /// How the sync wires are read, the most likely first.
    pub sync: Vec<SyncAnswer>,
    /// Which formats it may be, the most likely first.
    pub formats: Vec<FormatAnswer>,
    /// The formats that can't be told from the first.
    pub ambiguous_with: Vec<String>,
    /// What else can't be told, in words.
    pub doubts: Vec<String>,
}

/// One reading of the sync wires.
#[derive(Debug, Serialize)]
#[expect(missing_docs, reason = "the names are those of SyncGuess and Profile")]
pub struct SyncAnswer {
    pub sync: &'static str,
    pub hsync_high: bool,
    pub vsync_high: bool,
    pub confidence: f64,
    pub line_clocks: u64,
    pub lines: u64,
    pub hblank: u64,
    pub vblank: u64,
    pub evidence: String,
}

/// One format.
#[derive(Debug, Serialize)]
#[expect(missing_docs, reason = "the names are those of FormatGuess and Frame")]
pub struct FormatAnswer {
    pub format: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bayer: Option<&'static str>,
    pub width: u32,
    pub height: u32,
    pub confidence: f64,
    pub bits_per_sample: f64,
}

impl Answer {
    /// What was guessed of a trace.
    #[must_use]
    pub fn new(path: &Path, FileGuess { bus: guess, map, wires }: &FileGuess) -> Self {
        let sync = guess.readings.iter().map(|reading| SyncAnswer {
            sync: reading.reading.mode.name(),
            hsync_high: reading.reading.hsync_high,
            vsync_high: reading.reading.vsync_high,
            confidence: f64::from(reading.confidence) / 1000.0,
            line_clocks: reading.line_clocks,
            lines: reading.lines,
            hblank: reading.hblank,
            vblank: reading.vblank,
            evidence: reading.evidence.clone(),
        });
        let formats = guess.formats.iter().map(|format| FormatAnswer {
            format: format.frame.format.name(),
            bayer: format.frame.is_bayer().then(|| format.frame.bayer.name()),
            width: format.frame.width,
            height: format.frame.height,
            confidence: f64::from(format.confidence) / 1000.0,
            bits_per_sample: format.millibits as f64 / 1000.0,
        });
        Self {
            trace: path.display().to_string(),
            map: wires.as_ref().map(|_| map.to_string()),
            profile: guess.profile.to_toml(),
            sync: sync.collect(),
            formats: formats.collect(),
            ambiguous_with: ambiguous(&guess.formats).map(ToString::to_string).collect(),
            doubts: guess.doubts.clone(),
        }
    }
}
