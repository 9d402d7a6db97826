//! Frames a second and processor time, beside `v4l2-ctl --stream-mmap`: `tests/vm/run --numbers`.

use camif_vm::command::{host_sim, run};

use crate::{ONE, cameras};

/// Hundredths of a second of processor that all children have taken so far, in themselves and in the kernel.
fn children() -> (u64, u64) {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap().split_whitespace().collect();
    (fields[13].parse().unwrap(), fields[14].parse().unwrap())
}

/// What it took, in milliseconds a frame.
fn measured<T>(frames: u64, what: impl FnOnce() -> T) -> (T, [f64; 2]) {
    let before = children();
    let result = what();
    let after = children();
    (result, [after.0 - before.0, after.1 - before.1].map(|ticks| ticks as f64 * 10.0 / frames as f64))
}

#[test]
#[ignore = "tests/vm/run --numbers"]
fn numbers() {
    cameras();
    println!("{:24} {:>12} {:>8} {:>14} {:>14}", "", "granted", "got", "user ms/frame", "kernel ms/frame");
    for (size, code, rate, frames) in [
        ("640x480", "YUYV", "60", 250),
        ("640x480", "RGB3", "60", 250),
        ("1920x1080", "YUYV", "60", 50),
        ("1920x1080", "RGB3", "60", 50),
    ] {
        let (width, height) = size.split_once('x').unwrap();
        let count = frames.to_string();
        for round in 0..3 {
            let ours = || {
                let asked = [
                    "capture", "--v4l2", ONE, "--size", size, "--format", code, "--rate", rate, "--frames",
                    &count,
                ];
                host_sim(&[&asked[..], &["--json"]].concat()).expect(0).device()
            };
            let theirs = || {
                let ask = format!("--set-fmt-video=width={width},height={height},pixelformat={code}");
                let count = format!("--stream-count={frames}");
                let rate = format!("--set-parm={rate}");
                run("v4l2-ctl", &["-d", ONE, &ask, &rate, "--stream-mmap=8", &count, "--verbose"]).expect(0)
            };
            // Either goes first in turn.
            let (mut first, mut second) = (None, None);
            if round % 2 == 1 {
                second = Some(measured(frames, theirs));
            }
            first.get_or_insert_with(|| measured(frames, ours));
            let (theirs, spent) = second.take().unwrap_or_else(|| measured(frames, theirs));
            let (ours, our_time) = first.unwrap();
            // Its lines end in "sequence: N … fps: F dropped: D"; the last mean is what it shows.
            let said = format!("{}{}", theirs.stdout, theirs.stderr);
            let lines = said.lines().filter(|line| line.contains("fps"));
            let fps = lines
                .filter_map(|line| line.split("fps").next()?.split_whitespace().last().map(str::to_owned))
                .next_back();
            let dropped = said.lines().filter(|line| line.contains("dropped")).count();
            println!(
                "{size:10} {code} host-sim  {:>12.2} {:>8.2} {:>14.2} {:>14.2}   {} lost",
                ours["rate"].as_f64().unwrap(),
                ours["frames_per_second"].as_f64().unwrap(),
                our_time[0],
                our_time[1],
                ours["lost"]
            );
            println!(
                "{size:10} {code} v4l2-ctl  {:>12} {:>8} {:>14.2} {:>14.2}   {dropped} lines with drops",
                "",
                fps.unwrap_or_default(),
                spent[0],
                spent[1]
            );
            if round == 0 {
                println!("{}", said.lines().rev().take(3).collect::<Vec<_>>().join("\n"));
            }
        }
    }
}
