//! The packets: what is in them, read and written. Siblings share a skeleton: `KIND`, fields, `read`, `write`.
//!
//! | file | what lives there |
//! |---|---|
//! | `hello` | HELLO: who a device is |
//! | `stream` | STREAM and PALETTE: what a stream carries |
//! | `frame` | FRAME and END: a frame begins, a frame is over |
//! | `line` | LINE |
//! | `heartbeat` | HEARTBEAT and LOG |
//! | `command` | COMMAND and REPLY |

mod command;
mod frame;
mod heartbeat;
mod hello;
mod line;
mod stream;

pub use command::{Command, Reply, Status};
pub use frame::{End, FrameStart, Meaning, VERDICT_UNKNOWN, cause_code, outcome_code};
pub use heartbeat::{Heartbeat, Level, Log, State};
pub use hello::Hello;
pub use line::Line;
pub use stream::{Palette, Stream};

use super::framing::{BODY_MIN, Framer, HEAD, TooLong, VERSION};

/// A packet of this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packet<'a> {
    /// HELLO.
    Hello(Hello<'a>),
    /// STREAM.
    Stream(Stream<'a>),
    /// PALETTE.
    Palette(Palette<'a>),
    /// FRAME.
    Frame(FrameStart),
    /// LINE.
    Line(Line<'a>),
    /// END.
    End(End),
    /// HEARTBEAT.
    Heartbeat(Heartbeat),
    /// LOG.
    Log(Log<'a>),
    /// REPLY.
    Reply(Reply<'a>),
    /// COMMAND.
    Command(Command<'a>),
}

/// What is in a body whose CRC is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content<'a> {
    /// A packet that can be used.
    Packet(Packet<'a>),
    /// A packet whose length or fields contradict the protocol.
    Malformed {
        /// Its kind.
        kind: u8,
    },
    /// A kind of a later day.
    UnknownKind {
        /// The kind.
        kind: u8,
    },
    /// A sender that speaks another version.
    OtherVersion {
        /// The version.
        version: u8,
        /// From its HELLO, the oldest and the newest version that it speaks.
        spoken: Option<(u8, u8)>,
    },
}

impl<'a> Content<'a> {
    /// Reads a body, with its CRC, which was checked before.
    #[must_use]
    pub fn read(body: &'a [u8]) -> Self {
        let (Some(&[version, kind, low, high]), Some(content)) =
            (body.first_chunk::<HEAD>(), body.len().checked_sub(4).and_then(|end| body.get(HEAD..end)))
        else {
            return Self::Malformed { kind: 0 };
        };
        if version != VERSION {
            let hello = (kind == Hello::KIND).then_some(content);
            return Self::OtherVersion { version, spoken: hello.and_then(Hello::versions) };
        }
        if usize::from(u16::from_le_bytes([low, high])) + BODY_MIN != body.len() {
            return Self::Malformed { kind };
        }
        let packet = match kind {
            Hello::KIND => Hello::read(content).map(Packet::Hello),
            Stream::KIND => Stream::read(content).map(Packet::Stream),
            Palette::KIND => Palette::read(content).map(Packet::Palette),
            FrameStart::KIND => FrameStart::read(content).map(Packet::Frame),
            Line::KIND => Line::read(content).map(Packet::Line),
            End::KIND => End::read(content).map(Packet::End),
            Heartbeat::KIND => Heartbeat::read(content).map(Packet::Heartbeat),
            Log::KIND => Log::read(content).map(Packet::Log),
            Reply::KIND => Reply::read(content).map(Packet::Reply),
            Command::KIND => Command::read(content).map(Packet::Command),
            _ => return Self::UnknownKind { kind },
        };
        packet.map_or(Self::Malformed { kind }, Self::Packet)
    }
}

impl Packet<'_> {
    /// The packet on the wire.
    ///
    /// # Errors
    /// [`TooLong`] if it does not fit the framer's memory.
    pub fn frame<'f>(&self, framer: &'f mut Framer<'_>) -> Result<&'f [u8], TooLong> {
        match self {
            Self::Hello(packet) => framer.frame(Hello::KIND, true, |room| packet.write(room)),
            Self::Stream(packet) => framer.frame(Stream::KIND, true, |room| packet.write(room)),
            Self::Palette(packet) => framer.frame(Palette::KIND, true, |room| packet.write(room)),
            Self::Frame(packet) => framer.frame(FrameStart::KIND, true, |room| packet.write(room)),
            Self::Line(packet) => framer.frame(Line::KIND, false, |room| packet.write(room)),
            Self::End(packet) => framer.frame(End::KIND, true, |room| packet.write(room)),
            Self::Heartbeat(packet) => framer.frame(Heartbeat::KIND, true, |room| packet.write(room)),
            Self::Log(packet) => framer.frame(Log::KIND, true, |room| packet.write(room)),
            Self::Reply(packet) => framer.frame(Reply::KIND, true, |room| packet.write(room)),
            Self::Command(packet) => framer.frame(Command::KIND, true, |room| packet.write(room)),
        }
    }
}
