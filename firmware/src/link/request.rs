//! The commands and their arguments.

use super::fields::{Reader, Writer};
use super::format::Choice;
use super::framing::{Framer, TooLong};
use super::packet::{Command, Packet, Status};

/// The commands of this version: bit *c* for command *c*.
pub const ALL_COMMANDS: u32 = 0x3FFF;
/// Bytes that PING carries at most.
const PING_MAX: usize = 64;
/// Registers that READ reads at most.
const READ_MAX: u8 = 64;
/// Stands for all streams.
const ALL_STREAMS: u8 = 255;

/// Lines that are to come again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resend {
    /// The stream.
    pub stream: u8,
    /// First line.
    pub first: u16,
    /// The frame.
    pub sequence: u32,
    /// How many lines.
    pub count: u16,
}

/// What the host wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request<'a> {
    /// These bytes back.
    Ping(&'a [u8]),
    /// HELLO, and every stream's STREAM.
    Hello,
    /// Capture until STOP.
    Start,
    /// No more frames.
    Stop,
    /// So many frames.
    Snapshot(u16),
    /// Streams to be on: bit *s* for stream *s*.
    Streams(u32),
    /// The encoding of a stream, or of all.
    Encoding(Option<u8>, Choice),
    /// The pipeline of a stream.
    Stages(u8, &'a str),
    /// A value for a parameter.
    Set(u16, i32),
    /// A parameter.
    Get(u16),
    /// So many registers of a block from an offset on.
    Read {
        /// 0 the camera interface, 1 the sensor.
        block: u8,
        /// How many.
        count: u8,
        /// Of the first.
        offset: u32,
    },
    /// A value for a register.
    Write {
        /// 0 the camera interface, 1 the sensor.
        block: u8,
        /// Which.
        offset: u32,
        /// The value.
        value: u32,
    },
    /// Lines again.
    Resend(Resend),
    /// A HEARTBEAT.
    Heartbeat,
}

impl<'a> Request<'a> {
    /// Reads a command.
    ///
    /// # Errors
    /// The status of the reply.
    pub fn read(command: &Command<'a>) -> Result<Self, Status> {
        let mut fields = Reader(command.arguments);
        let request = Self::read_fields(command.code, &mut fields)?;
        if fields.0.is_empty() { request.checked() } else { Err(Status::Malformed) }
    }

    fn read_fields(code: u8, fields: &mut Reader<'a>) -> Result<Self, Status> {
        let short = Status::Malformed;
        let rest = |fields: &mut Reader<'a>| core::mem::take(&mut fields.0);
        Ok(match code {
            0 => Self::Ping(rest(fields)),
            1 => Self::Hello,
            2 => Self::Start,
            3 => Self::Stop,
            4 => Self::Snapshot(fields.u16().ok_or(short)?),
            5 => Self::Streams(fields.u32().ok_or(short)?),
            6 => {
                let stream = fields.u8().ok_or(short)?;
                let choice = Choice::from_code(fields.u8().ok_or(short)?).ok_or(Status::OutOfRange)?;
                Self::Encoding((stream != ALL_STREAMS).then_some(stream), choice)
            }
            7 => {
                let stream = fields.u8().ok_or(short)?;
                fields.bytes(3).ok_or(short)?;
                Self::Stages(stream, Reader(rest(fields)).text().ok_or(short)?)
            }
            8 => {
                let parameter = fields.u16().ok_or(short)?;
                fields.u16().ok_or(short)?;
                Self::Set(parameter, fields.i32().ok_or(short)?)
            }
            9 => Self::Get(fields.u16().ok_or(short)?),
            10 => {
                let (block, count) = (fields.u8().ok_or(short)?, fields.u8().ok_or(short)?);
                fields.u16().ok_or(short)?;
                Self::Read { block, count, offset: fields.u32().ok_or(short)? }
            }
            11 => {
                let block = fields.u8().ok_or(short)?;
                fields.bytes(3).ok_or(short)?;
                Self::Write { block, offset: fields.u32().ok_or(short)?, value: fields.u32().ok_or(short)? }
            }
            12 => {
                let stream = fields.u8().ok_or(short)?;
                fields.u8().ok_or(short)?;
                let (first, sequence) = (fields.u16().ok_or(short)?, fields.u32().ok_or(short)?);
                Self::Resend(Resend { stream, first, sequence, count: fields.u16().ok_or(short)? })
            }
            13 => Self::Heartbeat,
            _ => return Err(Status::UnknownCommand),
        })
    }

    fn checked(self) -> Result<Self, Status> {
        match self {
            Self::Ping(bytes) if bytes.len() > PING_MAX => Err(Status::Malformed),
            Self::Snapshot(0) => Err(Status::OutOfRange),
            Self::Read { count, .. } if !(1..=READ_MAX).contains(&count) => Err(Status::OutOfRange),
            fine => Ok(fine),
        }
    }

    /// The command's number.
    #[must_use]
    pub const fn code(&self) -> u8 {
        match self {
            Self::Ping(_) => 0,
            Self::Hello => 1,
            Self::Start => 2,
            Self::Stop => 3,
            Self::Snapshot(_) => 4,
            Self::Streams(_) => 5,
            Self::Encoding(..) => 6,
            Self::Stages(..) => 7,
            Self::Set(..) => 8,
            Self::Get(_) => 9,
            Self::Read { .. } => 10,
            Self::Write { .. } => 11,
            Self::Resend(_) => 12,
            Self::Heartbeat => 13,
        }
    }

    /// Writes the arguments, and says how many bytes they take; `None` if there is no room.
    #[must_use]
    pub fn write(&self, room: &mut [u8]) -> Option<usize> {
        let mut fields = Writer::new(room);
        match *self {
            Self::Hello | Self::Start | Self::Stop | Self::Heartbeat => &mut fields,
            Self::Ping(bytes) => fields.bytes(bytes),
            Self::Snapshot(frames) => fields.u16(frames),
            Self::Streams(on) => fields.u32(on),
            Self::Encoding(stream, choice) => fields.u8(stream.unwrap_or(ALL_STREAMS)).u8(choice.code()),
            Self::Stages(stream, text) => fields.u8(stream).bytes(&[0; 3]).bytes(text.as_bytes()),
            Self::Set(parameter, value) => fields.u16(parameter).u16(0).i32(value),
            Self::Get(parameter) => fields.u16(parameter),
            Self::Read { block, count, offset } => fields.u8(block).u8(count).u16(0).u32(offset),
            Self::Write { block, offset, value } => fields.u8(block).bytes(&[0; 3]).u32(offset).u32(value),
            Self::Resend(Resend { stream, first, sequence, count }) => {
                fields.u8(stream).u8(0).u16(first).u32(sequence).u16(count)
            }
        }
        .finish()
    }

    /// The COMMAND on the wire.
    ///
    /// # Errors
    /// [`TooLong`] if it does not fit 512 bytes or the framer's memory.
    pub fn frame<'f>(&self, request: u16, framer: &'f mut Framer<'_>) -> Result<&'f [u8], TooLong> {
        let mut arguments = [0; super::COMMAND_BODY_MAX - 12];
        let length = self.write(&mut arguments).ok_or(TooLong)?;
        let arguments = arguments.get(..length).ok_or(TooLong)?;
        Packet::Command(Command { request, code: self.code(), arguments }).frame(framer)
    }
}
