use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Serialize;

use super::report::grouped;
use super::{Outcome, progress};
use crate::diagnosis::{
    Comparison, Diagnosis, FaultKind, Finding, MOST_CLOCKS, Place, Recording, Sent, compare, diagnose, fix,
};
use crate::guess::{ReadBy, guess_file, profile_for};
use crate::picture;
use crate::profile::Profile;
use crate::receiver::{Source, capture_config, parse_bus, receive};
use crate::report::{self, Subject, junit};
use crate::trace::SignalMap;
use firmware::camif::Bus;

/// Options of `diagnose`.
#[derive(Debug, Args)]
pub struct Diagnose {
    /// The trace, of any format that `replay` reads
    trace: PathBuf,
    /// Built-in profile or TOML file that the trace should fit, or `auto` to guess it; without it the one that the trace carries, else
    /// guessed
    #[arg(long)]
    profile: Option<String>,
    /// Which signals are the wires, for instance PCLK=CH0,HSYNC=CH1,D0=CH3
    #[arg(long, value_name = "WIRE=SIGNAL,…")]
    map: Option<String>,
    /// A frame as the device got it, its bytes as DMA wrote them: says whether wires or receiver are at fault
    #[arg(long, value_name = "FRAME")]
    received: Option<PathBuf>,
    /// Writes the corrected profile and the picture before and after to this folder
    #[arg(long, value_name = "DIR")]
    fix: Option<PathBuf>,
    /// Writes a report to look at: one HTML file with pictures, waveforms and all numbers, which needs no network
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// For the report's FIFO and DMA: pixel clocks from DMA request to grant, as in `replay`
    #[arg(long, value_name = "LATENCY", default_value = "0", requires = "report")]
    bus_latency: String,
    /// Writes JUnit XML for a CI: a test case for each class of faults
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,
    /// Prints one JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// The JSON of `--json`.
#[derive(Serialize)]
struct Report<'a> {
    trace: String,
    profile: &'a str,
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    fixed: Vec<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    report: Option<&'a Path>,
    #[serde(skip_serializing_if = "Option::is_none")]
    junit: Option<&'a Path>,
}

impl Diagnose {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        let bus = parse_bus(&self.bus_latency)?;
        let map = self.map.as_deref().map(SignalMap::parse).transpose()?.unwrap_or_default();
        let ReadBy { profile, map, mut notes } = profile_for(&self.trace, self.profile.as_deref(), &map)?;
        let asked_to_guess = !notes.is_empty();
        let source = Source::open(&self.trace, profile.as_ref(), map.clone())?;
        notes.extend_from_slice(source.notes());
        for note in &notes {
            eprintln!("note: {note}");
        }
        let profile = source.profile();
        let received = self
            .received
            .as_deref()
            .map(|path| std::fs::read(path).with_context(|| path.display().to_string()))
            .transpose()?;
        let bar = progress::bytes("diagnose", source.trace().info().file_bytes);
        let mut recording = Recording::default();
        source.play(&mut recording, &mut |bytes| bar.set_position(bytes))?;
        bar.finish_and_clear();
        if recording.clocks > MOST_CLOCKS as u64 {
            eprintln!(
                "note: looked at the first {} of {} clocks",
                grouped(MOST_CLOCKS as u64),
                grouped(recording.clocks)
            );
        }
        let mut diagnosis = diagnose(&recording, profile, source.trace().info().pclk_hz);
        if let (Some(clock), false) = (&source.trace().info().clock, asked_to_guess) {
            diagnosis.look_at_edge(clock, profile);
        }
        let frames =
            if received.is_some() || self.fix.is_some() { frames(&source, profile)? } else { Vec::new() };
        if let Some(received) = &received {
            compared(&mut diagnosis, received, &frames, profile, self.received.as_deref())?;
        }
        let fixed = match &self.fix {
            Some(folder) => write_fix(&diagnosis, profile, &source, &frames, folder)?,
            None => Vec::new(),
        };
        let trace = self.trace.display().to_string();
        if let Some(path) = &self.junit {
            picture::write_raw(path, junit(&trace, &profile.name, &diagnosis)?.as_bytes())?;
        }
        if let Some(path) = &self.report {
            // A trace of which nothing can be guessed has a report all the same.
            let guess = match guess_file(&self.trace, &map) {
                Ok(guess) => Some(guess.bus),
                Err(error) if !asked_to_guess => {
                    notes.push(format!("the bus alone suggests nothing: {error}"));
                    None
                }
                Err(_) => None,
            };
            let subject = Subject {
                source: &source,
                recording: &recording,
                diagnosis: &diagnosis,
                guess: guess.as_ref(),
                guess_is_profile: asked_to_guess
                    && guess.as_ref().is_some_and(|guess| guess.profile == *profile),
                received: received.as_deref(),
                notes: &notes,
                bus,
            };
            report::write(&report::build(&subject)?, path)?;
        }
        if self.json {
            let (report, junit) = (self.report.as_deref(), self.junit.as_deref());
            let report =
                Report { trace, profile: &profile.name, diagnosis: &diagnosis, fixed, report, junit };
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            print!("{}", text(&diagnosis, received.is_some()));
            for path in fixed.iter().chain(&self.report).chain(&self.junit) {
                println!("written        {}", path.display());
            }
        }
        Ok(if diagnosis.is_clean() { Outcome::Fine } else { Outcome::Fault })
    }
}

