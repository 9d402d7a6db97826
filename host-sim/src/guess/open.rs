//! From a trace file to a guess.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::bus::{self, BusGuess, Known, NothingFits};
use super::format::ambiguous;
use crate::profile::{Choice, DEFAULT, Profile, ProfileError};
use crate::trace::{self, CaptureOptions, PlayError, SignalMap, TraceError, Wanted};

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
    /// The profile that was named.
    #[error(transparent)]
    Profile(#[from] ProfileError),
}

/// Guesses the profile of a trace file. A profile that the trace carries is not looked at.
///
/// # Errors
/// [`GuessError`] if the trace cannot be read or shows no frame.
pub fn guess_file(path: &Path, map: &SignalMap) -> Result<BusGuess, GuessError> {
    let wanted = Wanted { map: map.clone(), bus_bits: None, no_sync_wires: true };
    let trace = trace::open(path, &CaptureOptions { wanted, ..CaptureOptions::default() })?;
    let known = Known { bits: trace.info().bus_bits, pclk_hz: trace.info().pclk_hz };
    let guessed = bus::guess(known, |mut sink| match trace.play(&mut sink, &mut |_| {}) {
        Ok(_) | Err(PlayError::Sink(_)) => Ok(()),
        Err(PlayError::Trace(error)) => Err(error),
    })?;
    guessed.map_err(|why| GuessError::Nothing { path: path.to_owned(), why })
}

/// The profile for a trace, and what to tell the user of it: the one named; guessed if [`AUTO`] is named, or nothing is
/// and the trace carries none. `None` where the trace carries one.
///
/// # Errors
/// If the profile that is named cannot be read, or guessing was asked for and failed.
pub fn profile_for(
    path: &Path,
    named: Option<&str>,
    map: &SignalMap,
) -> Result<(Option<Profile>, Vec<String>), GuessError> {
    if let Some(name) = named
        && name != AUTO
    {
        return Ok((Some(Profile::find(name)?), Vec::new()));
    }
    if named.is_none() && carries_profile(path) {
        return Ok((None, Vec::new()));
    }
    match guess_file(path, map) {
        Ok(guess) => {
            let notes = notes(&guess);
            Ok((Some(guess.profile), notes))
        }
        Err(error) if named.is_some() => Err(error),
        // What is wrong with the file will be said by who plays it.
        Err(GuessError::Nothing { why, .. }) => {
            let note = format!("the profile can't be guessed ({why}); {DEFAULT} is taken");
            Ok((Some(Profile::find(DEFAULT)?), vec![note]))
        }
        Err(_) => Ok((None, Vec::new())),
    }
}

fn carries_profile(path: &Path) -> bool {
    let options = CaptureOptions {
        wanted: Wanted { no_sync_wires: true, ..Wanted::default() },
        ..CaptureOptions::default()
    };
    trace::open(path, &options).is_ok_and(|trace| trace.info().profile.is_some())
}

fn notes(guess: &BusGuess) -> Vec<String> {
    let (Some(sync), Some(format)) = (guess.readings.first(), guess.formats.first()) else {
        return Vec::new();
    };
    let mut notes = vec![format!(
        "no profile is given; guessed {format} ({} % sure), {} ({} % sure); `host-sim guess` shows the rivals",
        format.confidence / 10,
        sync.reading,
        sync.confidence / 10
    )];
    notes.extend(guess.doubts.iter().filter(|doubt| doubt.contains("can't be told")).cloned());
    notes
}

/// What was guessed, as JSON.
#[derive(Debug, Serialize)]
pub struct Answer {
    /// The trace file.
    pub trace: String,
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
    pub fn new(path: &Path, guess: &BusGuess) -> Self {
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
            profile: guess.profile.to_toml(),
            sync: sync.collect(),
            formats: formats.collect(),
            ambiguous_with: ambiguous(&guess.formats).map(ToString::to_string).collect(),
            doubts: guess.doubts.clone(),
        }
    }
}
