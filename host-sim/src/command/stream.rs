use std::io::Write as _;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};

use super::bring_up::BringUp;
use super::report::grouped;
use super::{Outcome, stop_on_signal};
use crate::guess::profile_for;
use crate::profile::{DEFAULT, Profile};
use crate::receiver::{self, parse_bus};
use crate::scene::{Scene, Still};
use crate::stream::{self, Address, Rates, STREAMS, Settings, Source};
use crate::trace::SignalMap;

/// Options of `stream`.
#[derive(Debug, Args)]
pub struct Stream {
    #[command(flatten)]
    look: Look,
    #[command(flatten)]
    place: Place,
    /// Built-in profile or TOML file; of a trace the one that it carries, else guessed
    #[arg(long, conflicts_with = "sensor")]
    profile: Option<String>,
    #[command(flatten)]
    bring_up: BringUp,
    /// Rate of the line, ten bits a byte, such as 921600; without, as fast as the bytes are taken
    #[arg(long, value_parser = clap::value_parser!(u32).range(300..))]
    baud: Option<u32>,
    /// What goes wrong on the line, both ways: rates of bits (flipped), lost (packets), dropped and inserted (bytes), for
    /// instance bits=1e-5,lost=0.01
    #[arg(long, value_name = "KEY=RATE,…", default_value = "bits=0")]
    noise: Rates,
    /// Seed of the noise, and of the scenes that have noise
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Frames a second; without, those of the profile
    #[arg(long, value_name = "FPS", value_parser = frames_a_second)]
    rate: Option<f64>,
    /// Streams that are on at the start
    #[arg(long, value_enum, value_delimiter = ',', default_value = "raw,edges,palette")]
    streams: Vec<Name>,
    /// The pipeline of a stream, for instance edges=gray|sobel; may be given often. `host-sim process --op help` lists the stages
    #[arg(long, value_name = "STREAM=PIPELINE", value_parser = stages)]
    stages: Vec<(Name, String)>,
    /// Pixel clocks from DMA request to grant: MIN or MIN..MAX, then ,stall=CLOCKS/ONE_IN and ,seed=N
    #[arg(long, value_name = "LATENCY", default_value = "0")]
    bus_latency: String,
    /// Waits for the command START instead of capturing from the start
    #[arg(long)]
    stopped: bool,
    /// Ends after so many frames; without, with Ctrl-C
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    frames: Option<u64>,
}

/// What the device sees.
#[derive(Debug, Args)]
#[group(multiple = false)]
struct Look {
    /// A trace, which is played over and over, instead of a scene
    #[arg(conflicts_with_all = ["sensor", "rate"])]
    trace: Option<PathBuf>,
    /// A PNG or JPEG picture
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// A built-in scene: demo (the default), bars, checker, gradient, moving, noise
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
}

/// Where the device can be reached.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Place {
    /// Listens at HOST:PORT, for one host at a time; port 0 takes a free one
    #[arg(long, value_name = "HOST:PORT")]
    tcp: Option<String>,
    /// Opens a pseudo-terminal
    #[arg(long)]
    pty: bool,
}

/// The streams by name, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Name {
    /// Frames as captured
    Raw,
    /// Canny's edges
    Edges,
    /// Sixteen colours
    Palette,
}

fn frames_a_second(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (0.02..=1000.0).contains(rate));
    rate.ok_or_else(|| "frames a second are 0.02 to 1000".to_owned())
}

fn stages(text: &str) -> Result<(Name, String), String> {
    let (name, pipeline) = text.split_once('=').ok_or("write STREAM=PIPELINE, as in edges=gray|sobel")?;
    let name = Name::from_str(name.trim(), true)
        .map_err(|_| format!("no stream is called `{name}`; there are raw, edges, palette"))?;
    Ok((name, pipeline.to_owned()))
}

impl Stream {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        let mut chosen: [Option<String>; STREAMS.len()] = Default::default();
        for (name, pipeline) in &self.stages {
            chosen[*name as usize] = Some(pipeline.clone());
        }
        let address = match &self.place.tcp {
            Some(address) => Address::Tcp(address.clone()),
            None => Address::Pty,
        };
        let settings = Settings {
            address,
            baud: self.baud,
            noise: self.noise,
            seed: self.seed,
            rate: self.rate,
            bus: parse_bus(&self.bus_latency)?,
            on: self.streams.iter().fold(0, |bits, &name| bits | 1 << name as u32),
            stages: chosen,
            running: !self.stopped,
            frames: self.frames,
        };
        let source = self.source()?;
        let stop = stop_on_signal()?;
        let mut printed = Ok(());
        let summary = stream::stream(source, &settings, &stop, &mut |url| {
            let mut out = std::io::stdout().lock();
            printed = writeln!(out, "{url}").and_then(|()| out.flush());
            eprintln!("a device is there; look at it with `camif-inspect view {url}`, end it with Ctrl-C");
        })?;
        printed.context("stdout")?;
        let (frames, bytes) = (summary.frames, grouped(summary.bytes));
        let damage = summary.damage;
        eprintln!("sent {frames} frames, {bytes} bytes in {:.1} s", summary.seconds);
        if self.noise != Rates::default() {
            let (bits, lost) = (damage.bits, damage.lost);
            let (dropped, inserted) = (damage.dropped, damage.inserted);
            eprintln!(
                "flipped {bits} bits, lost {lost} packets and {dropped} bytes, inserted {inserted} bytes"
            );
        }
        Ok(Outcome::Fine)
    }

    fn source(&self) -> anyhow::Result<Source> {
        if let Some(path) = &self.look.trace {
            let by = profile_for(path, self.profile.as_deref(), &SignalMap::default())?;
            let trace = receiver::Source::open(path, by.profile.as_ref(), by.map)?;
            for note in by.notes.iter().chain(trace.notes()) {
                eprintln!("note: {note}");
            }
            return Ok(Source::Trace(Box::new(trace)));
        }
        let scene = match (&self.look.image, &self.look.scene) {
            (Some(path), _) => Scene::Still(Still::open(path)?),
            (None, name) => Scene::named(name.as_deref().unwrap_or("demo"), self.seed)?,
        };
        if let Some((chip, readout)) = self.bring_up.sensor()? {
            if readout.encoding.name() != readout.encoding.nearest().name() {
                bail!("the link has no format for what this sensor sends; take another --mode");
            }
            return Ok(Source::Scene { scene, profile: readout.profile(), chip: Some(Box::new(chip)) });
        }
        let profile = Profile::find(self.profile.as_deref().unwrap_or(DEFAULT))?;
        if let Scene::Still(still) = &scene
            && let Some(note) = still.scaling_note(profile.frame.width, profile.frame.height)
        {
            eprintln!("note: {note}");
        }
        Ok(Source::Scene { scene, profile, chip: None })
    }
}
