use std::path::Path;

use anyhow::{Context, bail};
use firmware::trace::StretchSink;

use crate::profile::{DEFAULT, Profile, SyncMode};
use crate::trace::polarity::{Expected, Inverted, RunLengths, Wire, decide};
use crate::trace::{self, CaptureOptions, Format, Played, SignalMap, Trace, Wanted};

/// A trace together with the profile by which it is read.
pub(super) struct Source {
    pub(super) trace: Trace,
    pub(super) profile: Profile,
    /// Sync wires whose levels are exchanged.
    invert: (bool, bool),
}

impl Source {
    /// Opens a trace. Without a profile the one that the trace carries is taken, else the default one.
    pub(super) fn open(path: &Path, profile: Option<&str>, map: Option<&str>) -> anyhow::Result<Self> {
        let named = profile.map(Profile::find).transpose()?;
        let guess = match &named {
            Some(profile) => profile.clone(),
            None => Profile::find(DEFAULT)?,
        };
        let wanted = Wanted {
            map: map.map(SignalMap::parse).transpose()?.unwrap_or_default(),
            bus_bits: u8::try_from(guess.bus.bits).ok(),
            no_sync_wires: guess.bus.sync == SyncMode::Embedded,
        };
        let options = CaptureOptions { wanted, edge: guess.bus.clock_edge, ..CaptureOptions::default() };
        let trace = trace::open(path, &options)?;
        let profile = match (&named, &trace.info().profile) {
            (None, Some(text)) => Profile::from_toml(text)
                .with_context(|| format!("{}: the profile in the trace", path.display()))?,
            _ => guess,
        };
        if named.is_none() && trace.info().profile.is_none() {
            eprintln!("note: read by the profile {DEFAULT}; say --profile for another");
        }
        if u32::from(trace.info().bus_bits) != profile.bus.bits {
            bail!(
                "{}: the bus has {} bits, the profile {} has {}; give the profile that the trace was made with",
                path.display(),
                trace.info().bus_bits,
                profile.name,
                profile.bus.bits
            );
        }
        let mut source = Self { trace, profile, invert: (false, false) };
        source.settle_polarity();
        Ok(source)
    }

    /// A wire whose name says that it is valid when high may contradict the profile; the trace then decides.
    fn settle_polarity(&mut self) {
        let marker = self.profile.bus.sync == SyncMode::Marker;
        if self.trace.info().format != Format::Vcd || self.profile.bus.sync == SyncMode::Embedded {
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
                eprintln!("note: {reason}");
            }
            match wire {
                Wire::Hsync => self.invert.0 = polarity.invert,
                Wire::Vsync => self.invert.1 = polarity.invert,
            }
        }
    }

    /// Plays the trace into a sink that takes everything.
    pub(super) fn play<S: StretchSink<Error = std::convert::Infallible>>(
        &self,
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> anyhow::Result<Played> {
        let (hsync, vsync) = self.invert;
        let played = if hsync || vsync {
            self.trace.play(&mut Inverted { hsync, vsync, sink: Lent(sink) }, progress)
        } else {
            self.trace.play(sink, progress)
        };
        match played {
            Ok(played) => Ok(played),
            Err(trace::PlayError::Trace(error)) => Err(error.into()),
            Err(trace::PlayError::Sink(never)) => match never {},
        }
    }
}

/// A sink that is lent on.
struct Lent<'a, S>(&'a mut S);

impl<S: StretchSink> StretchSink for Lent<'_, S> {
    type Error = S::Error;

    fn stretch(
        &mut self,
        sync: firmware::camif::pins::Sync,
        samples: firmware::camif::pins::Samples<'_>,
    ) -> Result<(), S::Error> {
        self.0.stretch(sync, samples)
    }
}
