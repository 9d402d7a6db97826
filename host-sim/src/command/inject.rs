use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::broken::{Broken, Deferred, asks_for_help, parse_faults};
use super::report::grouped;
use super::{Outcome, progress};
use crate::profile::Profile;
use crate::receiver::Source;
use crate::trace::SignalMap;

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

impl Inject {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        if asks_for_help(&self.faults) {
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
        let pclk = source.trace().info().pclk_hz.unwrap_or(profile.timing.pclk_hz);
        let broken = Broken { faults: &faults, seed: self.seed };
        let injector = broken.into_file(profile, pclk, output)?;
        let settled: Vec<String> = injector.faults().iter().map(ToString::to_string).collect();
        let bar = progress::bytes("inject", source.trace().info().file_bytes);
        let mut deferred = Deferred { sink: injector, error: None };
        source.play(&mut deferred, &mut |bytes| bar.set_position(bytes))?;
        bar.finish_and_clear();
        if let Some(error) = deferred.error {
            return Err(error.into());
        }
        let created = deferred.sink.finish()?.finish()?;
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
