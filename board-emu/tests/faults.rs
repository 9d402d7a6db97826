//! Every class of faults, in front of our driver on an emulated board and in front of the same driver on the host: both
//! hand out the same frames, byte by byte, with the same verdicts, and end with the same counts.
//!
//! Two things differ, and why is known:
//! - How many lines, and how long, is read off the DMA's position on a part without counters. The host's DMA fetches in
//!   bursts, the emulated one at once, so these numbers lie within what the driver promises of them, and are not compared.
//! - The host's handler takes no time. Where a frame begins within the few microseconds that a core needs to serve the end of
//!   the one before ([`SUDDEN`]), the board gives the second one up, and counts it.
//!
//! The image is `board-emu/images/camif-dcmi`, which writes what came of each frame on its serial port.

mod common;

use std::fmt::Write;

use board_emu::board::Kind;
use board_emu::camera::Camera;
use board_emu::footage::Footage;
use board_emu::report::Ending;
use board_emu::run::Plan;
use common::{BOARDS, footage, image, profile};
use firmware::camif::{Bus, Hold, Stall};
use firmware::trace::StretchSink;
use host_sim::fault::{FaultKind, FaultSpec};
use host_sim::profile::Choice;
use host_sim::receiver::{capture_config, receive_on};

/// Frames of a run.
const FRAMES: u64 = 6;

/// Classes in which a frame ends and the next one begins at once.
const SUDDEN: [FaultKind; 1] = [FaultKind::SpuriousVsync];

/// A verdict's line without the number and the length of the lines.
fn comparable(line: &str) -> String {
    match (line.find(" in "), line.find(')')) {
        (Some(from), Some(to)) if from < to => format!("{}{}\n", &line[..from], &line[to..]),
        _ => format!("{line}\n"),
    }
}

/// What the image writes, by the driver on the host.
fn on_the_host(board: Kind, mut footage: Footage, bus: Bus) -> String {
    let mut text = String::new();
    let config = capture_config(&profile());
    let mut on_frame = |received: host_sim::receiver::Received<'_>| {
        if let Some(bytes) = received.bytes {
            let (verdict, crc) = (received.verdict, host_sim::picture::crc32(bytes));
            let (overruns, dropped) = (verdict.overruns, verdict.dropped_before);
            writeln!(text, "{verdict}, CRC-32 {crc:08x}, {overruns} overruns and {dropped} frames before it")
                .unwrap();
        }
    };
    let (_, summary) = receive_on(board.part(), &config, bus, None, &mut on_frame, |receiver| {
        while let Some((sync, samples)) = footage.ahead() {
            let clocks = samples.len();
            receiver.stretch(sync, samples).unwrap();
            footage.advance(clocks);
        }
    })
    .unwrap();
    writeln!(text, "{:?}", summary.statistics).unwrap();
    text.lines().map(comparable).collect()
}

/// What the image writes on the board. Of the counts only the last line, for it writes them whenever it waits.
fn on_the_board(board: Kind, footage: Footage, pclk_hz: u32, bus: Bus) -> Option<String> {
    let image = image("camif-dcmi", board)?;
    let camera = Camera::recorded(footage, pclk_hz);
    let plan = Plan { bus, ..Plan::new(board, image, camera) };
    let report = plan.run(None).unwrap();
    assert_eq!(report.ending, Ending::Done, "{report}");
    assert!(report.unexpected().next().is_none(), "{report}");
    let text = String::from_utf8(report.serial).unwrap();
    let (counts, frames): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| line.starts_with("Statistics"));
    Some(frames.into_iter().chain(counts.last().copied()).map(comparable).collect())
}

/// A number of the last line.
fn count(text: &str, name: &str) -> u64 {
    let from = text.rsplit(&format!("{name}: ")).next().unwrap_or_default();
    from.split([',', ' ']).next().and_then(|number| number.parse().ok()).unwrap()
}

/// The board's frames are the host's, some left out, and all that are left out are counted as lost.
fn left_out_and_counted(host: &str, board: &str) -> bool {
    let bare = |line: &str| line.split(" overruns and ").next().unwrap_or_default().to_owned();
    let frames = |text: &str| -> Vec<String> {
        text.lines().filter(|line| line.starts_with("frame ")).map(bare).collect()
    };
    let (all, some) = (frames(host), frames(board));
    let mut rest = all.iter();
    let in_order = some.iter().all(|frame| rest.any(|other| other == frame));
    let passed = |text: &str| count(text, "delivered") + count(text, "lost");
    in_order && some.len() as u64 == count(board, "delivered") && passed(host) == passed(board)
}

#[test]
fn every_class_of_faults_ends_as_it_does_on_the_host() {
    let mut differences = String::new();
    let (mut compared, mut damaged) = (0, 0);
    for board in BOARDS {
        for &(name, kind) in FaultKind::NAMES {
            let spec: FaultSpec = name.parse().unwrap();
            let (footage, _, pclk_hz) = match footage(FRAMES, &[spec]) {
                Ok(played) => played,
                Err(refusal) => {
                    println!("{name}: not with this camera: {refusal}");
                    continue;
                }
            };
            let host = on_the_host(board, footage.clone(), Bus::IDEAL);
            let Some(emulated) = on_the_board(board, footage, pclk_hz, Bus::IDEAL) else { return };
            compared += 1;
            damaged +=
                u32::from(host.lines().filter(|line| line.contains(": good ")).count() as u64 != FRAMES);
            let alike = host == emulated || SUDDEN.contains(&kind) && left_out_and_counted(&host, &emulated);
            if !alike {
                writeln!(differences, "{} {kind}: host\n{host}board\n{emulated}", board.name()).unwrap();
            }
        }
    }
    assert!(differences.is_empty(), "{differences}");
    assert!(compared >= 40 && damaged >= 20, "{compared} compared, {damaged} of them damaged");
}

#[test]
fn a_slow_bus_loses_the_same_frames_as_on_the_host() {
    let held = |request| Bus { hold: Some(Hold { request, clocks: 60 }), ..Bus::IDEAL };
    let stall = Some(Stall { one_in: 800, clocks: 60 });
    let cases = [
        ("late, but never too late", Bus { latency_max: 3, seed: 7, ..Bus::IDEAL }, 0..=0),
        ("held for longer than the FIFO lasts, in the first frame", held(100), 1..=1),
        ("held in the second", held(2_000), 1..=1),
        ("stalls now and then", Bus { latency_max: 2, stall, seed: 3, ..Bus::IDEAL }, 2..=12),
        ("stands still", Bus { latency_min: 1 << 30, latency_max: 1 << 30, ..Bus::IDEAL }, 6..=12),
    ];
    for (case, bus, expected) in cases {
        for board in BOARDS {
            let (footage, _, pclk_hz) = footage(FRAMES, &[]).unwrap();
            let host = on_the_host(board, footage.clone(), bus);
            let Some(emulated) = on_the_board(board, footage, pclk_hz, bus) else { return };
            assert!(expected.contains(&count(&host, "overruns")), "{case}: {host}");
            assert_eq!(emulated, host, "{case}, {}", board.name());
        }
    }
}