/// Frames kept to compare with: enough to hold the one before and after whatever a device has.
const FRAMES: usize = 16;

/// The first frames as block, driver and an ideal bus receive them.
fn frames(source: &Source, profile: &Profile) -> anyhow::Result<Vec<Sent>> {
    let mut frames: Vec<Sent> = Vec::new();
    let (played, _) = receive(
        &capture_config(profile),
        Bus::IDEAL,
        &mut |frame| {
            if let (Some(bytes), true) = (frame.bytes, frames.len() < FRAMES) {
                frames.push(Sent { bytes: bytes.to_vec(), end: frame.clock });
            }
        },
        |receiver| source.play(receiver, &mut |_| {}),
    )
    .with_context(|| format!("profile {}", profile.name))?;
    played?;
    Ok(frames)
}

/// Puts what the comparison says into the diagnosis.
fn compared(
    diagnosis: &mut Diagnosis,
    received: &[u8],
    frames: &[Sent],
    profile: &Profile,
    path: Option<&Path>,
) -> anyhow::Result<()> {
    match compare(received, frames, profile) {
        Comparison::Same { .. } => {}
        Comparison::Damaged(finding) => {
            if diagnosis.is_clean() {
                diagnosis.place = Place::Receiver;
            }
            diagnosis.findings.retain(|other| other.fault != finding.fault);
            diagnosis.findings.push(*finding);
            diagnosis.findings.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        }
        Comparison::Unrelated => {
            let name = path.unwrap_or(Path::new("the frame")).display();
            bail!(
                "{name}: its {} bytes are none of the trace's {} frames, nor damaged ones; give the bytes of a frame that \
                 passed while the trace was taken, {} of them, as DMA wrote them",
                received.len(),
                frames.len(),
                profile.bytes_per_frame()
            );
        }
    }
    Ok(())
}

/// Writes what the first finding that can be mended changes.
fn write_fix(
    diagnosis: &Diagnosis,
    profile: &Profile,
    source: &Source,
    frames: &[Sent],
    folder: &Path,
) -> anyhow::Result<Vec<PathBuf>> {
    let Some(fix) = diagnosis.findings.iter().find_map(|finding| fix(finding, profile)) else {
        eprintln!("note: nothing to write: no setting mends what was found");
        return Ok(Vec::new());
    };
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
    let mut written = Vec::new();
    let mut path = |name: &str| {
        written.push(folder.join(name));
        folder.join(name)
    };
    picture::write_raw(&path("profile.toml"), fix.profile.to_toml().as_bytes())?;
    if let Some(frame) = frames.first() {
        picture::write_png(&path("before.png"), &picture::decode(&frame.bytes, profile).picture)?;
    }
    // With other levels the frames are others; otherwise these are read anew.
    let again = self::frames(source, &fix.profile)?;
    if let Some(frame) = again.first() {
        let bytes = match fix.samples {
            Some(samples) => samples.apply(&frame.bytes, &fix.profile),
            None => frame.bytes.clone(),
        };
        picture::write_png(&path("after.png"), &picture::decode(&bytes, &fix.profile).picture)?;
    }
    Ok(written)
}

