//! A device on a wire in memory: frames come out as they went in, commands are carried out.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;
use std::string::{String, ToString};
use std::vec;
use std::vec::Vec;

use super::*;
use crate::camif::registers::Registers;
use crate::driver::verdict::Verdict;
use crate::link::packet::{Meaning, State, Status};
use crate::link::*;
use crate::port::Register;

const WIDTH: u16 = 40;
const HEIGHT: u16 = 12;
const VISION: usize = Stages::memory(WIDTH as usize, HEIGHT as usize);

/// Both directions: what the device is to read, and what it wrote.
#[derive(Clone, Debug, Default)]
struct Loop(Rc<RefCell<(VecDeque<u8>, Vec<u8>)>>);

impl embedded_io::ErrorType for Loop {
    type Error = Infallible;
}

impl embedded_io::Read for Loop {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let inward = &mut self.0.borrow_mut().0;
        let count = bytes.len().min(inward.len());
        for (place, byte) in bytes.iter_mut().zip(inward.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }
}

impl embedded_io::ReadReady for Loop {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().0.is_empty())
    }
}

impl embedded_io::Write for Loop {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.0.borrow_mut().1.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A register file.
#[derive(Debug)]
struct Memorized(u32);

impl Registers for Memorized {
    fn read(&mut self, _: Register) -> u32 {
        self.0
    }

