//! Commands in, replies out: one for each, and no command carried out twice.

use core::fmt::{self, Write as _};

use super::crc::Checksum;
use super::device::Device;
use super::fields::Writer;
use super::packet::{Command, Reply, Status};
use super::request::Request;
use crate::port::Register;

/// Memory for the longest results: a READ of 64 registers.
pub const REPLY_MEMORY: usize = 8 + 4 * 64;

/// Block of the camera interface, in READ and WRITE.
const CAMERA: u8 = 0;
/// Block of the sensor.
const SENSOR: u8 = 1;

/// What is to be sent after the reply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Then {
    /// Nothing.
    #[default]
    Nothing,
    /// HELLO, and every stream's STREAM and PALETTE.
    Hello,
    /// HEARTBEAT.
    Heartbeat,
}

/// How to tell that a command is the one that was answered last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seen {
    request: u16,
    code: u8,
    length: usize,
    crc: u32,
}

/// Has a device carry out commands. It keeps the last reply, in case that is asked for again.
#[derive(Debug)]
pub struct Dispatcher<'m> {
    memory: &'m mut [u8],
    checksum: Checksum,
    seen: Option<Seen>,
    status: Status,
    length: usize,
}

impl<'m> Dispatcher<'m> {
    /// With [`REPLY_MEMORY`] bytes or more; texts are cut to what there is.
    pub fn new(memory: &'m mut [u8], checksum: Checksum) -> Self {
        Self { memory, checksum, seen: None, status: Status::Done, length: 0 }
    }

    /// Another host is there: its first command is none that was answered before.
    pub fn forget(&mut self) {
        self.seen = None;
    }

    /// Has the device carry out a command; returns what to send.
    pub fn handle(&mut self, device: &mut dyn Device, command: &Command<'_>) -> (Reply<'_>, Then) {
        let Command { request, code, arguments } = *command;
        let crc = (self.checksum)(0, arguments);
        let seen = Some(Seen { request, code, length: arguments.len(), crc });
        let mut then = Then::Nothing;
        if self.seen != seen {
            self.seen = seen;
            let mut text = Text { room: &mut *self.memory, at: 0 };
            let done = Request::read(command).and_then(|request| carry_out(device, &request, &mut text));
            (self.status, self.length) = match done {
                Ok((length, next)) => {
                    then = next;
                    (Status::Done, length)
                }
                Err(status) => {
                    if text.at == 0 {
                        // What does not fit is cut.
                        let _ = write!(text, "{status}");
                    }
                    (status, text.at)
                }
            };
        }
        let rest = self.memory.get(..self.length).unwrap_or_default();
        (Reply { request, code, status: self.status, rest }, then)
    }
}

