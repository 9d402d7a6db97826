use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use clap::Args;
use firmware::camif::Bus;

use super::Outcome;
use super::broken::Broken;
use super::generate::generate;
use super::replay::replay;
use super::showcase::{Shown, showcase};
use crate::diagnosis::{Recording, diagnose};
use crate::picture;
use crate::profile::{DEFAULT, Profile};
use crate::receiver::Source;
use crate::report::{self, Illustration, Subject};
use crate::scene::Scene;
use crate::trace::SignalMap;

/// Options of `demo`.
#[derive(Debug, Args)]
pub struct Demo {
    /// Folder for the pictures and the trace
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Built-in profile or TOML file
    #[arg(long, default_value = DEFAULT)]
    profile: String,
    /// Frames to take
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..))]
    frames: u64,
    /// Prints one JSON object on stdout
    #[arg(long)]
    json: bool,
}

impl Demo {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        let profile = Profile::find(&self.profile)?;
        let scene = Scene::named("demo", 0)?;
        std::fs::create_dir_all(&self.out)
            .with_context(|| format!("{}: the folder cannot be made", self.out.display()))?;
        let path = self.out.join("demo.camt");
        let mut sent = Vec::new();
        let created = generate(&profile, &scene, self.frames, Broken::default(), &path, &mut |_, bytes| {
            sent.push(picture::crc32(bytes));
        })?;
        let source = Source::open(&created.path, None, SignalMap::default())?;
        let report = replay(&source, Broken::default(), Bus::IDEAL, Some(&self.out), None)?;
        let first = self.out.join("frame-0000.png");
        let shown = if report.is_good() { showcase(&picture::read(&first)?, &self.out)? } else { Vec::new() };
        let html = write_report(&source, &shown, &self.out)?;
        let received: Vec<_> = report.frames.iter().filter_map(|frame| frame.crc32).collect();
        if self.json {
            let mut object = serde_json::to_value(&report)?;
            object["pictures"] = serde_json::to_value(&shown)?;
            object["report"] = serde_json::to_value(&html)?;
            println!("{object:#}");
        } else {
            println!(
                "scene ─► virtual sensor ─► trace ─► camera interface ─► driver ─► pictures\n\n{report}"
            );
        }
        ensure!(
            received == sent,
            "the frames received are not those sent; this is a bug: please report it with {}",
            created.path.display()
        );
        if !self.json {
            println!("verified       every frame received is, byte by byte, the frame that was sent");
            println!("pictures       {} (and the trace, demo.camt)", first.display());
            for shown in &shown {
                println!("               {}: {}", shown.png.display(), shown.about);
            }
            println!("report         {} (open it in a browser)", html.display());
        }
        Ok(if report.is_good() { Outcome::Fine } else { Outcome::Fault })
    }
}

/// Diagnoses the demo's own trace and writes its report, with what the algorithms made of the first frame.
fn write_report(source: &Source, shown: &[Shown], out: &Path) -> anyhow::Result<PathBuf> {
    let mut recording = Recording::default();
    source.play(&mut recording, &mut |_| {})?;
    let diagnosis = diagnose(&recording, source.profile(), source.trace().info().pclk_hz);
    let mut page = report::build(&Subject {
        source,
        recording: &recording,
        diagnosis: &diagnosis,
        guess: None,
        guess_is_profile: false,
        received: None,
        notes: source.notes(),
        bus: Bus::IDEAL,
    })?;
    for shown in shown {
        let picture = page.add(&picture::read(&shown.png)?);
        page.illustrations.push(Illustration {
            about: shown.about.to_owned(),
            how: shown.op.to_owned(),
            picture,
        });
    }
    let path = out.join("report.html");
    report::write(&page, &path)?;
    Ok(path)
}
