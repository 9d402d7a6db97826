use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::Args;

use super::report::grouped;
use super::{Outcome, progress};
use crate::fault::{FaultError, FaultSpec, Injector, help};
use crate::profile::Profile;
use crate::receiver::Source;
use crate::trace::vcd::VcdWriterOptions;
use crate::trace::{SignalMap, TraceWriterOptions, create};

/// Options of `inject`.
#[derive(Debug, Args)]
pub struct Inject {
    /// The trace to be broken
    trace: Option<PathBuf>,
    /// A fault, as KIND or KIND:key=value,…; may be given more than once; help lists them
    #[arg(long = "fault", value_name = "KIND[:key=value,…]", required = true)]
    faults: Vec<String>,
    /// What is not said of a fault is drawn by this seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Built-in profile or TOML file; without it the one that the trace carries
    #[arg(long)]
    profile: Option<String>,
    /// Which signals are the wires, for instance PCLK=CH0,HSYNC=CH1,D0=CH3
    #[arg(long, value_name = "WIRE=SIGNAL,…")]
    map: Option<String>,
    /// The trace to be written
    #[arg(short, long, value_name = "TRACE")]
    output: Option<PathBuf>,
    /// Prints one JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// Reads faults as they are given on the command line.
pub(super) fn parse_faults(texts: &[String]) -> anyhow::Result<Vec<FaultSpec>> {
    texts
        .iter()
        .map(|text| text.parse().map_err(|error: FaultError| anyhow::anyhow!("--fault {text}: {error}")))
        .collect()
}

impl Inject {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        if self.faults.iter().any(|fault| fault == "help") {
            print!("{}", help());
            return Ok(Outcome::Fine);
        }
        let faults = parse_faults(&self.faults)?;
        let Some(trace) = &self.trace else {
            bail!("no trace; say `host-sim inject TRACE --fault … -o TRACE`")
        };
        let Some(output) = &self.output else { bail!("nowhere to write to; say `-o TRACE`") };
        let profile = self.profile.as_deref().map(Profile::find).transpose()?;
        let map = self.map.as_deref().map(SignalMap::parse).transpose()?.unwrap_or_default();
        let source = Source::open(trace, profile.as_ref(), map)?;
        for note in source.notes() {
            eprintln!("note: {note}");
        }
        let profile = source.profile();
        let sink = Deferred { writer: None, error: None };
        let mut injector = Injector::new(profile, &faults, self.seed, sink)?;
        let pclk = source.trace().info().pclk_hz.unwrap_or(profile.timing.pclk_hz);
        let bits = u8::try_from(profile.bus.bits).unwrap_or(8);
        let mut vcd = VcdWriterOptions::new(bits, pclk.saturating_mul(injector.clock_factor()));
        vcd.edge = profile.bus.clock_edge;
        let options = TraceWriterOptions {
            vcd,
            vsync_active: profile.bus.vsync_blank.is_high(),
            profile: profile.to_toml(),
        };
        injector.sink_mut().writer = Some(create(output, &options)?);
        let settled: Vec<String> = injector.faults().iter().map(ToString::to_string).collect();
        let bar = progress::bytes("inject", source.trace().info().file_bytes);
        source.play(&mut injector, &mut |bytes| bar.set_position(bytes))?;
        bar.finish_and_clear();
        let Ok(sink) = injector.finish();
        if let Some(error) = sink.error {
            return Err(error.into());
        }
        let created = sink.writer.context("the trace was not begun")?.finish()?;
        if self.json {
            let report = serde_json::json!({
                "trace": created.path,
                "profile": profile.name,
                "faults": settled,
                "seed": self.seed,
                "pclk": created.clocks,
                "bytes": created.bytes,
            });
            println!("{report:#}");
        } else {
            println!(
                "{}: {}, {} pixel clocks, {} bytes",
                created.path.display(),
                settled.join(" "),
                grouped(created.clocks),
                grouped(created.bytes)
            );
        }
        Ok(Outcome::Fine)
    }
}

/// A writer behind a sink that takes everything, as a source wants it: the first error stops the writing and is kept.
struct Deferred {
    writer: Option<crate::trace::TraceWriter>,
    error: Option<crate::trace::TraceError>,
}

impl firmware::trace::StretchSink for Deferred {
    type Error = std::convert::Infallible;

    fn stretch(
        &mut self,
        sync: firmware::camif::pins::Sync,
        samples: firmware::camif::pins::Samples<'_>,
    ) -> Result<(), Self::Error> {
        if let (Some(writer), None) = (&mut self.writer, &self.error) {
            self.error = writer.stretch(sync, samples).err();
        }
        Ok(())
    }
}
