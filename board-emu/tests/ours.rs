//! The images that are flashed: from power-up to the last byte on the serial port. What the link's receiver makes of that
//! byte stream is, byte by byte, what the sensor saw, and what the host makes of it by the same stages; each command is answered.

mod common;

use std::sync::{Arc, Mutex};

use algos_nostd::quantize::Probe;
use board_emu::board::Kind;
use board_emu::camera::{Camera, Faults};
use board_emu::i2c::SensorOnI2c;
use board_emu::report::{Ending, Report};
use board_emu::run::Plan;
use board_emu::serial::FarEnd;
use common::{BOARDS, image};
use firmware::camif::{Bus, Hold};
use firmware::driver::verdict::Outcome;
use firmware::link::packet::{Meaning, State, Status};
use firmware::link::{
    Assembler, BODY_MAX, Format, Framer, Inbox, Packet, Received, Request, Resend, marks_words,
    picture_bytes, small_table, wire_bytes,
};
use firmware::pipeline::{Pipeline, Product};
use firmware::station::{COLORS, MADE, Picture, RAW, Stages};
use host_sim::scene::Scene;
use host_sim::sensor::{Mounting, VirtualSensor};

/// The sensor's clock, in hertz: a third of what the boards give it, for few frames to pass while one is on the serial line,
/// and two within the image's patience of half a second.
const SENSOR_HZ: u32 = 8_000_000;
/// Millions of instructions a second: enough for the handlers, and the wait for each byte on the wire takes less long here.
const MIPS: u32 = 20;

/// When commands begin to come in, and how long a byte of them takes, in virtual nanoseconds: at [`MIPS`] the core is too slow
/// for bytes back to back at 921,600 baud.
const LISTENS: u64 = 300_000_000;
const BYTE: u64 = 150_000;

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
    run_told(board, sensor, frames, faults, bus, &[])
}

