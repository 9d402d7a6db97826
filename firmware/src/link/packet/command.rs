use crate::link::fields::{Reader, Writer};

/// COMMAND: something the host wants; [`Request`](crate::link::Request) reads its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command<'a> {
    /// The host's number for it.
    pub request: u16,
    /// What is wanted.
    pub code: u8,
    /// With what.
    pub arguments: &'a [u8],
}

impl<'a> Command<'a> {
    pub(super) const KIND: u8 = 0x81;

    pub(super) fn read(content: &'a [u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let (request, code, _) = (fields.u16()?, fields.u8()?, fields.u8()?);
        Some(Self { request, code, arguments: fields.0 })
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        Writer::new(room).u16(self.request).u8(self.code).u8(0).bytes(self.arguments).finish()
    }
}

/// How a command went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Done,
    /// The command is not known.
    UnknownCommand,
    /// The arguments are too short, too long or no UTF-8.
    Malformed,
    /// An argument is out of range, or a pipeline can't be read.
    OutOfRange,
    /// This device can't do it.
    Unsupported,
    /// Not now.
    Busy,
    /// No such stream.
    NoStream,
    /// No such register.
    NoRegister,
    /// The lines are no longer held.
    Gone,
    /// It was tried and failed.
    Failed,
    /// A status of a later day.
    Other(u8),
}

impl Status {
    const ALL: [Self; 10] = [
        Self::Done,
        Self::UnknownCommand,
        Self::Malformed,
        Self::OutOfRange,
        Self::Unsupported,
        Self::Busy,
        Self::NoStream,
        Self::NoRegister,
        Self::Gone,
        Self::Failed,
    ];

    /// The number on the wire.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Self::Other(code) => code,
            known => Self::ALL.iter().position(|&status| status == known).unwrap_or(0) as u8,
        }
    }

    fn from_code(code: u8) -> Self {
        Self::ALL.get(usize::from(code)).copied().unwrap_or(Self::Other(code))
    }
}

impl core::fmt::Display for Status {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Done => "done",
            Self::UnknownCommand => "the command is not known",
            Self::Malformed => "the arguments are too short, too long or no text",
            Self::OutOfRange => "an argument is out of range",
            Self::Unsupported => "this device can't do it",
            Self::Busy => "not now",
            Self::NoStream => "there is no such stream",
            Self::NoRegister => "there is no such register",
            Self::Gone => "the lines are no longer held",
            Self::Failed => "it was tried and failed",
            Self::Other(code) => return write!(f, "status {code}"),
        })
    }
}

/// REPLY: the answer to a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reply<'a> {
    /// The request that it answers.
    pub request: u16,
    /// The command that it answers.
    pub code: u8,
    /// How it went.
    pub status: Status,
    /// Results, or a text that says what is wrong.
    pub rest: &'a [u8],
}

impl<'a> Reply<'a> {
    pub(super) const KIND: u8 = 0x09;

    pub(super) fn read(content: &'a [u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let (request, code, status) = (fields.u16()?, fields.u8()?, Status::from_code(fields.u8()?));
        Some(Self { request, code, status, rest: fields.0 })
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        Writer::new(room).u16(self.request).u8(self.code).u8(self.status.code()).bytes(self.rest).finish()
    }
}
