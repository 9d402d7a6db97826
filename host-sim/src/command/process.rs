use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, bail};
use clap::Args;

use super::Outcome;
use crate::picture;
use crate::pipeline::{Picture, Pipeline, Runner, help, is_help};

/// Options of `process`.
#[derive(Debug, Args)]
pub struct Process {
    /// A PNG or JPEG picture
    image: Option<PathBuf>,
    /// Stages with | between them, for instance 'gray|canny:low=50,high=150'; help or help:STAGE says which there are
    #[arg(long, value_name = "PIPELINE")]
    op: String,
    /// The PNG picture to be written
    #[arg(short, long, value_name = "IMAGE")]
    output: Option<PathBuf>,
    /// Says on stderr how long each stage took
    #[arg(long)]
    timing: bool,
}

impl Process {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        if print_help(&self.op)? {
            return Ok(Outcome::Fine);
        }
        let pipeline: Pipeline = self.op.parse().context("--op")?;
        let Some(image) = &self.image else {
            bail!("no picture; say `host-sim process IMAGE --op … -o IMAGE`")
        };
        let Some(output) = &self.output else { bail!("nowhere to write to; say `-o IMAGE`") };
        if output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png")) {
            bail!("{}: pictures are written as PNG; give a name that ends in .png", output.display());
        }
        let mut runner = Runner::new(&pipeline);
        let made = runner
            .run(Picture::from_image(&picture::read(image)?))
            .with_context(|| image.display().to_string())?
            .into_image();
        picture::write_png(output, &made)?;
        if self.timing {
            print_timing(&runner);
        }
        println!("{}: {} × {} pixels, by {pipeline}", output.display(), made.width(), made.height());
        Ok(Outcome::Fine)
    }
}

/// Prints help if that is what a pipeline's text asks for.
pub(super) fn print_help(op: &str) -> anyhow::Result<bool> {
    let asked = is_help(op);
    if asked {
        print!("{}", help(op).context("--op")?);
    }
    Ok(asked)
}

/// What each stage took, on stderr.
pub(super) fn print_timing(runner: &Runner<'_>) {
    let mut total = Duration::ZERO;
    for (stage, taken) in runner.timing() {
        eprintln!("{:>10.3} ms  {stage}", taken.as_secs_f64() * 1e3);
        total += taken;
    }
    eprintln!("{:>10.3} ms  in all", total.as_secs_f64() * 1e3);
}
