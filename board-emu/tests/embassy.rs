//! An application that is not ours, on embassy's own `Dcmi` driver: it captures right frames from the block on both chips,
//! and after an overrun it waits for ever, as it would on the chip, where our driver on the same trace goes on.
//!
//! `cargo xtask board-emu` builds the images and says where they are; without them these tests say that they did nothing.

mod common;

use board_emu::board::Kind;
use board_emu::camera::Camera;
use board_emu::report::{Ending, Report};
use board_emu::run::Plan;
use common::{BOARDS, PCLK_HZ, footage, image};
use firmware::camif::{Bus, Stall};

/// One stall that is longer than the FIFO lasts.
const STALL: Bus = Bus { stall: Some(Stall { clocks: 40, one_in: 1000 }), seed: 3, ..Bus::IDEAL };

/// Runs an image against frames of the demo scene; also the bytes that were sent, a frame each.
fn run(name: &str, board: Kind, frames: u64, bus: Bus) -> Option<(Report, Vec<Vec<u8>>)> {
    let image = image(name, board)?;
    let (footage, sent, _) = footage(frames, &[]).unwrap();
    let camera = Camera::recorded(footage, PCLK_HZ);
    let plan = Plan { bus, deadline: 5_000_000_000, ..Plan::new(board, image, camera) };
    Some((plan.run(None).unwrap(), sent))
}

#[test]
fn embassys_driver_captures_the_frames_that_were_sent() {
    for board in BOARDS {
        let Some((report, sent)) = run("embassy-dcmi", board, 12, Bus::IDEAL) else { return };
        assert!(report.is_fine(), "{report}");
        assert_eq!((report.ending, report.overruns), (Ending::Done, 0));
        // While a frame goes out over the serial port, others pass by.
        let received: Vec<&[u8]> = report.serial.chunks(4 + 160 * 120).collect();
        assert!(received.len() >= 2, "{} frames", received.len());
        let mut later = sent.iter();
        for frame in received {
            let (header, bytes) = frame.split_at(4);
            assert_eq!(header, b"FRAM");
            assert!(
                later.any(|sent| sent == bytes),
                "{}: a frame that was not sent, or out of order",
                board.name()
            );
        }
    }
}

#[test]
fn after_an_overrun_embassys_driver_hangs_where_ours_captures_all_but_the_frame_that_was_hit() {
    for board in BOARDS {
        let Some((report, _)) = run("embassy-dcmi", board, 12, STALL) else { return };
        assert_eq!((report.ending, report.overruns, report.serial_bytes), (Ending::Hung, 1, 0), "{report}");
        assert!(!report.is_fine());
        assert_eq!(report.core.state, "asleep", "{report}");
        let at = report.core.at.as_deref().unwrap_or_default();
        assert!(at.contains(" in "), "{report}");

        let Some((report, sent)) = run("camif-dcmi", board, 12, STALL) else { return };
        assert!(report.is_fine() && report.ending == Ending::Done && report.overruns > 0, "{report}");
        let text = String::from_utf8_lossy(&report.serial);
        let crcs: Vec<u32> = sent.iter().map(|bytes| host_sim::picture::crc32(bytes)).collect();
        let good: Vec<usize> = text
            .lines()
            .filter(|line| line.contains(": good "))
            .map(|line| {
                let crc = line.split("CRC-32 ").nth(1).and_then(|rest| rest.get(..8)).unwrap();
                let crc = u32::from_str_radix(crc, 16).unwrap();
                crcs.iter().position(|&sent| sent == crc).unwrap_or_else(|| panic!("{line}: never sent"))
            })
            .collect();
        // Each overrun costs its own frame, and none is followed by another lost one.
        let lost = 12 - good.len() as u64;
        assert!(
            good.is_sorted() && lost >= 1 && lost <= report.overruns,
            "{good:?} with {}",
            report.overruns
        );
    }
}
