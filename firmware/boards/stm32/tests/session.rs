//! A session of a board: frames out, commands in, on the block's own model and a sensor that sends for ever. What the images
//! do is this, over the silicon.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use algos_nostd::quantize::Probe;
use firmware::camif::pins::{Samples, Sync};
use firmware::camif::{Bus, Camif, Part};
use firmware::driver::FrameCamera;
use firmware::driver::config::Policy;
use firmware::driver::deadline::Cause;
use firmware::link::packet::{Command, Packet, State, Status};
use firmware::link::{
    Assembler, BODY_MAX, Framer, Inbox, Received, Request, Resend, marks_words, picture_bytes, small_table,
    wire_bytes,
};
use firmware::pipeline::{Pipeline, Product};
use firmware::sensor::Mode;
use firmware::sensor::ov7670::OV7670;
use firmware::station::{COLORS, Identity, MADE, Memory, RAW, Stages, Station};
use stm32::capture::{Account, Ended, capture};
use stm32::device::{CameraBoard, SensorRegisters, modes, picture as picture_of};

const WIDTH: usize = 320;
const HEIGHT: usize = 240;
/// Microseconds a line: a frame takes 120 ms.
const LINE_US: u64 = 500;

/// Frame `number` of the sensor: its lower half is flat, so that there is an edge between.
fn picture(number: usize) -> Vec<u8> {
    let byte = |at: usize| {
        let (y, x) = (at / (2 * WIDTH), at % (2 * WIDTH));
        if y > HEIGHT / 2 {
            0x11 * (number % 16) as u8
        } else {
            (x / 40 * 31 + y / 30 * 17 + number * 5) as u8
        }
    };
    (0..2 * WIDTH * HEIGHT).map(byte).collect()
}

/// What is asked, and when: by the lines that the sensor has sent.
type Script = Vec<(u64, Request<'static>)>;

thread_local! {
    /// Microseconds, [`LINE_US`] a line.
    static NOW: Cell<u64> = const { Cell::new(0) };
}

/// Both directions: what the device is to read, and what it wrote.
#[derive(Clone, Default)]
struct Line(Rc<RefCell<(VecDeque<u8>, Vec<u8>)>>);

impl embedded_io::ErrorType for Line {
    type Error = Infallible;
}

impl embedded_io::Read for Line {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let inward = &mut self.0.borrow_mut().0;
        let count = bytes.len().min(inward.len());
        bytes.iter_mut().zip(inward.drain(..count)).for_each(|(to, from)| *to = from);
        Ok(count)
    }
}

impl embedded_io::ReadReady for Line {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().0.is_empty())
    }
}

impl embedded_io::Write for Line {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.0.borrow_mut().1.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// The wires, and the host at the other end of the line.
struct World<'a, F: Fn()> {
    camif: &'a RefCell<Camif<'static>>,
    on_interrupt: F,
    frame: Vec<u8>,
    lines: u64,
    script: Script,
    asked: usize,
    /// The sensor falls silent after so many lines.
    silent: u64,
    line: Line,
}

impl<F: Fn()> World<'_, F> {
    fn play(&self, hsync: bool, vsync: bool, mut samples: Samples<'_>) {
        while !samples.is_empty() {
            let played = self.camif.borrow_mut().run(Sync { hsync, vsync }, samples);
            samples = samples.skip(played);
            if self.camif.borrow().interrupts().any() {
                (self.on_interrupt)();
            }
        }
    }

    fn sleep(&mut self) -> u64 {
        if let Some((when, request)) = self.script.get(self.asked)
            && *when <= self.lines
        {
            let mut arguments = [0; 128];
            let length = request.write(&mut arguments).unwrap();
            let number = self.asked as u16;
            let command = Command { request: number, code: request.code(), arguments: &arguments[..length] };
            let mut memory = [0; wire_bytes(512)];
            let mut framer = Framer::new(&mut memory, small_table);
            let wire = Packet::Command(command).frame(&mut framer).unwrap();
            self.line.0.borrow_mut().0.extend(wire);
            self.asked += 1;
        }
        if self.lines >= self.silent {
            return self.line_passed();
        }
        // The OV7670's levels: HREF is high over data, VSYNC between frames.
        let (line, number) = (self.lines as usize % HEIGHT, self.lines as usize / HEIGHT);
        if line == 0 {
            self.frame = picture(number);
            self.play(false, true, Samples::Repeat { value: 0, clocks: 500 });
        }
        self.play(false, false, Samples::Repeat { value: 0, clocks: 100 });
        self.play(true, false, Samples::Bytes(&self.frame[line * 2 * WIDTH..][..2 * WIDTH]));
        self.play(false, line == HEIGHT - 1, Samples::Repeat { value: 0, clocks: 100 });
        self.line_passed()
    }

    fn line_passed(&mut self) -> u64 {
        self.lines += 1;
        NOW.set(self.lines * LINE_US);
        NOW.get()
    }
}

