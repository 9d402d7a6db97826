use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use super::Outcome;
use crate::guess::sheet::{SHOWN, contact_sheet};
use crate::guess::{Answer, FileGuess, guess_file};
use crate::picture;
use crate::trace::SignalMap;

/// Options of `guess`.
#[derive(Debug, Args)]
pub struct Guess {
    /// The trace; a profile that it carries is not looked at
    trace: PathBuf,
    /// Which signals are the wires, for instance PCLK=CH0,HSYNC=CH1,D0=CH3
    #[arg(long, value_name = "WIRE=SIGNAL,…")]
    map: Option<String>,
    /// Writes the guessed profile to this file
    #[arg(long, value_name = "FILE.toml")]
    profile_out: Option<PathBuf>,
    /// Writes the rivals side by side to guess.png in this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints one JSON object on stdout
    #[arg(long)]
    json: bool,
}

impl Guess {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        let map = self.map.as_deref().map(SignalMap::parse).transpose()?.unwrap_or_default();
        let guess = guess_file(&self.trace, &map)?;
        if let Some(path) = &self.profile_out {
            picture::write_raw(path, guess.bus.profile.to_toml().as_bytes())?;
        }
        let sheet = self.out.as_ref().map(|out| out.join("guess.png"));
        if let (Some(out), Some(sheet)) = (&self.out, &sheet) {
            std::fs::create_dir_all(out)
                .with_context(|| format!("{}: the folder cannot be made", out.display()))?;
            picture::write_png(sheet, &contact_sheet(&guess.bus))?;
        }
        if self.json {
            println!("{}", serde_json::to_string_pretty(&Answer::new(&self.trace, &guess))?);
        } else {
            print(&guess);
            if let Some(path) = &self.profile_out {
                println!("profile        {}", path.display());
            }
            if let Some(sheet) = &sheet {
                println!("rivals         {}", sheet.display());
            }
        }
        Ok(Outcome::Fine)
    }
}

fn print(FileGuess { bus: guess, map, wires }: &FileGuess) {
    if wires.is_some() {
        println!("wires          --map {map}\n");
    }
    println!("{:>6}  sync", "sure");
    for reading in guess.readings.iter().filter(|reading| reading.confidence > 0).take(SHOWN) {
        println!("{:>6}  {}", percent(reading.confidence), reading.reading);
        println!("        {}", reading.evidence);
    }
    println!("\n{:>6}  {:>12}  format", "sure", "bits/sample");
    for format in guess.formats.iter().filter(|format| format.confidence > 0).take(SHOWN) {
        let bits = format!("{}.{:03}", format.millibits / 1000, format.millibits % 1000);
        println!("{:>6}  {bits:>12}  {format}", percent(format.confidence));
    }
    if !guess.doubts.is_empty() {
        println!();
    }
    for doubt in &guess.doubts {
        println!("doubt          {doubt}");
    }
    println!("\n{}", guess.profile.to_toml());
}

fn percent(per_mille: u32) -> String {
    format!("{}.{} %", per_mille / 10, per_mille % 10)
}
