//! Faults on the way into a trace or out of it, as `inject`, `generate` and `replay` have them.

use std::convert::Infallible;
use std::path::Path;

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use crate::fault::{FaultError, FaultSpec, Injector, help};
use crate::profile::Profile;
use crate::trace::vcd::VcdWriterOptions;
use crate::trace::{TraceError, TraceWriter, TraceWriterOptions, create};

/// What is done to a trace on its way; by default nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Broken<'a> {
    /// Faults, one after the other.
    pub(super) faults: &'a [FaultSpec],
    /// By which their values are drawn.
    pub(super) seed: u64,
}

impl<'a> Broken<'a> {
    /// The faults between a source of stretches and a sink.
    ///
    /// # Errors
    /// If the profile's wires cannot have one of them.
    pub(super) fn before<S: StretchSink>(
        self,
        profile: &Profile,
        sink: S,
    ) -> Result<Injector<S>, FaultError> {
        Injector::new(profile, self.faults, self.seed, sink)
    }

    /// The faults before a trace file of a camera with this pixel clock.
    pub(super) fn into_file(
        self,
        profile: &Profile,
        pclk_hz: u32,
        output: &Path,
    ) -> anyhow::Result<Injector<TraceWriter>> {
        // How fast the clock is stands in the file's header, so before all else.
        let factor = self.before(profile, Nothing)?.clock_factor();
        let writer = trace_writer(profile, pclk_hz.saturating_mul(factor), output)?;
        Ok(self.before(profile, writer)?)
    }
}

/// Begins a trace file of a profile.
pub(super) fn trace_writer(
    profile: &Profile,
    pclk_hz: u32,
    output: &Path,
) -> Result<TraceWriter, TraceError> {
    let bits = u8::try_from(profile.bus.bits).unwrap_or(8);
    let mut vcd = VcdWriterOptions::new(bits, pclk_hz);
    vcd.edge = profile.bus.clock_edge;
    let options = TraceWriterOptions {
        vcd,
        vsync_active: profile.bus.vsync_blank.is_high(),
        profile: profile.to_toml(),
    };
    create(output, &options)
}

/// Reads faults as they are given on the command line.
pub(super) fn parse_faults(texts: &[String]) -> anyhow::Result<Vec<FaultSpec>> {
    texts
        .iter()
        .map(|text| text.parse().map_err(|error: FaultError| anyhow::anyhow!("--fault {text}: {error}")))
        .collect()
}

/// Prints the faults that there are, if that is what was asked for.
pub(super) fn asks_for_help(texts: &[String]) -> bool {
    let asked = texts.iter().any(|fault| fault == "help");
    if asked {
        print!("{}", help());
    }
    asked
}

/// A sink that keeps nothing.
struct Nothing;

impl StretchSink for Nothing {
    type Error = Infallible;

    fn stretch(&mut self, _: Sync, _: Samples<'_>) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A sink as a source wants it, that takes everything: the first error stops it and is kept.
pub(super) struct Deferred<S: StretchSink> {
    pub(super) sink: S,
    pub(super) error: Option<S::Error>,
}

impl<S: StretchSink> StretchSink for Deferred<S> {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        if self.error.is_none() {
            self.error = self.sink.stretch(sync, samples).err();
        }
        Ok(())
    }
}