/// A sensor with eight registers.
#[derive(Default)]
struct Eight([u16; 8], bool);

impl SensorRegisters for Eight {
    fn read(&mut self, register: u16) -> Option<u16> {
        self.0.get(usize::from(register)).copied()
    }

    fn write(&mut self, register: u16, value: u16) -> bool {
        self.0.get_mut(usize::from(register)).map(|place| *place = value).is_some()
    }

    fn pattern(&mut self, on: bool) -> bool {
        self.1 = on;
        true
    }
}

/// What came of a session.
struct Heard {
    ended: Ended,
    capturing: bool,
    packets: Vec<Vec<u8>>,
    /// Lines sent by the sensor.
    lines: u64,
}

fn session<const N: usize>(script: Script, policy: Policy) -> Heard {
    session_until::<N>(script, policy, u64::MAX)
}

/// The same with a sensor that falls silent after so many lines.
fn session_until<const N: usize>(script: Script, policy: Policy, silent: u64) -> Heard {
    let mode = modes(&OV7670).next().unwrap();
    let mut config = mode.capture(24_000_000);
    config.policy = policy;
    let buffers = std::array::from_fn(|_| &mut *vec![0; WIDTH * HEIGHT / 2].leak());
    let camif: &'static RefCell<Camif<'static>> =
        Box::leak(Box::new(RefCell::new(Camif::new(Part::STM32H7, Bus::IDEAL))));
    let camera = FrameCamera::<_, N>::new(camif, buffers).unwrap();
    let (line, mut memory, mut stages) =
        (Line::default(), Memory::new(), vec![0; Stages::memory(WIDTH, HEIGHT)]);
    let mut board = CameraBoard::new(camif, Eight::default());
    board.found(&OV7670);
    let identity = Identity { name: "ov7670", session: 7, baud: 921_600 };
    let lent = (line.clone(), &mut memory, &mut stages[..]);
    NOW.set(0);
    let mut station = Station::new(lent, (board, picture_of(mode), 0), identity, || NOW.get());
    station.announce().unwrap();
    let mut world = World {
        camif,
        on_interrupt: || camera.on_interrupt(),
        frame: Vec::new(),
        lines: 0,
        script,
        asked: 0,
        silent,
        line: line.clone(),
    };
    let ended = capture(&mut station, &camera, &config, &mut Account::default(), &mut || world.sleep());
    let (lines, capturing) = (world.lines, station.control.is_capturing());
    let wire = core::mem::take(&mut line.0.borrow_mut().1);
    let mut room = vec![0; BODY_MAX];
    let mut packets = Vec::new();
    let mut again = [0; wire_bytes(BODY_MAX)];
    let mut framer = Framer::new(&mut again, small_table);
    Inbox::new(&mut room, small_table).feed(&wire, |received| {
        let Received::Packet(packet) = received else { panic!("{received:?}") };
        packets.push(packet.frame(&mut framer).unwrap().to_vec());
    });
    Heard { ended, capturing, packets, lines }
}

