use crate::driver::verdict::Statistics;
use crate::link::fields::{Reader, Writer};

/// What a device is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum State {
    /// Not capturing.
    #[default]
    Stopped,
    /// Capturing until it is told to stop.
    Running,
    /// Capturing a number of frames.
    Snapshot,
    /// Something of a later day.
    Other(u8),
}

impl State {
    fn code(self) -> u8 {
        match self {
            Self::Stopped => 0,
            Self::Running => 1,
            Self::Snapshot => 2,
            Self::Other(code) => code,
        }
    }

    fn from_code(code: u8) -> Self {
        match code {
            0 => Self::Stopped,
            1 => Self::Running,
            2 => Self::Snapshot,
            code => Self::Other(code),
        }
    }
}

/// HEARTBEAT: alive, with statistics. Counters are since the start, and wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heartbeat {
    /// As in HELLO.
    pub session: u32,
    /// Microseconds since the device started.
    pub uptime: u64,
    /// What became of the frames.
    pub frames: Statistics,
    /// Packets sent before this one.
    pub packets_sent: u32,
    /// Bytes put on the wire before this packet.
    pub bytes_sent: u32,
    /// Packets not sent for want of room or time.
    pub packets_unsent: u32,
    /// Packets received.
    pub packets_received: u32,
    /// Packets received damaged, malformed or of another version.
    pub packets_damaged: u32,
    /// Rate of the line in baud; 0: not known, or none.
    pub baud: u32,
    /// What the device is doing.
    pub state: State,
    /// Why the camera's last wait ended without a frame: see [`cause_code`](super::cause_code).
    pub cause: u8,
}

impl Heartbeat {
    pub(super) const KIND: u8 = 0x07;

    pub(super) fn read(content: &[u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let heartbeat = Self {
            session: fields.u32()?,
            uptime: fields.u64()?,
            frames: Statistics {
                delivered: fields.u32()?,
                dropped: fields.u32()?,
                lost: fields.u32()?,
                skipped: fields.u32()?,
                overruns: fields.u32()?,
                sync_errors: fields.u32()?,
                dma_errors: fields.u32()?,
                lines_dropped: fields.u32()?,
            },
            packets_sent: fields.u32()?,
            bytes_sent: fields.u32()?,
            packets_unsent: fields.u32()?,
            packets_received: fields.u32()?,
            packets_damaged: fields.u32()?,
            baud: fields.u32()?,
            state: State::from_code(fields.u8()?),
            cause: fields.u8()?,
        };
        fields.u16()?;
        Some(heartbeat)
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        let mut fields = Writer::new(room);
        let frames = &self.frames;
        fields.u32(self.session).u64(self.uptime);
        fields.u32(frames.delivered).u32(frames.dropped).u32(frames.lost).u32(frames.skipped);
        fields.u32(frames.overruns).u32(frames.sync_errors).u32(frames.dma_errors).u32(frames.lines_dropped);
        fields.u32(self.packets_sent).u32(self.bytes_sent).u32(self.packets_unsent);
        fields.u32(self.packets_received).u32(self.packets_damaged).u32(self.baud);
        fields.u8(self.state.code()).u8(self.cause).u16(0).finish()
    }
}

/// How grave a line of the log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Something failed.
    Error = 1,
    /// Something may be wrong.
    Warning = 2,
    /// Something happened.
    Information = 3,
    /// For who looks for a fault.
    Debug = 4,
    /// For who looks closely.
    Trace = 5,
}

impl Level {
    fn from_code(code: u8) -> Option<Self> {
        [Self::Error, Self::Warning, Self::Information, Self::Debug, Self::Trace]
            .into_iter()
            .find(|&level| level as u8 == code)
    }
}

/// LOG: a line of the device's log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Log<'a> {
    /// How grave it is.
    pub level: Level,
    /// The text was cut.
    pub cut: bool,
    /// Messages lost before this one; 65,535 stands for more.
    pub lost: u16,
    /// Microseconds since the device started.
    pub time: u64,
    /// One line.
    pub text: &'a str,
}

impl<'a> Log<'a> {
    pub(super) const KIND: u8 = 0x08;

    pub(super) fn read(content: &'a [u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let level = Level::from_code(fields.u8()?)?;
        let (cut, lost, time) = (fields.u8()? & 1 != 0, fields.u16()?, fields.u64()?);
        Some(Self { level, cut, lost, time, text: fields.text()? })
    }

    /// A text that does not fit is cut between characters.
    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        let fits = room.len().checked_sub(12)?;
        let text = self.text.get(..self.text.floor_char_boundary(fits)).unwrap_or_default();
        let cut = self.cut || text.len() < self.text.len();
        let mut fields = Writer::new(room);
        fields.u8(self.level as u8).u8(cut.into()).u16(self.lost).u64(self.time);
        fields.bytes(text.as_bytes()).finish()
    }
}
