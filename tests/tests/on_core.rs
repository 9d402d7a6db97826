//! One list of exercises, one result: what the images say in QEMU is what the host makes of the same.
//!
//! The images' messages are those in their snapshots, which `cargo xtask qemu` holds them to.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use camif_tests::on_core::pictures;
use exercise::Workspace;

static SPACE: Mutex<Workspace> = Mutex::new(Workspace::new());

fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// The messages of an image on a machine.
fn messages(board: &str, image: &str) -> Vec<String> {
    let path = top().join(format!("firmware/boards/mps2/snapshots/{board}/{image}.out"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().map(str::to_owned).collect()
}

#[test]
fn every_algorithm_makes_the_same_on_x86_64_and_on_cortex_m4_and_m7() {
    let mut space = SPACE.lock().unwrap();
    pictures::prepare(&mut space).unwrap();
    let mut made = Vec::new();
    for exercise in exercise::all() {
        let done = (exercise.run)(&mut space, &mut ()).unwrap();
        made.push(format!("{}: {:08x} of {}", exercise.name, done.checksum, done.units));
    }
    for board in ["an386", "an500"] {
        let told: Vec<String> = messages(board, "qemu_algorithms").into_iter().skip(1).collect();
        for (told, made) in told.iter().zip(&made) {
            assert_eq!(told, made, "{board} on the left, this host on the right");
        }
        assert_eq!(told.len(), made.len(), "{board}");
    }
}

#[test]
fn no_two_exercises_have_one_name() {
    let names: BTreeSet<_> = exercise::all().map(|exercise| exercise.name).collect();
    assert_eq!(names.len(), exercise::all().count());
}

/// What is public and no algorithm of its own, but a part that the exercises reach through others.
const PARTS: [&str; 8] = [
    "check_width",   // of the line filters
    "shifted",       // of the windows
    "Then",          // the chain behind `open` and `close`
    "gaussian3_row", // the kernel of Gaussian3
    "gaussian5_row", // the kernel of Gaussian5
    "text_size",     // a measure
    "in_xyz",        // `in_rgb` calls it
    "as_pixels",     // a view
];

/// The names of free functions and of line filters in a file of Rust, up to its tests.
fn algorithms(source: &str) -> Vec<String> {
    let name =
        |rest: &str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("").to_owned();
    let mut found = Vec::new();
    for line in source.lines().take_while(|line| !line.starts_with("#[cfg(test)]")) {
        if let Some(rest) = line.strip_prefix("pub fn ") {
            found.push(name(rest));
        } else if line.starts_with("impl")
            && let Some((_, rest)) = line.split_once("LineFilter for ")
        {
            found.push(name(rest));
        }
    }
    found
}

fn sources(folder: &Path, all: &mut Vec<(PathBuf, String)>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, all);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            all.push((path, text));
        }
    }
}

/// Whoever adds an algorithm adds its exercise.
#[test]
fn no_public_algorithm_is_without_an_exercise() {
    let (mut library, mut exercises) = (Vec::new(), Vec::new());
    sources(&top().join("algos-nostd/src"), &mut library);
    sources(&top().join("tests/exercise/src"), &mut exercises);
    let words: BTreeSet<&str> = exercises
        .iter()
        .flat_map(|(_, text)| text.split(|c: char| !c.is_alphanumeric() && c != '_'))
        .collect();
    let (mut missing, mut excused) = (Vec::new(), BTreeSet::new());
    for (path, text) in &library {
        for name in algorithms(text) {
            if words.contains(name.as_str()) {
                continue;
            }
            match PARTS.iter().find(|part| **part == name) {
                Some(part) => _ = excused.insert(part),
                None => missing.push(format!("{name} in {}", path.display())),
            }
        }
    }
    assert_eq!(missing, [""; 0]);
    assert_eq!(excused, PARTS.iter().collect(), "every excuse is needed");
}