impl Heard {
    fn each(&self, mut body: impl FnMut(&Packet<'_>)) {
        let mut room = vec![0; BODY_MAX];
        let mut inbox = Inbox::new(&mut room, small_table);
        for packet in &self.packets {
            inbox.feed(packet, |received| {
                let Received::Packet(packet) = received else { panic!("{received:?}") };
                body(&packet);
            });
        }
    }

    /// The whole frames of a stream of this format, by number; and lines that came twice.
    fn frames(&self, stream: u8) -> (Vec<(u32, Vec<u8>)>, u32) {
        let mut picture = vec![0; picture_bytes(firmware::link::Format::RGB888, WIDTH, HEIGHT)];
        let mut marks = vec![0; marks_words(HEIGHT)];
        let mut assembler = Assembler::new(stream, &mut picture, &mut marks, small_table);
        let mut frames = Vec::new();
        self.each(|packet| {
            assembler.push(packet, &mut |frame| {
                assert_eq!(frame.crc, Some(true), "stream {stream}, frame {}", frame.sequence);
                frames.push((frame.sequence, frame.picture.to_vec()));
            });
        });
        (frames, assembler.dropped().doubled)
    }

    fn replies(&self) -> Vec<(u16, Status, Vec<u8>)> {
        let mut replies = Vec::new();
        self.each(|packet| {
            if let Packet::Reply(reply) = packet {
                replies.push((reply.request, reply.status, reply.rest.to_vec()));
            }
        });
        replies
    }
}

/// What the stages make of a frame.
fn made(stages: &str, mode: &Mode, bytes: &[u8]) -> Vec<u8> {
    let mut probes = [Probe::EMPTY; COLORS.len()];
    let mut memory = vec![0; Stages::memory(WIDTH, HEIGHT)];
    let settings = Stages::read(stages).unwrap().settings(&picture_of(mode), &mut probes);
    let mut pipeline = Pipeline::new(settings.unwrap(), &mut memory).unwrap();
    let mut made = Vec::new();
    let mut sink = |product: Product<'_>| match product {
        Product::Gray(line) | Product::Indices(line) => made.extend(line),
        Product::Color(line) => made.extend(algos_nostd::pixel::rgb888::as_bytes(line)),
        Product::Edges(line) => {
            made.extend((0..WIDTH).map(|x| if line[x / 32] >> (x % 32) & 1 != 0 { 255 } else { 0 }));
        }
    };
    for line in bytes.chunks(2 * WIDTH) {
        pipeline.push(line, &mut sink).unwrap();
    }
    pipeline.finish(&mut sink);
    made
}

const FRAME: u64 = HEIGHT as u64;
const EDGES: &str = "gray|gaussian:size=3|canny:low=20,high=60,norm=l1";

/// Ends every session.
fn end(at: u64) -> (u64, Request<'static>) {
    (at, Request::Set(2, 1))
}

#[test]
fn frames_leave_from_power_up_on_and_the_stages_can_be_chosen() {
    let script = vec![
        (FRAME * 5 / 2, Request::Stages(MADE, EDGES)),
        (FRAME * 5 / 2 + 1, Request::Streams(0b11)),
        (FRAME * 9 / 2, Request::Stages(MADE, "palette")),
        (FRAME * 13 / 2, Request::Stages(MADE, "gray")),
        end(FRAME * 17 / 2),
    ];
    let heard = session::<3>(script, Policy::NewestWins);
    assert_eq!(heard.ended, Ended::Mode);
    let mode = modes(&OV7670).next().unwrap();
    let (raw, _) = heard.frames(RAW);
    assert!(raw.len() >= 6, "{} frames", raw.len());
    for (sequence, bytes) in &raw {
        assert!(*bytes == picture(*sequence as usize), "frame {sequence} is as it was sent");
    }
    let (vision, _) = heard.frames(MADE);
    let expected = |number: &u32| match number {
        2..=3 => EDGES,
        4..=5 => "palette",
        _ => "gray",
    };
    assert!(vision.iter().any(|frame| frame.0 <= 3) && vision.iter().any(|frame| frame.0 >= 6));
    for (sequence, bytes) in &vision {
        let right = made(expected(sequence), mode, &picture(*sequence as usize));
        assert!(*bytes == right, "frame {sequence}: {}", expected(sequence));
        assert!(bytes.iter().any(|byte| *byte != bytes[0]), "frame {sequence} shows something");
    }
    let (mut palettes, mut beats, mut names) = (0, 0, Vec::new());
    heard.each(|packet| match packet {
        Packet::Palette(palette) => {
            assert_eq!(palette.colors.as_flattened(), algos_nostd::pixel::rgb888::as_bytes(&COLORS));
            palettes += 1;
        }
        Packet::Heartbeat(beat) => {
            assert_eq!((beat.session, beat.baud, beat.state), (7, 921_600, State::Running));
            beats += 1;
        }
        Packet::Stream(stream) if stream.stream == MADE => names.push(stream.pipeline.to_owned()),
        _ => {}
    });
    assert!(palettes > 0 && beats > 0);
    for text in [EDGES, "palette", "gray"] {
        assert!(names.iter().any(|name| name == text), "{text} is announced: {names:?}");
    }
}

