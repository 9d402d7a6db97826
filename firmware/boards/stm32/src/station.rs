//! The board's end of the serial line, by the link's protocol (`docs/link-protocol.md`): packets out, commands in.

use core::fmt::{self, Write as _};

use algos_nostd::pixel::rgb888;
use embedded_io::Write;
use firmware::driver::crc32;
use firmware::link::packet::{FrameStart, Heartbeat, Hello, Level, Log, Meaning, Palette, Stream};
use firmware::link::{
    ALL_COMMANDS, BODY_MAX, COMMAND_BODY_MAX, Dispatcher, Encoding, Format, Inbox, Packet, REPLY_MEMORY,
    Received, SendError, Sender, Then, VERSION, small_table, wire_bytes,
};
use firmware::port::Registers;
use firmware::sensor::Mode;
use heapless::String;

use crate::device::{BoardDevice, RAW, STREAMS, SensorRegisters, VISION};
use crate::stages::{COLORS, Made};

/// Bytes of the largest body that is sent: a line of QVGA with three bytes a pixel, and what stands around it.
const BODY: usize = 1_024;
const _: () = assert!(BODY <= BODY_MAX);

/// Microseconds between two heartbeats, and between two STREAMs.
const HEARTBEAT_US: u64 = 1_000_000;
const STREAM_US: u64 = 2_000_000;

/// Memory of a station.
#[derive(Debug)]
pub struct Memory {
    wire: [u8; wire_bytes(BODY)],
    body: [u8; COMMAND_BODY_MAX],
    reply: [u8; REPLY_MEMORY],
}

impl Memory {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self { wire: [0; wire_bytes(BODY)], body: [0; COMMAND_BODY_MAX], reply: [0; REPLY_MEMORY] }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

/// Who this is.
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Another number after every start.
    pub session: u32,
    /// Rate of the line.
    pub baud: u32,
}

/// The board's end of the line. `receive` fills a buffer with what has come in, and does not wait.
#[derive(Debug)]
pub struct Station<'m, W, R> {
    /// Packets out.
    pub sender: Sender<'m, W>,
    receive: R,
    inbox: Inbox<'m>,
    dispatcher: Dispatcher<'m>,
    identity: Identity,
    heartbeat_at: u64,
    streams_at: u64,
    /// The number of the next frame: none comes twice in a session, however often capture is started.
    pub(crate) next: u32,
}

/// What the line says when it takes nothing.
pub type Sent<W> = Result<(), SendError<<W as embedded_io::ErrorType>::Error>>;

impl<'m, W: Write, R: FnMut(&mut [u8]) -> usize> Station<'m, W, R> {
    /// A station that has said nothing yet.
    pub fn new(writer: W, receive: R, memory: &'m mut Memory, identity: Identity) -> Self {
        Self {
            sender: Sender::new(writer, &mut memory.wire, small_table),
            receive,
            inbox: Inbox::new(&mut memory.body, small_table),
            dispatcher: Dispatcher::new(&mut memory.reply, small_table),
            identity,
            heartbeat_at: 0,
            streams_at: 0,
            next: 0,
        }
    }

    /// Answers what has come in, and says what is due at this time, in microseconds since the start.
    ///
    /// # Errors
    /// [`SendError`] of the writer; so for all of these.
    pub fn listen<Q: Registers, X: SensorRegisters>(
        &mut self,
        device: &mut BoardDevice<Q, X>,
        now: u64,
    ) -> Sent<W> {
        let mut bytes = [0; 64];
        loop {
            let count = (self.receive)(&mut bytes);
            let mut rest = bytes.get(..count).unwrap_or_default();
            if rest.is_empty() {
                break;
            }
            while !rest.is_empty() {
                let taken = self.inbox.push(rest);
                rest = rest.get(taken..).unwrap_or_default();
                let then = match self.inbox.received() {
                    Some(Received::Packet(Packet::Command(command))) => {
                        let (reply, then) = self.dispatcher.handle(device, &command);
                        self.sender.send(&Packet::Reply(reply))?;
                        then
                    }
                    // Whoever speaks another version learns which are spoken here.
                    Some(Received::OtherVersion { .. }) => Then::Hello,
                    _ => Then::Nothing,
                };
                match then {
                    Then::Nothing => {}
                    Then::Hello => self.announce(device)?,
                    Then::Heartbeat => self.heartbeat(device, now)?,
                }
            }
        }
        if now >= self.heartbeat_at {
            self.heartbeat_at = now + HEARTBEAT_US;
            self.heartbeat(device, now)?;
        }
        if now >= self.streams_at {
            self.streams_at = now + STREAM_US;
            self.streams(device, device.on)?;
        }
        Ok(())
    }

