use std::path::{Path, PathBuf};

use clap::Args;
use firmware::trace::StretchSink;

use super::bring_up::BringUp;
use super::broken::{Broken, asks_for_help, parse_faults, trace_writer};
use super::report::grouped;
use super::{Outcome, progress};
use crate::picture::SizeError;
use crate::profile::{DEFAULT, Profile};
use crate::scene::{Scene, Still};
use crate::sensor::Sensor;
use crate::trace::{Created, TraceError};

/// Options of `generate`.
#[derive(Debug, Args)]
pub struct Generate {
    #[command(flatten)]
    look: Look,
    /// Built-in profile or TOML file
    #[arg(long, default_value = DEFAULT, conflicts_with = "sensor")]
    profile: String,
    #[command(flatten)]
    bring_up: BringUp,
    /// Frames to play
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    frames: u64,
    /// Breaks the trace: a fault, as KIND or KIND:key=value,…; may be given more than once; help lists them
    #[arg(long = "fault", value_name = "KIND[:key=value,…]")]
    faults: Vec<String>,
    /// Seed of the scenes that have noise, and of what is not said of a fault
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The trace to be written; its name ends in .camt, .vcd, .sr, .fst, .csv, or .saleae for a folder of binary files
    #[arg(short, long, value_name = "TRACE")]
    output: PathBuf,
    /// Prints one JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// What the sensor looks at.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Look {
    /// A PNG or JPEG picture
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// A built-in scene: demo, bars, checker, gradient, moving, noise
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
}

impl Generate {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        if asks_for_help(&self.faults) {
            return Ok(Outcome::Fine);
        }
        let faults = parse_faults(&self.faults)?;
        let broken = Broken { faults: &faults, seed: self.seed };
        let scene = match (&self.look.image, &self.look.scene) {
            (Some(path), _) => Scene::Still(Still::open(path)?),
            (None, name) => Scene::named(name.as_deref().unwrap_or("demo"), self.seed)?,
        };
        let (profile, created) = match self.bring_up.run()? {
            Some(readout) => {
                let mut frame = |number| Ok(readout.frame_bytes(&scene, number));
                let profile = readout.profile();
                let created =
                    write_frames(&profile, self.frames, broken, &self.output, &mut frame, &mut |_, _| {})?;
                (profile, created)
            }
            None => {
                let profile = Profile::find(&self.profile)?;
                if let Scene::Still(still) = &scene
                    && let Some(note) = still.scaling_note(profile.frame.width, profile.frame.height)
                {
                    eprintln!("note: {note}");
                }
                let created = generate(&profile, &scene, self.frames, broken, &self.output, &mut |_, _| {})?;
                (profile, created)
            }
        };
        if self.json {
            let report = serde_json::json!({
                "trace": created.path,
                "profile": profile.name,
                "frames": self.frames,
                "pclk": created.clocks,
                "bytes": created.bytes,
            });
            println!("{report:#}");
        } else {
            println!(
                "{}: {} frames of {}, {} pixel clocks, {} bytes",
                created.path.display(),
                self.frames,
                profile.name,
                grouped(created.clocks),
                grouped(created.bytes)
            );
        }
        Ok(Outcome::Fine)
    }
}

/// Plays a scene through a virtual sensor into a trace file. `on_frame` gets each frame's number and bytes as sent.
pub(super) fn generate(
    profile: &Profile,
    scene: &Scene,
    frames: u64,
    broken: Broken<'_>,
    output: &Path,
    on_frame: &mut dyn FnMut(u64, &[u8]),
) -> anyhow::Result<Created> {
    let sensor = Sensor::new(profile.clone())?;
    let mut frame = |number| {
        let picture = scene.render(number, profile.frame.width, profile.frame.height);
        sensor.encode(&picture)
    };
    write_frames(profile, frames, broken, output, &mut frame, on_frame)
}

/// Plays frames of a profile, whose bytes `frame` makes, into a trace file.
fn write_frames(
    profile: &Profile,
    frames: u64,
    broken: Broken<'_>,
    output: &Path,
    frame: &mut dyn FnMut(u64) -> Result<Vec<u8>, SizeError>,
    on_frame: &mut dyn FnMut(u64, &[u8]),
) -> anyhow::Result<Created> {
    let mut make = |number: u64| -> Result<Vec<u8>, SizeError> {
        let bytes = frame(number)?;
        on_frame(number, &bytes);
        Ok(bytes)
    };
    let pclk = profile.timing.pclk_hz;
    if broken.faults.is_empty() {
        let mut writer = trace_writer(profile, pclk, output)?;
        play_frames(profile, frames, &mut make, &mut writer)?;
        return Ok(writer.finish()?);
    }
    let mut injector = broken.into_file(profile, pclk, output)?;
    for fault in injector.faults() {
        eprintln!("note: {fault}");
    }
    play_frames(profile, frames, &mut make, &mut injector)?;
    Ok(injector.finish()?.finish()?)
}

fn play_frames<S: StretchSink<Error = TraceError>>(
    profile: &Profile,
    frames: u64,
    frame: &mut dyn FnMut(u64) -> Result<Vec<u8>, SizeError>,
    sink: &mut S,
) -> anyhow::Result<()> {
    let mut sensor = Sensor::new(profile.clone())?;
    let bar = progress::frames("generate", frames);
    for number in 0..frames {
        sensor.play_frame_bytes(&frame(number)?, sink).map_err(refused)?;
        bar.inc(1);
    }
    sensor.close(sink).map_err(refused)?;
    bar.finish_and_clear();
    Ok(())
}

/// The sink's own words say more than that it refused.
fn refused<E: std::error::Error + Send + Sync + 'static>(
    error: crate::sensor::PlayError<E>,
) -> anyhow::Error {
    match error {
        crate::sensor::PlayError::Sink(error) => error.into(),
        other => anyhow::Error::msg(other.to_string()),
    }
}