/// Carries out a request; leaves its results, or what is wrong, in `text`.
fn carry_out(
    device: &mut dyn Device,
    request: &Request<'_>,
    text: &mut Text<'_>,
) -> Result<(usize, Then), Status> {
    let nothing = |()| (0, Then::Nothing);
    let results = |text: &mut Text<'_>, fill: &dyn Fn(&mut Writer<'_>)| {
        let mut fields = Writer::new(text.room);
        fill(&mut fields);
        fields.finish().map(|length| (length, Then::Nothing)).ok_or(Status::Failed)
    };
    match *request {
        Request::Ping(bytes) => results(text, &|fields| _ = fields.bytes(bytes)),
        Request::Hello => Ok((0, Then::Hello)),
        Request::Heartbeat => Ok((0, Then::Heartbeat)),
        Request::Start => device.start().map(nothing),
        Request::Stop => device.stop().map(nothing),
        Request::Snapshot(frames) => {
            device.snapshot(frames)?;
            results(text, &|fields| _ = fields.u16(frames))
        }
        Request::Streams(on) => {
            let on = device.select_streams(on)?;
            results(text, &|fields| _ = fields.u32(on))
        }
        Request::Encoding(stream, choice) => {
            device.choose_encoding(stream, choice)?;
            results(text, &|fields| _ = fields.u8(stream.unwrap_or(255)).u8(choice.code()))
        }
        Request::Stages(stream, pipeline) => {
            let mut understood = Text { room: text.room.get_mut(4..).unwrap_or_default(), at: 0 };
            match device.choose_stages(stream, pipeline, &mut understood) {
                Ok(()) => {
                    let length = 4 + understood.at;
                    text.room.get_mut(..4).ok_or(Status::Failed)?.copy_from_slice(&[stream, 0, 0, 0]);
                    Ok((length, Then::Nothing))
                }
                Err(status) => {
                    text.at = understood.at;
                    let end = text.room.len().min(4 + text.at);
                    if end > 4 {
                        text.room.copy_within(4..end, 0);
                    }
                    Err(status)
                }
            }
        }
        Request::Set(number, value) => {
            let parameter = device.parameter(number).ok_or(Status::OutOfRange)?;
            if !(parameter.least..=parameter.greatest).contains(&value) {
                let _ =
                    write!(text, "{} takes {} to {}", parameter.name, parameter.least, parameter.greatest);
                return Err(Status::OutOfRange);
            }
            device.set_parameter(number, value)?;
            parameter_results(device, number, text)
        }
        Request::Get(number) => parameter_results(device, number, text),
        Request::Read { block, count, offset } => {
            read(device, block, count, offset, text).map(|length| (length, Then::Nothing))
        }
        Request::Write { block, offset, value } => {
            match block {
                CAMERA => {
                    let register = Register::at(offset).ok_or_else(|| no_register(text, offset))?;
                    device.registers().write(register, value);
                }
                SENSOR => device.write_sensor(offset, value)?,
                _ => return Err(no_block(text, block)),
            }
            results(text, &|fields| _ = fields.u8(block).bytes(&[0; 3]).u32(offset).u32(value))
        }
        Request::Resend(lines) => {
            let count = device.resend(&lines)?;
            results(text, &|fields| _ = fields.u16(count))
        }
    }
}

fn parameter_results(
    device: &mut dyn Device,
    number: u16,
    text: &mut Text<'_>,
) -> Result<(usize, Then), Status> {
    let parameter = device.parameter(number).ok_or(Status::OutOfRange)?;
    let mut fields = Writer::new(text.room);
    fields.u16(number).u16(0).i32(parameter.value).i32(parameter.least).i32(parameter.greatest);
    let length = fields.bytes(parameter.name.as_bytes()).finish().ok_or(Status::Failed)?;
    Ok((length, Then::Nothing))
}

/// Reads registers; none at all if one of them does not exist.
fn read(
    device: &mut dyn Device,
    block: u8,
    count: u8,
    offset: u32,
    text: &mut Text<'_>,
) -> Result<usize, Status> {
    let step = match block {
        CAMERA => 4,
        SENSOR => 1,
        _ => return Err(no_block(text, block)),
    };
    let offsets = || (0..u32::from(count)).map(|at| offset.wrapping_add(step * at));
    if block == CAMERA
        && let Some(missing) = offsets().find(|&offset| Register::at(offset).is_none())
    {
        return Err(no_register(text, missing));
    }
    let mut fields = Writer::new(text.room);
    fields.u8(block).u8(count).u16(0).u32(offset);
    for offset in offsets() {
        fields.u32(match Register::at(offset) {
            Some(register) if block == CAMERA => device.registers().read(register),
            _ => device.read_sensor(offset)?,
        });
    }
    fields.finish().ok_or(Status::Failed)
}

fn no_register(text: &mut Text<'_>, offset: u32) -> Status {
    let _ = write!(text, "there is no register at {offset:#x}");
    Status::NoRegister
}