    /// Says who this is and what will come.
    #[expect(clippy::missing_errors_doc, reason = "as for `listen`")]
    pub fn announce<Q: Registers, X: SensorRegisters>(&mut self, device: &BoardDevice<Q, X>) -> Sent<W> {
        let encodings =
            [Encoding::Raw, Encoding::RunLength, Encoding::Qoi, Encoding::Bits, Encoding::BitsRunLength];
        self.sender.send(&Packet::Hello(Hello {
            oldest: VERSION,
            newest: VERSION,
            takes: COMMAND_BODY_MAX as u16,
            sends: BODY as u16,
            streams: STREAMS,
            commands: ALL_COMMANDS,
            encodings: encodings.iter().fold(0, |bits, encoding| bits | 1 << encoding.code()),
            session: self.identity.session,
            name: device.model().name,
        }))?;
        self.streams(device, u32::MAX)
    }

    /// Says what these streams carry (bit *s* for stream *s*).
    #[expect(clippy::missing_errors_doc, reason = "as for `listen`")]
    pub fn streams<Q: Registers, X: SensorRegisters>(
        &mut self,
        device: &BoardDevice<Q, X>,
        which: u32,
    ) -> Sent<W> {
        let Some(mode) = device.mode() else { return Ok(()) };
        for stream in (0..STREAMS).filter(|stream| which >> stream & 1 != 0) {
            let mut pipeline = String::<128>::new();
            if stream == VISION {
                // The longest pipeline has 84 bytes.
                let _ = write!(pipeline, "{}", device.stages);
            }
            let start = start(device, mode, stream);
            self.sender.send(&Packet::Stream(Stream {
                stream,
                format: start.format,
                encoding: device.choices.get(usize::from(stream)).copied().unwrap_or_default(),
                on: device.is_on(stream),
                width: start.width,
                height: start.height,
                meaning: start.meaning,
                pipeline: &pipeline,
                name: if stream == RAW { mode.name } else { "vision" },
            }))?;
            if start.format == Format::Index8 {
                self.sender.send(&Packet::Palette(Palette {
                    stream,
                    colors: rgb888::as_bytes(&COLORS).as_chunks().0,
                }))?;
            }
        }
        Ok(())
    }

    /// Says how it goes.
    #[expect(clippy::missing_errors_doc, reason = "as for `listen`")]
    pub fn heartbeat<Q: Registers, X: SensorRegisters>(
        &mut self,
        device: &BoardDevice<Q, X>,
        now: u64,
    ) -> Sent<W> {
        let counts = self.inbox.counts();
        self.sender.send(&Packet::Heartbeat(Heartbeat {
            session: self.identity.session,
            uptime: now,
            frames: device.statistics,
            packets_sent: self.sender.packets(),
            bytes_sent: self.sender.bytes(),
            packets_unsent: 0,
            packets_received: counts.received,
            packets_damaged: counts.damaged.wrapping_add(counts.malformed).wrapping_add(counts.other_version),
            baud: self.identity.baud,
            state: device.state,
            cause: device.cause,
        }))
    }

    /// A line of the log.
    #[expect(clippy::missing_errors_doc, reason = "as for `listen`")]
    pub fn log(&mut self, level: Level, now: u64, what: &dyn fmt::Display) -> Sent<W> {
        let mut text = String::<250>::new();
        let cut = write!(text, "{what}").is_err();
        self.sender.send(&Packet::Log(Log { level, cut, lost: 0, time: now, text: &text }))
    }
}

/// How frames of a stream begin, but for number and time.
pub(crate) fn start<Q: Registers, X: SensorRegisters>(
    device: &BoardDevice<Q, X>,
    mode: &Mode,
    stream: u8,
) -> FrameStart {
    let (width, height) = (mode.width as u16, mode.height as u16);
    let (format, meaning) = if stream == RAW {
        (Format::Pixels(mode.format), Meaning { bayer: mode.bayer, ..Meaning::default() })
    } else {
        (device.stages.format(), Meaning::default())
    };
    let indexed = stream == VISION && device.stages.made == Made::Palette;
    let palette = if indexed { crc32(rgb888::as_bytes(&COLORS)) } else { 0 };
    FrameStart { stream, format, meaning, snapshot: false, sequence: 0, width, height, captured: 0, palette }
}
