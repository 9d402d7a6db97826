//! An application that is not ours, on embassy's own `Dcmi` driver: it captures right frames from the block on both chips,
//! and after an overrun it waits for ever, as it would on the chip.
//!
//! `cargo xtask board-emu` builds the images and says where they are; without them these tests say that they did nothing.

use std::path::PathBuf;

use board_emu::board::Kind;
use board_emu::camera::Camera;
use board_emu::footage::Footage;
use board_emu::report::{Allowed, Ending, Report};
use board_emu::run::Plan;
use board_emu::serial::FarEnd;
use firmware::camif::{Bus, Stall};
use host_sim::profile::Profile;
use host_sim::scene::Scene;
use host_sim::sensor::Sensor;

const BOARDS: [Kind; 2] = [Kind::Stm32h743, Kind::Stm32f429];

const PROFILE: &str = r#"
[bus]
bits = 8
clock_edge = "rising"
sync = "gated"
hsync_blank = "low"
vsync_blank = "high"
[frame]
width = 160
height = 120
format = "gray8"
[timing]
pclk_hz = 1_000_000
hblank = 40
vblank = 4000
"#;

/// The image, if it has been built.
fn image(board: Kind) -> Option<PathBuf> {
    let folder = std::env::var_os("CAMIF_IMAGES")?;
    let path = PathBuf::from(folder).join(format!("embassy-dcmi-{}.elf", board.name()));
    assert!(path.is_file(), "{} is not there", path.display());
    Some(path)
}

/// Runs it against frames of the demo scene; also the bytes that were sent, a frame each.
fn run(board: Kind, frames: u64, bus: Bus) -> Option<(Report, Vec<Vec<u8>>)> {
    let Some(image) = image(board) else {
        println!("skipped: CAMIF_IMAGES does not say where the images are (cargo xtask board-emu)");
        return None;
    };
    let mut sensor = Sensor::new(Profile::from_toml(PROFILE).unwrap()).unwrap();
    let (mut footage, mut sent) = (Footage::default(), Vec::new());
    let scene = Scene::named("demo", 0).unwrap();
    sensor.play_watched(frames, &scene, &mut footage, |_, bytes| sent.push(bytes.to_vec())).unwrap();
    let plan = Plan {
        board,
        image,
        camera: Camera::recorded(footage, 1_000_000),
        bus,
        sensor: None,
        serial: FarEnd::memory(),
        deadline: 5_000_000_000,
        allowed: Allowed::of(board),
        gdb: None,
        rtt: None,
    };
    Some((plan.run(None).unwrap(), sent))
}

#[test]
fn embassys_driver_captures_the_frames_that_were_sent() {
    for board in BOARDS {
        let Some((report, sent)) = run(board, 12, Bus::IDEAL) else { return };
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
fn embassys_driver_never_comes_back_from_an_overrun() {
    let stall = Some(Stall { clocks: 40, one_in: 1000 });
    for board in BOARDS {
        let Some((report, _)) = run(board, 12, Bus { stall, seed: 3, ..Bus::IDEAL }) else { return };
        assert_eq!((report.ending, report.overruns, report.serial_bytes), (Ending::Hung, 1, 0), "{report}");
        assert_eq!(report.core.state, "asleep", "{report}");
    }
}
