use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::Args;

use super::broken::{Broken, asks_for_help, parse_faults};
use super::clock::{ClockReport, seconds};
use super::process::{print_help, print_timing};
use super::report::{Collector, Report};
use super::{Outcome, progress};
use crate::guess::profile_for;
use crate::pipeline::{Pipeline, Runner};
use crate::receiver::{Source, capture_config, parse_bus, receive};
use crate::trace::SignalMap;

/// Options of `replay`.
#[derive(Debug, Args)]
pub struct Replay {
    /// The trace: .camt, VCD, sigrok .sr, Saleae digital.csv or folder of binary files, FST; told apart by content
    trace: PathBuf,
    /// Built-in profile, TOML file, or `auto` to guess it; without it the one that the trace carries, else guessed
    #[arg(long)]
    profile: Option<String>,
    /// Which signals are the wires, for instance PCLK=CH0,HSYNC=CH1,D0=CH3
    #[arg(long, value_name = "WIRE=SIGNAL,…")]
    map: Option<String>,
    /// In an analyser's samples: pulses of the clock shorter than this are dropped, for instance 12ns; without, shorter than half of what
    /// is usual
    #[arg(long, value_name = "TIME", value_parser = seconds)]
    min_pulse: Option<f64>,
    /// Pixel clocks from DMA request to grant: MIN or MIN..MAX, then ,stall=CLOCKS/ONE_IN and ,seed=N
    #[arg(long, value_name = "LATENCY", default_value = "0")]
    bus_latency: String,
    /// Breaks the trace on its way: a fault, as KIND or KIND:key=value,…; may be given more than once; help lists them
    #[arg(long = "fault", value_name = "KIND[:key=value,…]")]
    faults: Vec<String>,
    /// What is not said of a fault is drawn by this seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Writes each frame as PNG and raw bytes to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also sends each frame through these stages and writes frame-0000-op.png; help says which there are
    #[arg(long, value_name = "PIPELINE")]
    op: Option<String>,
    /// Says on stderr how long each stage of --op took for all frames
    #[arg(long, requires = "op")]
    timing: bool,
    /// Prints one JSON object on stdout
    #[arg(long)]
    json: bool,
}

impl Replay {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        if let Some(op) = &self.op
            && print_help(op)?
        {
            return Ok(Outcome::Fine);
        }
        if asks_for_help(&self.faults) {
            return Ok(Outcome::Fine);
        }
        let faults = parse_faults(&self.faults)?;
        let pipeline: Option<Pipeline> = self.op.as_deref().map(str::parse).transpose().context("--op")?;
        if pipeline.is_some() && self.out.is_none() {
            bail!("--op makes pictures; say with `--out DIR` where to");
        }
        let mut runner = pipeline.as_ref().map(Runner::new);
        let bus = parse_bus(&self.bus_latency)?;
        let map = self.map.as_deref().map(SignalMap::parse).transpose()?.unwrap_or_default();
        let by = profile_for(&self.trace, self.profile.as_deref(), &map)?;
        let source = Source::open_with(&self.trace, by.profile.as_ref(), by.map, self.min_pulse)?;
        for note in by.notes.iter().chain(source.notes()) {
            eprintln!("note: {note}");
        }
        if let Some(out) = &self.out {
            std::fs::create_dir_all(out)
                .with_context(|| format!("{}: the folder cannot be made", out.display()))?;
        }
        let broken = Broken { faults: &faults, seed: self.seed };
        let report = replay(&source, broken, bus, self.out.as_deref(), runner.as_mut())?;
        if let (Some(runner), true) = (&runner, self.timing) {
            print_timing(runner);
        }
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            println!("{report}");
            if let Some(out) = &self.out {
                println!("pictures       {}", out.display());
            }
        }
        Ok(if report.is_good() { Outcome::Fine } else { Outcome::Fault })
    }
}

/// Plays a source, broken as it is said, into block and driver. Frames are written to `out`, and once more as `runner` makes them.
pub(super) fn replay(
    source: &Source,
    broken: Broken<'_>,
    bus: firmware::camif::Bus,
    out: Option<&std::path::Path>,
    runner: Option<&mut Runner<'_>>,
) -> anyhow::Result<Report> {
    let profile = source.profile();
    let bar = progress::bytes("replay", source.trace().info().file_bytes);
    let mut collector = Collector::new(profile, out, runner);
    let started = Instant::now();
    let (played, summary) =
        receive(&capture_config(profile), bus, &mut |frame| collector.take(&frame), |receiver| {
            let mut progress = |bytes| bar.set_position(bytes);
            if broken.faults.is_empty() {
                return Ok(source.play(receiver, &mut progress)?);
            }
            let mut injector = broken.before(profile, receiver)?;
            for fault in injector.faults() {
                eprintln!("note: {fault}");
            }
            let played = source.play(&mut injector, &mut progress);
            let Ok(_) = injector.finish();
            Ok::<_, anyhow::Error>(played?)
        })
        .with_context(|| format!("profile {}", profile.name))?;
    let seconds = started.elapsed().saturating_sub(collector.aside).as_secs_f64();
    bar.finish_and_clear();
    let played = played?;
    if let Some(error) = collector.error {
        return Err(error);
    }
    let mut report = Report::new(source.trace().path(), profile, collector.frames, &summary, seconds);
    report.unknown_levels = played.unknown;
    report.clock = ClockReport::of(source.trace(), played.dropped_pulses);
    Ok(report)
}