/// The diagnosis for a terminal.
fn text(diagnosis: &Diagnosis, compared: bool) -> String {
    let mut text = String::new();
    let measured = &diagnosis.measured;
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{} clocks, {} frames; lines a frame: {}; samples a line: {}",
        grouped(measured.clocks),
        measured.frames,
        histogram(&measured.lines_a_frame),
        histogram(&measured.samples_a_line)
    );
    if diagnosis.is_clean() {
        let _ = writeln!(
            text,
            "no fault found{}",
            if compared { ": trace and frame are as they should be" } else { "" }
        );
        return text;
    }
    // What is next to impossible is for --json.
    let shown = |(number, finding): &(usize, &Finding)| *number == 0 || finding.confidence >= 0.01;
    for (number, finding) in diagnosis.findings.iter().enumerate().filter(shown) {
        let line = finding.line.map(|line| format!(", line {line}")).unwrap_or_default();
        let _ = writeln!(
            text,
            "\n{}. {} ({:.0} %): {}",
            number + 1,
            finding.fault,
            100.0 * finding.confidence,
            finding.fault.about()
        );
        let _ = writeln!(text, "   where     clock {}{line}", grouped(finding.at_pclk));
        let _ = writeln!(text, "   evidence  {}", wrapped(&finding.evidence.text));
        let _ = writeln!(text, "   remedy    {}", wrapped(&finding.remedy.text));
        for (name, setting) in [("profile", &finding.remedy.profile), ("register", &finding.remedy.register)]
        {
            if let Some(setting) = setting {
                let _ = writeln!(text, "   {name:<9} {setting}");
            }
        }
    }
    let _ = writeln!(text);
    if !diagnosis.ambiguous_with.is_empty() {
        let names: Vec<&str> = diagnosis
            .ambiguous_with
            .iter()
            .map(|kind: &FaultKind| crate::profile::Choice::name(*kind))
            .collect();
        let _ = writeln!(text, "looks just like {}; the trace does not tell them apart", names.join(", "));
    }
    let _ = writeln!(text, "the cause is in: {}", diagnosis.place);
    text
}

/// Words in lines of 100 columns, those after the first under the first.
fn wrapped(text: &str) -> String {
    const INDENT: usize = 13;
    let (mut lines, mut column) = (String::new(), INDENT);
    // A number and its unit stay together.
    for word in text.replace(" %", "\u{a0}%").split(' ').map(|word| word.replace('\u{a0}', " ")) {
        let length = word.chars().count();
        if column > INDENT && column + 1 + length > 100 {
            lines.push('\n');
            lines.push_str(&" ".repeat(INDENT));
            column = INDENT;
        } else if column > INDENT {
            lines.push(' ');
            column += 1;
        }
        lines.push_str(&word);
        column += length;
    }
    lines
}

/// The most frequent numbers of a histogram.
fn histogram(counts: &std::collections::BTreeMap<u64, u64>) -> String {
    let mut sorted: Vec<_> = counts.iter().collect();
    sorted.sort_by_key(|&(number, count)| (std::cmp::Reverse(*count), *number));
    let shown: Vec<String> = sorted
        .iter()
        .take(3)
        .map(
            |(number, count)| {
                if sorted.len() == 1 { number.to_string() } else { format!("{number} ({count} times)") }
            },
        )
        .collect();
    match (shown.is_empty(), sorted.len() > 3) {
        (true, _) => "none".to_owned(),
        (_, more) => format!("{}{}", shown.join(", "), if more { ", …" } else { "" }),
    }
}
