//! Frames a second and processor time, beside `v4l2-ctl --stream-mmap`: `tests/vm/run --numbers`.

use camif_vm::command::{Finished, host_sim, run};

use crate::{ONE, cameras};

/// Milliseconds of processor that all children have taken so far, in themselves and in the kernel, to ten.
fn children() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap().split_whitespace().collect();
    [13, 14].map(|index| 10.0 * fields[index].parse::<f64>().unwrap()).iter().sum()
}

/// What a program did and took.
struct Measured {
    frames_per_second: f64,
    lost: u64,
    /// Processor time, in milliseconds, of a frame after the first: what starting takes is not in it.
    frame_ms: f64,
    start_ms: f64,
}

fn measure(
    frames: u64,
    capture: impl Fn(u64) -> Finished,
    read: impl Fn(&Finished) -> (f64, u64),
) -> Measured {
    let spent = |frames| {
        let before = children();
        let finished = capture(frames).expect(0);
        (finished, children() - before)
    };
    let start_ms = (0..3).map(|_| spent(1).1).fold(f64::INFINITY, f64::min);
    let (finished, all) = spent(frames);
    let (frames_per_second, lost) = read(&finished);
    Measured { frames_per_second, lost, frame_ms: (all - start_ms) / (frames - 1) as f64, start_ms }
}

/// The last mean that `v4l2-ctl --verbose` shows, in lines such as `… seq: 249 … fps: 25.00 …`, and gaps in its numbers.
fn of_v4l2_ctl(finished: &Finished) -> (f64, u64) {
    let said = format!("{}{}", finished.stdout, finished.stderr);
    let after =
        |line: &str, name: &str| line.split_once(name)?.1.split_whitespace().next().map(str::to_owned);
    let sequences: Vec<u64> = said.lines().filter_map(|line| after(line, "seq:")?.parse().ok()).collect();
    let rate = said.lines().filter_map(|line| after(line, "fps:")?.parse().ok()).next_back();
    let lost = sequences.windows(2).map(|pair| pair[1] - pair[0] - 1).sum();
    (rate.unwrap_or(0.0), lost)
}

#[test]
#[ignore = "tests/vm/run --numbers"]
fn numbers() {
    cameras();
    println!("{:28} {:>10} {:>6} {:>10} {:>10}", "", "frames/s", "lost", "ms a frame", "ms to start");
    for (size, code, frames) in [
        ("640x480", "YUYV", 150),
        ("640x480", "RGB3", 150),
        ("1920x1080", "YUYV", 40),
        ("1920x1080", "RGB3", 40),
    ] {
        let (width, height) = size.split_once('x').unwrap();
        let ours = |frames: u64| {
            let count = frames.to_string();
            host_sim(&[
                "capture", "--v4l2", ONE, "--size", size, "--format", code, "--rate", "60", "--frames",
                &count, "--json",
            ])
        };
        let theirs = |frames: u64| {
            let ask = format!("--set-fmt-video=width={width},height={height},pixelformat={code}");
            let count = format!("--stream-count={frames}");
            run("v4l2-ctl", &["-d", ONE, &ask, "--set-parm=60", "--stream-mmap=8", &count, "--verbose"])
        };
        let of_ours = |finished: &Finished| {
            let device = finished.device();
            (device["frames_per_second"].as_f64().unwrap(), device["lost"].as_u64().unwrap())
        };
        // Each goes first in turn.
        let mut rows = vec![
            ("host-sim", measure(frames, ours, of_ours)),
            ("v4l2-ctl", measure(frames, theirs, of_v4l2_ctl)),
        ];
        rows.push(("v4l2-ctl", measure(frames, theirs, of_v4l2_ctl)));
        rows.push(("host-sim", measure(frames, ours, of_ours)));
        rows.sort_by_key(|(program, _)| *program);
        for (program, row) in rows {
            println!(
                "{size:10} {code:5} {program:11} {:>10.2} {:>6} {:>10.2} {:>10.0}",
                row.frames_per_second, row.lost, row.frame_ms, row.start_ms
            );
        }
    }
}

/// What is copied of a frame between the driver's memory and where it goes.
#[test]
#[ignore = "tests/vm/run --numbers"]
fn numbers_of_memory() {
    cameras();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("frames");
    let trace = folder.path().join("trace.camt");
    let (out, trace) = (out.to_str().unwrap(), trace.to_str().unwrap());
    println!("{:28} {:>12} {:>12} {:>14}", "640x480", "a frame", "copied", "made pictures");
    for (what, code, more) in [
        ("RGB3, looked at", "RGB3", &[][..]),
        ("RGB3, --keep raw", "RGB3", &["--out", out, "--keep", "raw"]),
        ("RGB3, --keep png", "RGB3", &["--out", out, "--keep", "png"]),
        ("YUYV, --keep both", "YUYV", &["--out", out]),
        ("NV12, --keep raw", "NV12", &["--out", out, "--keep", "raw"]),
        ("RGB3, --as-trace", "RGB3", &["--as-trace", trace, "--profile", "vga-rgb888"]),
    ] {
        let asked =
            ["capture", "--v4l2", ONE, "--size", "640x480", "--format", code, "--frames", "3", "--json"];
        let device = host_sim(&[&asked[..], more].concat()).expect(0).device();
        let of = |name: &str| device[name].as_u64().unwrap();
        println!(
            "{what:28} {:>12} {:>12} {:>14}",
            of("bytes") / of("taken"),
            of("copied_bytes_per_frame"),
            of("converted_bytes_per_frame")
        );
    }
}
