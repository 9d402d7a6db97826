use std::convert::Infallible;
use std::path::{Path, PathBuf};

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use crate::profile::{DEFAULT, Profile, ProfileError, SyncMode};
use crate::trace::polarity::{Expected, Inverted, RunLengths, Wire, decide};
use crate::trace::{self, CaptureOptions, Format, PlayError, Played, SignalMap, Trace, TraceError, Wanted};

/// A trace together with the profile by which it is read.
#[derive(Debug)]
pub struct Source {
    trace: Trace,
    profile: Profile,
    /// Sync wires whose levels are exchanged.
    invert: (bool, bool),
    notes: Vec<String>,
}

/// Why a trace could not be opened by a profile.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The trace.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The profile that it carries, or the default one.
    #[error("{}: the profile in the trace", path.display())]
    Profile {
        /// The trace.
        path: PathBuf,
        /// What is wrong with it.
        #[source]
        error: ProfileError,
    },
    /// The trace has another bus than the profile.
    #[error(
        "{}: the bus has {bits} bits, the profile {profile} has {wanted}; give the profile that the trace was made with",
        path.display()
    )]
    BusWidth {
        /// The trace.
        path: PathBuf,
        /// Bits of its bus.
        bits: u8,
        /// The profile's name.
        profile: String,
        /// Bits of the profile's bus.
        wanted: u32,
    },
}

impl Source {
    /// Opens a trace. Without a profile the one that the trace carries is taken, else the default one.
    ///
    /// # Errors
    /// [`SourceError`] if the trace cannot be read, carries a bad profile, or does not fit the profile's bus.
    pub fn open(path: &Path, profile: Option<&Profile>, map: SignalMap) -> Result<Self, SourceError> {
        Self::open_with(path, profile, map, None)
    }

    /// The same; in an analyser's samples, pulses of the clock shorter than `shortest_pulse` seconds are dropped.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with(
        path: &Path,
        profile: Option<&Profile>,
        map: SignalMap,
        shortest_pulse: Option<f64>,
    ) -> Result<Self, SourceError> {
        let bad_profile = |error| SourceError::Profile { path: path.to_owned(), error };
        let guess = match profile {
            Some(profile) => profile.clone(),
            None => Profile::find(DEFAULT).map_err(bad_profile)?,
        };
        let wanted = Wanted {
            map,
            bus_bits: u8::try_from(guess.bus.bits).ok(),
            no_sync_wires: guess.bus.sync == SyncMode::Embedded,
        };
        let options = CaptureOptions {
            wanted,
            edge: guess.bus.clock_edge,
            shortest_pulse,
            ..CaptureOptions::default()
        };
        let trace = trace::open(path, &options)?;
        let mut notes = Vec::new();
        let profile = match (profile, &trace.info().profile) {
            (None, Some(text)) => Profile::from_toml(text).map_err(bad_profile)?,
            (None, None) => {
                notes.push(format!("read by the profile {DEFAULT}; say --profile for another"));
                guess
            }
            (Some(_), _) => guess,
        };
        let bits = trace.info().bus_bits;
        if u32::from(bits) != profile.bus.bits {
            let wanted = profile.bus.bits;
            return Err(SourceError::BusWidth { path: path.to_owned(), bits, profile: profile.name, wanted });
        }
        notes.extend(trace.info().clock.iter().flat_map(trace::clock::Clock::notes));
        let mut source = Self { trace, profile, invert: (false, false), notes };
        source.settle_polarity();
        Ok(source)
    }

    /// The trace.
    #[must_use]
    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    /// The profile by which it is read.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// What was decided and the user may want to know.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// A wire whose name says that it is valid when high may contradict the profile; the trace then decides.
    fn settle_polarity(&mut self) {
        let marker = self.profile.bus.sync == SyncMode::Marker;
        if self.trace.info().format == Format::Camt || self.profile.bus.sync == SyncMode::Embedded {
            return;
        }
        let Some(matched) = self.trace.info().matched.clone() else { return };
        let line = u64::from(self.profile.samples_per_line());
        let frame = line * u64::from(self.profile.frame.height);
        let wires = [
            (Wire::Hsync, matched.hsync, self.profile.bus.hsync_blank, line),
            (Wire::Vsync, matched.vsync, self.profile.bus.vsync_blank, frame),
        ];
        for (wire, name, blank, valid_clocks) in wires {
            let Some(name) = name else { continue };
            if marker || !name.valid_high || !blank.is_high() {
                continue;
            }
            let enough = 3 * self.profile.clocks_per_frame().max(frame);
            let mut seen = RunLengths::new(wire, enough);
            // What is wrong with the trace will be said when it is played.
            let _ = self.trace.play(&mut seen, &mut |_| {});
            let polarity = decide(&name, Expected { blank_high: true, marker, valid_clocks }, &seen);
            if let Some(reason) = polarity.reason {
                self.notes.push(reason);
            }
            match wire {
                Wire::Hsync => self.invert.0 = polarity.invert,
                Wire::Vsync => self.invert.1 = polarity.invert,
            }
        }
    }

    /// Plays the trace into a sink that takes everything.
    ///
    /// # Errors
    /// The trace's, at whatever place it is damaged; all that was delivered before is good.
    pub fn play<S: StretchSink<Error = Infallible>>(
        &self,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Played, TraceError> {
        let (hsync, vsync) = self.invert;
        let played = if hsync || vsync {
            self.trace.play(&mut Inverted { hsync, vsync, sink: Lent(sink) }, progress)
        } else {
            self.trace.play(sink, progress)
        };
        played.map_err(|error| match error {
            PlayError::Trace(error) => error,
            PlayError::Sink(never) => match never {},
        })
    }
}

/// A sink that is lent on.
struct Lent<'a, S>(&'a mut S);

impl<S: StretchSink> StretchSink for Lent<'_, S> {
    type Error = S::Error;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), S::Error> {
        self.0.stretch(sync, samples)
    }
}
