//! One list of exercises, one result: what the images say in QEMU is what the host makes of the same.
//!
//! The images' messages are those in their snapshots, which `cargo xtask qemu` holds them to.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use camif_tests::on_core::replay::Vision;
use camif_tests::on_core::{pictures, replay, traces};
use exercise::Workspace;
use exercise::replay::check::Check;
use exercise::replay::consumer;
use exercise::replay::faults::FAULTS;
use exercise::replay::scenario::{CANNY, FRAMES, PALETTE, SOBEL, Scenario};
use firmware::driver::deadline::{Cause, Evidence, Timeout};
use firmware::driver::verdict::Outcome;
use host_sim::receiver::capture_config;

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

/// The host's words for some scenarios are the images', to the last register access.
fn same(image: &str, made: &[String]) {
    for board in ["an386", "an500"] {
        let told = messages(board, image);
        for (told, made) in told.iter().zip(made) {
            assert_eq!(told, made, "{board} on the left, this host on the right");
        }
        assert_eq!(told.len(), made.len(), "{board}");
    }
}

#[test]
fn the_driver_does_the_same_for_whole_frames() {
    same("qemu_replay", &replay::fault(&FRAMES).unwrap());
}

#[test]
fn the_driver_does_the_same_whatever_goes_wrong() {
    let made: Vec<_> = FAULTS.iter().flat_map(|scenario| replay::fault(scenario).unwrap()).collect();
    same("qemu_faults", &made);
}

/// All that can be wrong with a frame, and all that can keep one from coming: each was put in, seen, and recovered from.
#[test]
fn every_fault_that_the_driver_knows_is_put_in() {
    let seen: BTreeSet<&str> = FAULTS.iter().flat_map(|scenario| scenario.seen.iter().copied()).collect();
    let expected = 1;
    let outcomes = [
        Outcome::Short { expected },
        Outcome::Long { expected },
        Outcome::LineCount { expected },
        Outcome::LineLength { expected },
        Outcome::LinesDropped { lines: 1 },
        Outcome::Overrun,
        Outcome::SyncError,
        Outcome::DmaError,
        Outcome::DmaStalled,
        Outcome::LateInterrupt,
    ];
    for outcome in outcomes {
        // Whoever adds an outcome finds that it is missing here.
        match outcome {
            Outcome::Good => unreachable!("nothing is wrong with it"),
            Outcome::Short { .. }
            | Outcome::Long { .. }
            | Outcome::LineCount { .. }
            | Outcome::LineLength { .. }
            | Outcome::LinesDropped { .. }
            | Outcome::Overrun
            | Outcome::SyncError
            | Outcome::DmaError
            | Outcome::DmaStalled
            | Outcome::LateInterrupt => {}
        }
        assert!(seen.contains(consumer::outcome(outcome)), "{outcome} is in no scenario");
    }
    // Frames without data (`NoData`) end as short ones on this block; that capture is stopped or refused is no fault.
    let causes = [
        Cause::NoClock,
        Cause::NoVsync,
        Cause::ShortFrame { expected },
        Cause::DmaStalled,
        Cause::Overrun { overruns: 1 },
        Cause::Damaged(Outcome::Long { expected }),
        Cause::Unfinished { words: 1, expected },
        Cause::NoBuffer,
    ];
    for cause in causes {
        let timeout = Timeout { cause, evidence: Evidence::default() };
        assert!(seen.contains(consumer::cause(&timeout)), "{cause} is in no scenario");
    }
}

#[test]
fn every_fault_is_recovered_from() {
    let failed: Vec<String> =
        FAULTS.iter().filter_map(|scenario| replay::fault(scenario).err()).map(|e| e.to_string()).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n\n"));
}

#[test]
fn the_driver_and_the_vision_do_the_same_for_lines() {
    let made = |scenario: &Scenario| {
        replay::lines(scenario, Vision::Pipeline, &mut Check::new(scenario, &[])).unwrap()
    };
    same("qemu_sobel", &made(&SOBEL));
    same("qemu_canny", &made(&CANNY));
    same("qemu_palette", &made(&PALETTE));
}

#[test]
fn the_scenarios_say_what_their_profiles_say() {
    for scenario in [SOBEL, CANNY, PALETTE, FRAMES].iter().chain(&FAULTS) {
        let (ours, theirs) = (scenario.config(), capture_config(&traces::profile(scenario).unwrap()));
        assert_eq!((ours.sync, ours.geometry()), (theirs.sync, theirs.geometry()), "{}", scenario.name);
        assert_eq!((ours.edge, ours.bus_width), (theirs.edge, theirs.bus_width), "{}", scenario.name);
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

/// Beside code: a whole VGA RGB888 frame through capture and Sobel in 32 KiB, through Canny in 128 KiB. The stack comes
/// on top.
#[test]
fn the_statics_of_the_pipelines_fit() {
    for (image, most) in [("qemu_sobel", 32 << 10), ("qemu_palette", 40 << 10), ("qemu_canny", 128 << 10)] {
        let path = top().join(format!("firmware/boards/mps2/snapshots/{image}.size"));
        let text = std::fs::read_to_string(path).unwrap();
        let sizes: Vec<u32> =
            text.lines().filter_map(|line| line.strip_prefix("ram ")?.parse().ok()).collect();
        assert!(!sizes.is_empty() && sizes.iter().all(|&ram| ram <= most), "{image}: {sizes:?}");
    }
}
