use std::path::{Path, PathBuf};

use clap::Args;

use super::bring_up::BringUp;
use super::report::grouped;
use super::{Outcome, progress};
use crate::picture::SizeError;
use crate::profile::{DEFAULT, Profile};
use crate::scene::{Scene, Still};
use crate::sensor::Sensor;
use crate::trace::vcd::VcdWriterOptions;
use crate::trace::{Created, TraceWriterOptions, create};

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
    /// Seed of the scenes that have noise
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The trace to be written; its name ends in .camt, .vcd, .sr, .csv, or .saleae for a folder of binary files
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
        let scene = match (&self.look.image, &self.look.scene) {
            (Some(path), _) => Scene::Still(Still::open(path)?),
            (None, name) => Scene::named(name.as_deref().unwrap_or("demo"), self.seed)?,
        };
        let (profile, created) = match self.bring_up.run()? {
            Some(readout) => {
                let mut frame = |number| Ok(readout.frame_bytes(&scene, number));
                let profile = readout.profile();
                let created = write_frames(&profile, self.frames, &self.output, &mut frame, &mut |_, _| {})?;
                (profile, created)
            }
            None => {
                let profile = Profile::find(&self.profile)?;
                if let Scene::Still(still) = &scene
                    && let Some(note) = still.scaling_note(profile.frame.width, profile.frame.height)
                {
                    eprintln!("note: {note}");
                }
                let created = generate(&profile, &scene, self.frames, &self.output, &mut |_, _| {})?;
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
    output: &Path,
    on_frame: &mut dyn FnMut(u64, &[u8]),
) -> anyhow::Result<Created> {
    let sensor = Sensor::new(profile.clone())?;
    let mut frame = |number| {
        let picture = scene.render(number, profile.frame.width, profile.frame.height);
        sensor.encode(&picture)
    };
    write_frames(profile, frames, output, &mut frame, on_frame)
}

/// Plays frames of a profile, whose bytes `frame` makes, into a trace file.
fn write_frames(
    profile: &Profile,
    frames: u64,
    output: &Path,
    frame: &mut dyn FnMut(u64) -> Result<Vec<u8>, SizeError>,
    on_frame: &mut dyn FnMut(u64, &[u8]),
) -> anyhow::Result<Created> {
    let mut sensor = Sensor::new(profile.clone())?;
    let bits = u8::try_from(profile.bus.bits).unwrap_or(8);
    let mut vcd = VcdWriterOptions::new(bits, profile.timing.pclk_hz);
    vcd.edge = profile.bus.clock_edge;
    let options = TraceWriterOptions {
        vcd,
        vsync_active: profile.bus.vsync_blank.is_high(),
        profile: profile.to_toml(),
    };
    let mut writer = create(output, &options)?;
    let bar = progress::frames("generate", frames);
    for number in 0..frames {
        let bytes = frame(number)?;
        sensor.play_frame_bytes(&bytes, &mut writer).map_err(refused)?;
        on_frame(number, &bytes);
        bar.inc(1);
    }
    sensor.close(&mut writer).map_err(refused)?;
    bar.finish_and_clear();
    Ok(writer.finish()?)
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