/// The same, and these commands come in as soon as the image listens; they are numbered from 0.
fn run_told(
    board: Kind,
    sensor: &str,
    frames: u64,
    faults: &[&str],
    bus: Bus,
    commands: &[Request<'_>],
) -> Option<Run> {
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
    let mut wire = Vec::new();
    for (number, command) in (0..).zip(commands) {
        let mut memory = [0; wire_bytes(512)];
        let mut framer = Framer::new(&mut memory, small_table);
        wire.extend_from_slice(command.frame(number, &mut framer).unwrap());
    }
    let plan = Plan {
        bus,
        sensor: on_i2c,
        serial: FarEnd::memory().sending(wire).paced(LISTENS, BYTE),
        mips: Some(MIPS),
        deadline: 8_000_000_000,
        ..Plan::new(board, image, camera)
    };
    let report = plan.run(None).unwrap();

    let readout = sensor.lock().unwrap().readout().unwrap();
    let scene = Scene::named("demo", 5).unwrap();
    let sent = (0..frames).map(|number| readout.frame_bytes(&scene, number)).collect();
    let (name, frames) = received(&report.serial, RAW);
    Some(Run { report, name, frames, sent, width: readout.view.output.0 })
}

/// The whole frames of a stream in a byte stream of the link, and the device's name. No packet may be damaged.
fn received(wire: &[u8], stream: u8) -> (String, Vec<Frame>) {
    let (mut picture, mut marks) =
        (vec![0; picture_bytes(Format::GRAY8, 640, 480) * 2], vec![0; marks_words(480)]);
    let mut assembler = Assembler::new(stream, &mut picture, &mut marks, small_table);
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

/// What the host makes of a captured frame by these stages.
fn made(stages: &str, frame: &Frame) -> Vec<u8> {
    let picture =
        Picture { name: "", width: 320, height: 240, format: frame.format, meaning: Meaning::default() };
    let (stages, mut probes) = (Stages::read(stages).unwrap(), [Probe::EMPTY; COLORS.len()]);
    let mut memory = vec![0; Stages::memory(320, 240)];
    let mut pipeline = Pipeline::new(stages.settings(&picture, &mut probes).unwrap(), &mut memory).unwrap();
    let mut made = Vec::new();
    let mut sink = |product: Product<'_>| match product {
        Product::Gray(line) | Product::Indices(line) => made.extend(line),
        Product::Color(line) => made.extend(line.iter().flat_map(|pixel| [pixel.r, pixel.g, pixel.b])),
        Product::Edges(words) => {
            made.extend((0..320).map(|x| if words[x / 32] >> (x % 32) & 1 == 1 { 255 } else { 0 }));
        }
    };
    for line in frame.bytes.chunks_exact(frame.bytes.len() / 240) {
        pipeline.push(line, &mut sink).unwrap();
    }
    pipeline.finish(&mut sink);
    made
}

/// Number, status and results of a reply.
type Answer = (u16, Status, Vec<u8>);

/// Every reply, and the state in the last heartbeat.
fn answers(wire: &[u8]) -> (Vec<Answer>, Option<State>) {
    let (mut replies, mut state) = (Vec::new(), None);
    let mut room = vec![0; BODY_MAX];
    Inbox::new(&mut room, small_table).feed(wire, |received| match received {
        Received::Packet(Packet::Reply(reply)) => {
            replies.push((reply.request, reply.status, reply.rest.to_vec()));
        }
        Received::Packet(Packet::Heartbeat(beat)) => state = Some(beat.state),
        _ => {}
    });
    (replies, state)
}

#[test]
fn what_the_stages_make_on_the_chip_is_what_they_make_on_the_host() {
    let cases = [
        ("ov7670", "gray|gaussian:size=5|canny:low=50,high=150,norm=l2"),
        ("ov7670", "palette"),
        ("mt9v034", "gray|gaussian:size=3|sobel"),
    ];
    for board in BOARDS {
        for (sensor, stages) in cases {
            let commands =
                [Request::Stages(MADE, stages), Request::Streams(1 << RAW | 1 << MADE), Request::Snapshot(1)];
            let Some(run) = run_told(board, sensor, 30, &[], Bus::IDEAL, &commands) else { return };
            let (replies, _) = answers(&run.report.serial);
            let statuses: Vec<Status> = replies.iter().map(|reply| reply.1).collect();
            assert_eq!(statuses, [Status::Done; 3], "{stages}\n{}", run.report);
            // One was asked for; another may have been on its way.
            assert!((1..=2).contains(&run.numbers().len()), "{}", run.report);
            let (_, vision) = received(&run.report.serial, MADE);
            assert_eq!(vision.len(), 1, "{stages}\n{}", run.report);
            let raw = run.frames.last().unwrap();
            assert!(vision[0].bytes == made(stages, raw), "{}: {sensor}, {stages}", board.name());
            assert!(
                vision[0].bytes.iter().any(|&byte| byte != vision[0].bytes[0]),
                "{stages}: it shows something"
            );
        }
    }
}

#[test]
fn every_command_is_answered_on_the_chip() {
    let again = Resend { stream: RAW, first: 0, sequence: 7, count: 1 };
    let commands = [
        Request::Hello,
        Request::Ping(b"here"),
        Request::Heartbeat,
        Request::Stop,
        Request::Start,
        Request::Read { block: 0, count: 1, offset: 0 },
        Request::Read { block: 1, count: 2, offset: 0x0A },
        Request::Write { block: 1, offset: 0x55, value: 0x12 },
        Request::Read { block: 1, count: 1, offset: 0x55 },
        Request::Set(1, 900),
        Request::Get(1),
        Request::Get(4),
        Request::Stages(MADE, "gray|median"),
        Request::Resend(again),
        Request::Snapshot(2),
    ];
    use Status::{Done, Gone, OutOfRange};
    let expected = [
        Done, Done, Done, Done, Done, Done, Done, Done, Done, Done, Done, OutOfRange, OutOfRange, Gone, Done,
    ];
    for board in BOARDS {
        let Some(run) = run_told(board, "ov7670", 45, &[], Bus::IDEAL, &commands) else { return };
        let (replies, state) = answers(&run.report.serial);
        assert!((0..).zip(&replies).all(|(number, reply)| reply.0 == number), "{replies:?}");
        let statuses: Vec<Status> = replies.iter().map(|reply| reply.1).collect();
        assert_eq!(statuses, expected, "{}\n{}", board.name(), run.report);
        let rest = |number: usize| &replies[number].2[..];
        assert_eq!(rest(1), b"here");
        // PID and VER of an OV7670, as the sensor on I2C has them.
        assert_eq!(rest(6)[8..], [0x76, 0, 0, 0, 0x73, 0, 0, 0]);
        assert_eq!(rest(8)[8..], [0x12, 0, 0, 0], "what was written to the sensor");
        assert_eq!(rest(10)[4..8], 900_i32.to_le_bytes());
        // Two were asked for; another may have been on its way.
        assert!((2..=3).contains(&run.numbers().len()), "{}", run.report);
        assert_eq!(state, Some(State::Stopped), "a snapshot ends by itself");
    }
}