#[test]
fn it_stops_takes_snapshots_and_sends_lines_again() {
    let again = |sequence| Request::Resend(Resend { stream: RAW, first: 10, sequence, count: 3 });
    let mut script = vec![
        (FRAME * 5 / 2, Request::Stop),
        (FRAME * 5 / 2 + 5, again(1)),
        (FRAME * 5 / 2 + 6, again(77)),
        (FRAME * 7 / 2, Request::Snapshot(2)),
        end(FRAME * 8),
    ];
    let heard = session::<3>(script.clone(), Policy::NewestWins);
    let (frames, doubled) = heard.frames(RAW);
    let sent: Vec<Vec<u8>> = (0..9).map(picture).collect();
    let numbers: Vec<usize> =
        frames.iter().map(|(_, bytes)| sent.iter().position(|sent| sent == bytes).unwrap()).collect();
    assert_eq!(numbers, [1, 4, 5], "the first whole one, and after the stop the next two");
    assert!(frames.is_sorted_by_key(|frame| frame.0), "no number comes twice");
    assert_eq!((doubled, heard.capturing), (3, false));
    let replies = heard.replies();
    let statuses: Vec<Status> = replies.iter().map(|reply| reply.1).collect();
    assert_eq!(statuses, [Status::Done, Status::Done, Status::Gone, Status::Done, Status::Done]);
    assert_eq!(replies[1].2, [3, 0], "three lines will come");
    assert!(heard.lines < 9 * FRAME);

    // With one buffer frames are asked for, and the last one is held as long as none is wanted.
    let heard = session::<1>(std::mem::take(&mut script), Policy::Snapshot);
    let (frames, doubled) = heard.frames(RAW);
    assert!(frames.len() >= 3 && frames.iter().all(|(_, bytes)| sent.contains(bytes)));
    assert_eq!((heard.capturing, heard.replies()[0].1), (false, Status::Done));
    assert!(doubled == 3 || heard.replies()[1].1 == Status::Gone);
}

#[test]
fn registers_and_parameters_are_read_and_written() {
    let script = vec![
        (10, Request::Hello),
        (11, Request::Read { block: 0, count: 1, offset: 0 }),
        (12, Request::Write { block: 1, offset: 3, value: 0x5A }),
        (13, Request::Read { block: 1, count: 2, offset: 2 }),
        (14, Request::Read { block: 1, count: 1, offset: 8 }),
        (15, Request::Get(0)),
        (16, Request::Set(1, 900)),
        (17, Request::Set(3, 1)),
        (18, Request::Get(4)),
        (19, Request::Stages(MADE, "gray|median")),
        (20, Request::Stages(RAW, "gray")),
        (21, Request::Streams(0b100)),
        (22, Request::Heartbeat),
        (23, Request::Ping(b"here")),
        end(30),
    ];
    let heard = session::<3>(script, Policy::NewestWins);
    let replies = heard.replies();
    let rest = |at: usize| &replies[at].2[..];
    let statuses: Vec<Status> = replies.iter().map(|reply| reply.1).collect();
    use Status::{Done, Failed, NoStream, OutOfRange, Unsupported};
    let expected = [
        Done,
        Done,
        Done,
        Done,
        Failed,
        Done,
        Done,
        Done,
        OutOfRange,
        OutOfRange,
        Unsupported,
        NoStream,
        Done,
        Done,
        Done,
    ];
    assert_eq!(statuses, expected);
    assert!((0..).zip(&replies).all(|(number, reply)| reply.0 == number), "in order");
    // ENABLE and CAPTURE.
    assert_eq!(u32::from_le_bytes(rest(1)[8..12].try_into().unwrap()) & 0x4001, 0x4001);
    assert_eq!(rest(3)[8..], [0, 0, 0, 0, 0x5A, 0, 0, 0]);
    assert_eq!(rest(6)[4..8], 900_i32.to_le_bytes());
    assert!(String::from_utf8_lossy(rest(9)).starts_with("not `median` here"));
    assert_eq!(rest(13), b"here");
    let mut hellos = 0;
    heard.each(|packet| hellos += u32::from(matches!(packet, Packet::Hello(_))));
    assert_eq!(hellos, 2);
}

#[test]
fn a_sensor_that_stops_is_told_by_its_cause() {
    let script = vec![(3, Request::Set(1, 300)), end(u64::MAX)];
    let heard = session_until::<3>(script, Policy::NewestWins, FRAME * 5 / 2);
    let Ended::Timeout(timeout) = &heard.ended else { panic!("{:?}", heard.ended) };
    assert!(matches!(timeout.cause, Cause::Unfinished { .. }), "{timeout}");
    // The wait began half a frame before.
    let waited = (heard.lines - FRAME * 5 / 2) * LINE_US / 1_000;
    assert!((230..=301).contains(&waited), "the deadline that was set: {waited} ms");
}