    fn write(&mut self, _: Register, value: u32) {
        self.0 = value;
    }
}

fn with_station(body: impl FnOnce(&mut Station<'_, Loop, Memorized>, &Loop)) {
    let (wire, mut memory, mut vision) = (Loop::default(), Memory::new(), vec![0; VISION]);
    let picture = Picture {
        name: "raw",
        width: WIDTH,
        height: HEIGHT,
        format: Format::RGB888,
        meaning: Meaning::default(),
    };
    let lent = (wire.clone(), &mut memory, &mut vision[..]);
    let identity = Identity { name: "test", session: 5, baud: 0 };
    let mut station = Station::new(lent, (Memorized(7), picture, 100), identity, || 0);
    body(&mut station, &wire);
}

/// Sends a command and returns status and results of its reply.
fn ask(
    station: &mut Station<'_, Loop, Memorized>,
    wire: &Loop,
    number: u16,
    request: Request<'_>,
) -> (Status, Vec<u8>) {
    let mut memory = [0; 600];
    let mut framer = Framer::new(&mut memory, small_table);
    wire.0.borrow_mut().0.extend(request.frame(number, &mut framer).unwrap());
    station.serve().unwrap();
    let (mut room, mut answer) = (vec![0; BODY_MAX], None);
    Inbox::new(&mut room, small_table).feed(&core::mem::take(&mut wire.0.borrow_mut().1), |received| {
        let Received::Packet(packet) = received else { panic!("{received:?}") };
        if let Packet::Reply(reply) = packet {
            assert_eq!(reply.request, number);
            answer = Some((reply.status, reply.rest.to_vec()));
        }
    });
    answer.expect("no reply")
}

fn text((status, rest): (Status, Vec<u8>)) -> (Status, String) {
    (status, String::from_utf8_lossy(&rest).to_string())
}

fn pixels(frame: u8) -> Vec<u8> {
    let bytes = u32::from(WIDTH) * u32::from(HEIGHT) * 3;
    (0..bytes).map(|at| (((at * at) >> 5) as u8).wrapping_mul(3).wrapping_add(frame)).collect()
}

/// All frames of a stream on the wire.
fn frames(wire: &Loop, stream: u8, format: Format) -> Vec<(u32, Vec<u8>)> {
    let mut picture = vec![0; picture_bytes(format, WIDTH.into(), HEIGHT.into())];
    let mut marks = vec![0; marks_words(HEIGHT.into())];
    let mut assembler = Assembler::new(stream, &mut picture, &mut marks, small_table);
    let (mut room, mut all) = (vec![0; BODY_MAX], Vec::new());
    Inbox::new(&mut room, small_table).feed(&wire.0.borrow().1, |received| {
        let Received::Packet(packet) = received else { panic!("{received:?}") };
        assembler.push(&packet, &mut |frame| {
            assert_eq!((frame.crc, frame.missing().count()), (Some(true), 0));
            all.push((frame.sequence, frame.picture.to_vec()));
        });
    });
    all
}

#[test]
fn both_streams_arrive_and_numbers_never_go_back() {
    with_station(|station, wire| {
        let stages = "gray|gaussian:size=5|canny:low=20,high=60,norm=l1";
        let understood = "\u{1}\0\0\0gray|gaussian:size=5,sigma=1.4|canny:low=20,high=60,norm=l1";
        assert_eq!(
            text(ask(station, wire, 1, Request::Stages(1, stages))),
            (Status::Done, understood.into())
        );
        assert_eq!(ask(station, wire, 2, Request::Streams(3)), (Status::Done, vec![3, 0, 0, 0]));
        assert_eq!(station.control.take_order(), Some(Order::Start));
        station.frame(&pixels(0), &Verdict { sequence: 4, ..Verdict::default() }).unwrap();
        assert_eq!(ask_nothing(station), State::Running);
        assert_eq!(frames(wire, 0, Format::RGB888), [(4, pixels(0))]);
        let made = frames(wire, 1, Format::GRAY8);
        assert_eq!((made.len(), made[0].0), (1, 4));
        assert!(made[0].1.iter().all(|&level| level == 0 || level == 255));
        assert!(made[0].1.contains(&255), "there are edges");
        wire.0.borrow_mut().1.clear();
        assert_eq!(ask(station, wire, 3, Request::Snapshot(1)).0, Status::Done);
        assert_eq!(station.control.take_order(), Some(Order::Start));
        station.frame(&pixels(1), &Verdict::default()).unwrap();
        assert_eq!(frames(wire, 0, Format::RGB888), [(5, pixels(1))], "capture began anew, numbers did not");
        assert_eq!(station.control.take_order(), Some(Order::Stop), "the snapshot is over");
    });
}

fn ask_nothing(station: &Station<'_, Loop, Memorized>) -> State {
    station.control.state
}

#[test]
fn commands_change_what_they_name_and_refuse_the_rest() {
    with_station(|station, wire| {
        assert_eq!(
            ask(station, wire, 1, Request::Read { block: 0, count: 1, offset: 0 }).1[8..],
            [7, 0, 0, 0]
        );
        assert_eq!(ask(station, wire, 2, Request::Write { block: 0, offset: 0, value: 9 }).0, Status::Done);
        assert_eq!(
            ask(station, wire, 3, Request::Read { block: 0, count: 1, offset: 0 }).1[8..],
            [9, 0, 0, 0]
        );
        assert_eq!(ask(station, wire, 4, Request::Set(0, 250)).0, Status::Done);
        assert_eq!(station.control.period_ms(), 250);
        assert_eq!(ask(station, wire, 5, Request::Set(0, -1)).0, Status::OutOfRange);
        assert_eq!(ask(station, wire, 6, Request::Get(1)).0, Status::OutOfRange);
        assert_eq!(ask(station, wire, 7, Request::Streams(4)).0, Status::NoStream);
        let (status, why) = text(ask(station, wire, 8, Request::Stages(1, "median:size=3")));
        assert_eq!(status, Status::OutOfRange);
        assert!(why.starts_with("not `median:size=3` here"), "{why}");
        for wrong in [
            "gray|sobel|sobel",
            "gray|canny:low=9,high=3",
            "gray|gaussian:size=7",
            "gray|palette",
            "gray|canny:low",
        ] {
            assert_eq!(ask(station, wire, 9, Request::Stages(1, wrong)).0, Status::OutOfRange, "{wrong}");
        }
        assert_eq!(ask(station, wire, 10, Request::Stop).0, Status::Done);
        assert!(!station.control.is_capturing());
    });
}

#[test]
fn lines_of_the_frame_before_come_again() {
    with_station(|station, wire| {
        let lines = Resend { stream: 0, first: 10, sequence: 0, count: 9 };
        assert_eq!(ask(station, wire, 1, Request::Resend(lines)).0, Status::Gone);
        station.frame(&pixels(0), &Verdict::default()).unwrap();
        wire.0.borrow_mut().1.clear();
        assert_eq!(ask(station, wire, 2, Request::Resend(lines)), (Status::Done, vec![2, 0]));
        station.send_again(&pixels(0)).unwrap();
        let (mut room, mut again) = (vec![0; BODY_MAX], Vec::new());
        Inbox::new(&mut room, small_table).feed(&wire.0.borrow().1, |received| {
            if let Received::Packet(Packet::Line(line)) = received {
                again.push((line.line, line.again));
            }
        });
        assert_eq!(again, [(10, true), (11, true)]);
    });
}

#[test]
fn a_snapshot_counts_no_frame_from_before_it() {
    with_station(|station, wire| {
        assert_eq!(station.control.take_order(), Some(Order::Start));
        // It comes while a frame is on its way.
        let (mut memory, request) = ([0; 600], Request::Snapshot(1));
        let mut framer = Framer::new(&mut memory, small_table);
        wire.0.borrow_mut().0.extend(request.frame(1, &mut framer).unwrap());
        station.frame(&pixels(0), &Verdict::default()).unwrap();
        assert!(station.control.is_capturing(), "the frame that was asked for is still to come");
        assert_eq!(station.control.take_order(), Some(Order::Start));
        station.frame(&pixels(1), &Verdict::default()).unwrap();
        assert_eq!(station.control.take_order(), Some(Order::Stop));
    });
}

#[test]
fn a_palette_is_sent_with_its_stream_and_light_goes_on_from_frame_to_frame() {
    with_station(|station, wire| {
        let made = |station: &mut Station<'_, Loop, Memorized>, format| {
            wire.0.borrow_mut().1.clear();
            station.frame(&pixels(0), &Verdict::default()).unwrap();
            frames(wire, MADE, format)[0].1.clone()
        };
        ask(station, wire, 1, Request::Streams(1 << MADE));
        ask(station, wire, 2, Request::Stages(MADE, "balance"));
        let (first, second) = (made(station, Format::RGB888), made(station, Format::RGB888));
        assert!(first == pixels(0) && second != first, "the second frame is balanced by the first");
        assert_eq!(ask(station, wire, 3, Request::Stages(MADE, "palette")).0, Status::Done);
        let indices = made(station, Format::Index8);
        assert!(indices.iter().all(|&index| index < 16) && indices.iter().any(|&index| index != indices[0]));
        let mut palettes = 0;
        station.announce().unwrap();
        let mut room = vec![0; BODY_MAX];
        Inbox::new(&mut room, small_table).feed(&wire.0.borrow().1, |received| {
            palettes += u32::from(matches!(received, Received::Packet(Packet::Palette(_))));
        });
        assert_eq!(palettes, 1);
    });
}
