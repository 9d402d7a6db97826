//! Runs operations of ours and of Rust peers on demand, for `bench/peers.py`, which alternates them with the peers
//! that Python has.
//!
//! A command is a line on standard input, and its answer a line on standard output:
//!
//! ```text
//! OPERATION PICTURE REPETITIONS [RESULT]          PICTURE: a file of 640 × 480 raw pixels, or - where none is needed
//! ok 161634 161904 …                              nanoseconds of each repetition, by the wall
//! error: what is wrong
//! ```
//!
//! `RESULT` names a file to write what the last repetition made, so that it can be compared. `list` as a command
//! answers with the names of the operations. Memory is lent and filled before the clock starts; each operation runs
//! once, untimed, before it is repeated.

mod color;
mod draw;
mod gray;
mod quantize;
mod simplify;
mod stopwatch;

use anyhow::{Context, Result, bail, ensure};
use std::collections::HashMap;
use std::io::{BufRead, Write};
use stopwatch::Stopwatch;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Sets itself up over the bytes of a picture, repeats itself, and gives the bytes of its result.
type Operation = fn(&[u8], &mut Stopwatch) -> Result<Vec<u8>>;

/// All operations; those of peers begin with their name.
const OPERATIONS: [(&str, Operation); 26] = [
    ("gaussian", gray::gaussian),
    ("sobel", gray::sobel),
    ("canny", gray::canny),
    ("median", gray::median),
    ("bilateral", gray::bilateral),
    ("unsharp", gray::unsharp),
    ("gray-world", color::gray_world),
    ("matrix", color::matrix),
    ("flood-fill", draw::flood_fill),
    ("imageproc-flood-fill", draw::imageproc_flood_fill),
    ("lines-inside", draw::lines::<1>),
    ("lines-over-scanned", draw::lines::<3>),
    ("clipline-lines-inside", draw::clipline_lines::<1>),
    ("clipline-lines-over-scanned", draw::clipline_lines::<3>),
    ("clips", draw::clips),
    ("clips-one-by-one", draw::clips_one_by_one),
    ("clipline-clips", draw::clipline_clips),
    ("simplify", simplify::ours),
    ("imageproc-simplify", simplify::imageproc),
    ("quantize-fast", quantize::fast),
    ("quantette-wu", quantize::quantette_wu),
    ("quantette-pipeline", quantize::quantette_pipeline),
    ("quantize-quality-16", quantize::quality::<16>),
    ("quantize-quality-256", quantize::quality::<256>),
    ("floyd-steinberg-16", quantize::floyd_steinberg::<16>),
    ("floyd-steinberg-256", quantize::floyd_steinberg::<256>),
];

fn main() -> Result<()> {
    let mut pictures = HashMap::new();
    for command in std::io::stdin().lock().lines() {
        let answer = match answer(&command?, &mut pictures) {
            Ok(answer) => answer,
            Err(error) => format!("error: {error:#}"),
        };
        let mut out = std::io::stdout().lock();
        writeln!(out, "{answer}")?;
        out.flush()?;
    }
    Ok(())
}

fn answer(command: &str, pictures: &mut HashMap<String, Vec<u8>>) -> Result<String> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let (name, path, repetitions, result) = match words[..] {
        ["list"] => return Ok(OPERATIONS.map(|(name, _)| name).join(" ")),
        [name, path, repetitions] => (name, path, repetitions, None),
        [name, path, repetitions, result] => (name, path, repetitions, Some(result)),
        _ => bail!("expected OPERATION PICTURE REPETITIONS [RESULT], got {command:?}"),
    };
    let repetitions: usize = repetitions.parse().with_context(|| format!("{repetitions:?} repetitions"))?;
    ensure!(repetitions > 0, "at least one repetition");
    let (_, operation) = OPERATIONS
        .iter()
        .find(|(known, _)| *known == name)
        .with_context(|| format!("no operation {name:?}; `list` says which there are"))?;
    if !pictures.contains_key(path) {
        let bytes =
            if path == "-" { Vec::new() } else { std::fs::read(path).with_context(|| path.to_owned())? };
        pictures.insert(path.to_owned(), bytes);
    }
    let mut stopwatch = Stopwatch::new(repetitions);
    let made = operation(&pictures[path], &mut stopwatch).with_context(|| name.to_owned())?;
    if let Some(result) = result {
        std::fs::write(result, made).with_context(|| result.to_owned())?;
    }
    Ok(stopwatch.times().iter().fold("ok".to_owned(), |line, time| format!("{line} {}", time.as_nanos())))
}

/// The bytes of a gray picture.
fn gray_pixels(bytes: &[u8]) -> Result<&[u8]> {
    ensure!(bytes.len() == WIDTH * HEIGHT, "a gray picture of {WIDTH} × {HEIGHT}, got {} bytes", bytes.len());
    Ok(bytes)
}

/// The pixels of a picture in colour.
fn rgb_pixels(bytes: &[u8]) -> Result<&[algos_nostd::image::Rgb]> {
    ensure!(
        bytes.len() == WIDTH * HEIGHT * 3,
        "an RGB picture of {WIDTH} × {HEIGHT}, got {} bytes",
        bytes.len()
    );
    Ok(algos_nostd::pixel::rgb888::as_pixels(bytes))
}
