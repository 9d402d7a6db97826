//! All images on all machines, each compared with its snapshots.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Result, bail};
use camif_tests::on_core;

use crate::audit;
use crate::boards::{self, Image};
use crate::qemu::{self, Board, End, Run};
use crate::size::Size;
use crate::snapshot::{self, Findings, Tolerance};
use crate::stream;
use crate::toolchain::Toolchain;
use crate::top;

/// The package whose images run in QEMU.
const PACKAGE: &str = "mps2";

/// What an image may take at most; the longest takes a tenth of it on an idle machine.
const DEADLINE: Duration = Duration::from_secs(60);

/// A message that tells a measured number: `measured NAME NUMBER`.
const MEASURED: &str = "measured ";

/// What every image measures: how deep its stack went.
pub(crate) const STACK: &str = "stack high-water mark, bytes";

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Images to run; all if none is named
    images: Vec<String>,
    /// The machine; both if none is named
    #[arg(long)]
    board: Option<Board>,
    /// Take what comes out as right
    #[arg(long)]
    bless: bool,
    /// Show every message
    #[arg(long, short)]
    verbose: bool,
}

/// True if all passed.
pub(crate) fn run(options: &Options) -> Result<bool> {
    let toolchain = Toolchain::find()?;
    let images = select(boards::build(&[PACKAGE.to_owned()])?, &options.images)?;
    snapshot::say_if_unblessed(&boards::folder().join(PACKAGE).join("snapshots"), &toolchain.version)?;
    let boards = options.board.map_or(Board::ALL.to_vec(), |board| vec![board]);
    let (mut passed, mut failed) = (0, 0);
    for image in &images {
        if image.name == stream::IMAGE {
            println!("{} runs until somebody ends it: `cargo xtask stream --check`", image.name);
            continue;
        }
        for &board in &boards {
            let findings = check(image, board, &toolchain, options)?;
            let good = findings.failures.is_empty();
            for finding in findings.failures.iter().chain(&findings.notes) {
                println!("  {finding}");
            }
            *(if good { &mut passed } else { &mut failed }) += 1;
        }
    }
    println!("{passed} passed, {failed} failed");
    Ok(failed == 0)
}

/// Runs one image and shows what it says. True if it ended well.
pub(crate) fn run_one(name: &str, board: Board) -> Result<bool> {
    let images = select(boards::build(&[PACKAGE.to_owned()])?, &[name.to_owned()])?;
    let run = start(&images[0], board, &mut |message| println!("{message}"))?;
    println!("{}", told(&run));
    Ok(run.end == End::Success)
}

fn select(images: Vec<Image>, wanted: &[String]) -> Result<Vec<Image>> {
    for name in wanted {
        if !images.iter().any(|image| image.name == *name) {
            let names: Vec<_> = images.iter().map(|image| image.name.as_str()).collect();
            bail!("no image is called {name}; there are {}", names.join(", "));
        }
    }
    let is_wanted = |image: &Image| wanted.is_empty() || wanted.contains(&image.name);
    Ok(images.into_iter().filter(is_wanted).collect())
}

fn start(image: &Image, board: Board, watch: &mut dyn FnMut(&str)) -> Result<Run> {
    let folder = top().join("target/qemu").join(board.name()).join(&image.name);
    on_core::write_inputs(&folder)?;
    qemu::run(board, &image.elf, &folder, DEADLINE, &[], watch)
}

fn told(run: &Run) -> String {
    let end = match &run.end {
        End::Success => "ended well".to_owned(),
        End::Failure(status) => format!("failed ({status})"),
        End::Deadline => format!("was still running after {} s", DEADLINE.as_secs()),
    };
    format!("{end}, {:.1} s", run.took.as_secs_f64())
}

/// Runs an image and compares, or blesses.
fn check(image: &Image, board: Board, toolchain: &Toolchain, options: &Options) -> Result<Findings> {
    let mut show = |message: &str| {
        if options.verbose {
            println!("    {message}");
        }
    };
    let run = start(image, board, &mut show)?;
    println!("{} on {board} {}", image.name, told(&run));
    let mut findings = Findings::default();
    if run.end != End::Success {
        findings.failures.extend(run.messages.iter().rev().take(3).rev().cloned());
        findings.failures.push(told(&run));
        return Ok(findings);
    }
    let (measured, lines): (Vec<_>, Vec<_>) =
        run.messages.iter().partition(|message| message.starts_with(MEASURED));
    let costs: Vec<(String, f64)> = measured.iter().filter_map(|message| number(message)).collect();
    if costs.len() != measured.len() {
        findings.failures.push("a measured number is not a number".to_owned());
    }
    let lines: Vec<String> = lines.into_iter().cloned().collect();
    let used = costs.iter().find(|(name, _)| name == STACK).map(|&(_, bytes)| bytes);
    match (used, audit::stack_bound(image)?) {
        (Some(used), Some(bound)) if used <= f64::from(bound) => {
            println!("  {used} bytes of stack used, {bound} at most");
        }
        (Some(used), Some(bound)) => {
            findings.failures.push(format!("used {used} bytes of stack, and {bound} was the bound"));
        }
        (None, _) => findings.failures.push(format!("does not tell `{MEASURED}{STACK}`")),
        (_, None) => findings.failures.push("has no bound on its stack: see `cargo xtask audit`".to_owned()),
    }
    let size = Size::of(&image.elf)?;
    let sizes = [("flash".to_owned(), size.flash as f64), ("ram".to_owned(), size.ram as f64)];
    let snapshots = snapshots(board);
    let path = |extension: &str| snapshots.join(format!("{}.{extension}", image.name));
    // The image is the same on all machines, and so is its size.
    let size_path = boards::folder().join(PACKAGE).join("snapshots").join(format!("{}.size", image.name));
    let compiler = &toolchain.version;
    if options.bless {
        snapshot::bless(&path("out"), &lines.iter().map(|line| format!("{line}\n")).collect::<String>())?;
        snapshot::bless_numbers(&size_path, compiler, &sizes)?;
        if !costs.is_empty() {
            snapshot::bless_numbers(&path("cost"), compiler, &costs)?;
        }
        return Ok(findings);
    }
    snapshot::compare_lines(&path("out"), &lines, &mut findings)?;
    let tolerance = Tolerance { relative: 0.02, absolute: 256.0 };
    let sizes = sizes.into_iter().collect();
    snapshot::compare_numbers(&size_path, compiler, &sizes, tolerance, &mut findings)?;
    let costs = costs.into_iter().collect();
    snapshot::compare_numbers(&path("cost"), compiler, &costs, Tolerance::EXACT, &mut findings)?;
    Ok(findings)
}

/// `measured gaussian 3 × 3, instructions a pixel 20.5`
fn number(message: &str) -> Option<(String, f64)> {
    let (name, number) = message.strip_prefix(MEASURED)?.rsplit_once(' ')?;
    Some((name.to_owned(), number.parse().ok()?))
}

/// Where the snapshots of a machine lie.
fn snapshots(board: Board) -> PathBuf {
    boards::folder().join(PACKAGE).join("snapshots").join(board.name())
}