fn no_block(text: &mut Text<'_>, block: u8) -> Status {
    let _ = write!(text, "there is no block {block}: 0 is the camera interface, 1 the sensor");
    Status::NoRegister
}

/// Text in lent memory, cut between characters where that ends.
struct Text<'a> {
    room: &'a mut [u8],
    at: usize,
}

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = self.room.get_mut(self.at..).unwrap_or_default();
        let part = text.get(..text.floor_char_boundary(room.len())).unwrap_or_default();
        for (place, &byte) in room.iter_mut().zip(part.as_bytes()) {
            *place = byte;
        }
        self.at += part.len();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::super::crc::small_table;
    use super::super::device::Parameter;
    use super::*;
    use crate::camif::{Bus, Camif, Part};
    use crate::port::Registers;

    /// A model of the block, and what was asked of it.
    struct Board {
        camif: Camif<'static>,
        gain: i32,
        snapshots: Vec<u16>,
    }

    impl Device for Board {
        fn start(&mut self) -> Result<(), Status> {
            Ok(())
        }

        fn stop(&mut self) -> Result<(), Status> {
            Err(Status::Busy)
        }

        fn snapshot(&mut self, frames: u16) -> Result<(), Status> {
            self.snapshots.push(frames);
            Ok(())
        }

        fn choose_stages(
            &mut self,
            stream: u8,
            pipeline: &str,
            text: &mut dyn fmt::Write,
        ) -> Result<(), Status> {
            if stream > 0 {
                return Err(Status::NoStream);
            }
            let fine = pipeline == "gray";
            let _ = if fine { text.write_str("gray") } else { write!(text, "no stage `{pipeline}`") };
            if fine { Ok(()) } else { Err(Status::OutOfRange) }
        }

        fn parameter(&self, number: u16) -> Option<Parameter<'_>> {
            (number == 0).then_some(Parameter {
                name: "gain (dB)",
                value: self.gain,
                least: -6,
                greatest: 12,
            })
        }

        fn set_parameter(&mut self, _number: u16, value: i32) -> Result<(), Status> {
            self.gain = value;
            Ok(())
        }

        fn registers(&mut self) -> &mut dyn Registers {
            &mut self.camif
        }
    }

    fn board() -> Board {
        Board { camif: Camif::new(Part::CAMIF, Bus::IDEAL), gain: 0, snapshots: Vec::new() }
    }

    /// The status and the rest of the reply to a request.
    fn asked(board: &mut Board, request: &Request<'_>) -> (Status, Vec<u8>) {
        let (mut memory, mut arguments) = ([0; REPLY_MEMORY], [0; 128]);
        let mut dispatcher = Dispatcher::new(&mut memory, small_table);
        let length = request.write(&mut arguments).unwrap();
        let command = Command { request: 9, code: request.code(), arguments: &arguments[..length] };
        let (reply, _) = dispatcher.handle(board, &command);
        assert_eq!((reply.request, reply.code), (9, request.code()));
        (reply.status, reply.rest.to_vec())
    }

    fn refused(board: &mut Board, request: &Request<'_>) -> (Status, String) {
        let (status, rest) = asked(board, request);
        (status, String::from_utf8(rest).unwrap())
    }

    #[test]
    fn registers_are_those_of_the_block() {
        let mut board = board();
        let enable = Request::Write { block: 0, offset: 0x0C, value: 0x1F };
        assert_eq!(asked(&mut board, &enable).0, Status::Done);
        assert_eq!(board.camif.read(Register::InterruptEnable), 0x1F);
        let read = Request::Read { block: 0, count: 2, offset: 0x0C };
        assert_eq!(
            asked(&mut board, &read),
            (Status::Done, std::vec![0, 2, 0, 0, 0x0C, 0, 0, 0, 0x1F, 0, 0, 0, 0, 0, 0, 0])
        );
        let gap = Request::Read { block: 0, count: 3, offset: 0x24 };
        assert_eq!(refused(&mut board, &gap), (Status::NoRegister, "there is no register at 0x2c".into()));
        let sensor = Request::Read { block: 1, count: 1, offset: 0x0A };
        assert_eq!(refused(&mut board, &sensor).0, Status::Unsupported);
        let block = Request::Write { block: 7, offset: 0, value: 0 };
        assert!(refused(&mut board, &block).1.starts_with("there is no block 7"));
        assert_eq!(asked(&mut board, &Request::Read { block: 0, count: 0, offset: 0 }).0, Status::OutOfRange);
    }

    #[test]
    fn parameters_keep_to_their_range() {
        let mut board = board();
        let (status, rest) = asked(&mut board, &Request::Set(0, -6));
        assert_eq!(
            (status, board.gain, rest.get(4..8)),
            (Status::Done, -6, Some(&(-6i32).to_le_bytes()[..]))
        );
        assert_eq!(&rest[16..], b"gain (dB)");
        let text = "gain (dB) takes -6 to 12";
        assert_eq!(refused(&mut board, &Request::Set(0, 13)), (Status::OutOfRange, text.into()));
        assert_eq!(board.gain, -6);
        assert_eq!(asked(&mut board, &Request::Get(1)).0, Status::OutOfRange);
    }

    #[test]
    fn stages_answer_with_text() {
        let mut board = board();
        assert_eq!(asked(&mut board, &Request::Stages(0, "gray")), (Status::Done, b"\0\0\0\0gray".to_vec()));
        let wrong = refused(&mut board, &Request::Stages(0, "grau"));
        assert_eq!(wrong, (Status::OutOfRange, "no stage `grau`".into()));
        let text = "there is no such stream";
        assert_eq!(refused(&mut board, &Request::Stages(1, "gray")), (Status::NoStream, text.into()));
        assert_eq!(refused(&mut board, &Request::Stop), (Status::Busy, "not now".into()));
        assert_eq!(asked(&mut board, &Request::Streams(1)).0, Status::Unsupported);
    }

    #[test]
    fn a_command_that_comes_twice_is_carried_out_once() {
        let (mut board, mut memory) = (board(), [0; REPLY_MEMORY]);
        let mut dispatcher = Dispatcher::new(&mut memory, small_table);
        for request in [1, 1, 1, 2] {
            let command = Command { request, code: 4, arguments: &[3, 0] };
            let (reply, _) = dispatcher.handle(&mut board, &command);
            assert_eq!((reply.status, reply.rest), (Status::Done, &[3, 0][..]));
        }
        assert_eq!(board.snapshots, [3, 3]);
        let hello = Command { request: 3, code: 1, arguments: &[] };
        assert_eq!(dispatcher.handle(&mut board, &hello).1, Then::Hello);
        assert_eq!(dispatcher.handle(&mut board, &hello).1, Then::Nothing);
        dispatcher.forget();
        assert_eq!(dispatcher.handle(&mut board, &hello).1, Then::Hello);
    }

    #[test]
    fn what_is_no_command_is_answered_all_the_same() {
        let (mut board, mut memory) = (board(), [0; REPLY_MEMORY]);
        let mut dispatcher = Dispatcher::new(&mut memory, small_table);
        let mut status = |code, arguments: &[u8]| {
            dispatcher.handle(&mut board, &Command { request: 1, code, arguments }).0.status
        };
        assert_eq!(status(200, &[]), Status::UnknownCommand);
        assert_eq!(status(4, &[1]), Status::Malformed);
        assert_eq!(status(4, &[1, 0, 0]), Status::Malformed);
        assert_eq!(status(4, &[0, 0]), Status::OutOfRange);
        assert_eq!(status(7, &[0, 0, 0, 0, 0xFF]), Status::Malformed);
        assert_eq!(status(6, &[0, 9]), Status::OutOfRange);
        assert_eq!(status(0, &[7; 65]), Status::Malformed);
    }
}
