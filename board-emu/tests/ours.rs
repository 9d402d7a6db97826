//! The images that are flashed: from power-up to the last byte on the serial port. What the link's receiver makes of that
//! byte stream is, byte by byte, what the sensor saw.

mod common;

use std::sync::{Arc, Mutex};

use board_emu::board::Kind;
use board_emu::camera::{Camera, Faults};
use board_emu::i2c::SensorOnI2c;
use board_emu::report::{Ending, Report};
use board_emu::run::Plan;
use common::{BOARDS, image};
use firmware::camif::{Bus, Hold};
use firmware::driver::verdict::Outcome;
use firmware::link::{
    Assembler, BODY_MAX, Format, Inbox, Packet, Received, marks_words, picture_bytes, small_table,
};
use host_sim::scene::Scene;
use host_sim::sensor::{Mounting, VirtualSensor};

/// The sensor's clock, in hertz: a third of what the boards give it, for few frames to pass while one is on the serial line,
/// and two within the image's patience of half a second.
const SENSOR_HZ: u32 = 8_000_000;
/// Millions of instructions a second: enough for the handlers, and the wait for each byte on the wire takes less long here.
const MIPS: u32 = 20;

/// A frame as the other end of the link has it.
struct Frame {
    format: Format,
    bytes: Vec<u8>,
}

/// What a run gave.
struct Run {
    report: Report,
    /// The sensor's name, as the image says it.
    name: String,
    frames: Vec<Frame>,
    /// The bytes of every frame that the sensor sent.
    sent: Vec<Vec<u8>>,
    /// Pixels a line, as the sensor's registers say.
    width: u32,
}

/// The image of a board in front of a sensor that looks at a scene.
fn run(board: Kind, sensor: &str, frames: u64, faults: &[&str], bus: Bus) -> Option<Run> {
    let name = match board {
        Kind::Stm32h743 => "camera_h743",
        Kind::Stm32f429 => "camera_f429",
    };
    let image = image(name, board)?;
    let mounting = Mounting { input_hz: SENSOR_HZ, wires: 8, monochrome: false };
    let sensor = Arc::new(Mutex::new(VirtualSensor::new(sensor, mounting).unwrap()));
    let scene = Scene::named("demo", 5).unwrap();
    let specs = faults.iter().map(|text| text.parse().unwrap()).collect();
    let camera = Camera::live(sensor.clone(), scene, Faults { specs, seed: 1 }, frames);
    let on_i2c = Some(SensorOnI2c(sensor.clone()));
    let plan = Plan {
        bus,
        sensor: on_i2c,
        mips: Some(MIPS),
        deadline: 8_000_000_000,
        ..Plan::new(board, image, camera)
    };
    let report = plan.run(None).unwrap();

    let readout = sensor.lock().unwrap().readout().unwrap();
    let scene = Scene::named("demo", 5).unwrap();
    let sent = (0..frames).map(|number| readout.frame_bytes(&scene, number)).collect();
    let (name, frames) = received(&report.serial);
    Some(Run { report, name, frames, sent, width: readout.view.output.0 })
}

/// The whole frames in a byte stream of the link, and the device's name. No packet may be damaged.
fn received(wire: &[u8]) -> (String, Vec<Frame>) {
    let (mut picture, mut marks) =
        (vec![0; picture_bytes(Format::GRAY8, 640, 480) * 2], vec![0; marks_words(480)]);
    let mut assembler = Assembler::new(0, &mut picture, &mut marks, small_table);
    let (mut name, mut frames) = (String::new(), Vec::new());
    let mut room = vec![0; BODY_MAX];
    Inbox::new(&mut room, small_table).feed(wire, |received| {
        let Received::Packet(packet) = received else { panic!("{received:?}") };
        if let Packet::Hello(hello) = &packet {
            name = hello.name.to_owned();
        }
        assembler.push(&packet, &mut |frame| {
            // The run may end within a frame; what came whole is right.
            if let Some(end) = frame.end {
                assert_eq!((frame.crc, frame.missing().count()), (Some(true), 0));
                assert_eq!(end.outcome(), Some(Outcome::Good));
                let bytes = frame.picture.to_vec();
                frames.push(Frame { format: frame.format, bytes });
            }
        });
    });
    (name, frames)
}

impl Run {
    /// Every frame is one that was sent, and they are in order; their numbers among those sent.
    fn numbers(&self) -> Vec<usize> {
        let find = |frame: &Frame| self.sent.iter().position(|sent| *sent == frame.bytes);
        let numbers: Option<Vec<usize>> = self.frames.iter().map(find).collect();
        let numbers = numbers.unwrap_or_else(|| panic!("a frame that was never sent\n{}", self.report));
        assert!(numbers.is_sorted_by(|before, after| before < after), "{numbers:?}\n{}", self.report);
        numbers
    }
}

#[test]
fn what_arrives_is_what_the_sensor_saw_for_two_sensors_and_two_formats() {
    for board in BOARDS {
        let mut formats = Vec::new();
        // The second sends twice as many frames a second.
        for (sensor, frames) in [("ov7670", 24), ("mt9v034", 48)] {
            let Some(run) = run(board, sensor, frames, &[], Bus::IDEAL) else { return };
            assert!(run.report.is_fine() && run.report.ending == Ending::Done, "{sensor}\n{}", run.report);
            assert_eq!((run.report.overruns, run.report.resets), (0, 0), "{sensor}\n{}", run.report);
            assert_eq!((run.name.as_str(), run.width), (sensor, 320), "{}", run.report);
            // While a frame is on the serial line, others pass; a snapshot is one frame, its next one later.
            assert!(run.numbers().len() >= 2, "{sensor}: {} frames\n{}", run.frames.len(), run.report);
            formats.push(run.frames[0].format);
        }
        assert_ne!(formats[0], formats[1]);
    }
}

#[test]
fn damaged_frames_are_kept_back_and_the_image_goes_on() {
    for board in BOARDS {
        // Every frame is damaged.
        for fault in ["missing-clock:count=3", "short-line:count=1,samples=6", "missing-hsync:count=1"] {
            let Some(run) = run(board, "ov7670", 3, &[fault], Bus::IDEAL) else { return };
            assert_eq!((run.report.ending, run.frames.len()), (Ending::Done, 0), "{fault}\n{}", run.report);
            assert!(run.report.is_fine() && run.report.words > 0, "{fault}\n{}", run.report);
        }
        // One is, by a bus that is late once, in the first frame that is captured.
        let held = Bus { hold: Some(Hold { request: 3_000, clocks: 200 }), ..Bus::IDEAL };
        let Some(run) = run(board, "ov7670", 24, &[], held) else { return };
        assert!(run.report.is_fine() && run.report.overruns == 1, "{}", run.report);
        assert!(!run.numbers().is_empty(), "{}", run.report);
    }
}
