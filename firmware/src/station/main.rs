//! The main loop's part: commands answered, frames sent, signs of life given.

use embedded_io::{Read, ReadReady, Write};

use super::control::{Control, MADE, Picture, RAW, STREAMS};
use crate::driver::deadline::Cause;
use crate::driver::verdict::{Statistics, Verdict};
use crate::link::packet::{FrameStart, Heartbeat, Hello, Level, Log, State, Stream, cause_code};
use crate::link::{
    ALL_COMMANDS, COMMAND_BODY_MAX, Choice, Dispatcher, Encoding, Inbox, Outgoing, Packet, REPLY_MEMORY,
    Received, SendError, Sender, Then, VERSION, small_table, wire_bytes,
};
use crate::pipeline::{Pipeline, Product};
use crate::port::Registers;
use algos_nostd::pixel::rgb888;

/// Bytes of the largest body that is sent; longer lines travel in pieces.
pub const BODY: usize = 1_024;
/// Microseconds from heartbeat to heartbeat.
const BEAT: u64 = 1_000_000;
/// Heartbeats from description to description of the streams.
const DESCRIBE: u32 = 2;

/// A wire: it never waits to read, and waits to write until the other end has taken the bytes.
pub trait Wire: Read + ReadReady + Write {}

impl<W: Read + ReadReady + Write> Wire for W {}

/// Memory that a station is lent.
#[derive(Debug)]
pub struct Memory {
    sender: [u8; wire_bytes(BODY)],
    inbox: [u8; COMMAND_BODY_MAX],
    replies: [u8; REPLY_MEMORY],
}

impl Memory {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self { sender: [0; wire_bytes(BODY)], inbox: [0; COMMAND_BODY_MAX], replies: [0; REPLY_MEMORY] }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

/// A device on a wire.
#[derive(Debug)]
pub struct Station<'m, W, R> {
    /// What the host has chosen.
    pub control: Control<R>,
    sender: Sender<'m, W>,
    inbox: Inbox<'m>,
    dispatcher: Dispatcher<'m>,
    /// Memory of the stages.
    vision: &'m mut [u32],
    /// Microseconds since the device started.
    clock: fn() -> u64,
    name: &'static str,
    session: u32,
    /// What became of the frames when the board last said so, and why none came.
    told: (Statistics, u8),
    beaten: u64,
    beats: u32,
    /// The frame that was sent last, for who asks for lines of it again.
    last: Option<Outgoing>,
}

impl<'m, W: Wire, R: Registers> Station<'m, W, R> {
    /// Capture is wanted at once, with `period_ms` from frame to frame at least; `vision` is the memory for the stages of the
    /// second stream, see [`crate::pipeline::Settings::memory`]. `session` is another number after every start.
    pub fn new(
        (wire, memory, vision): (W, &'m mut Memory, &'m mut [u32]),
        (registers, picture, period_ms): (R, Picture, u16),
        (name, session): (&'static str, u32),
        clock: fn() -> u64,
    ) -> Self {
        Self {
            control: Control::new(registers, picture, vision.len(), period_ms.into()),
            sender: Sender::new(wire, &mut memory.sender, small_table),
            inbox: Inbox::new(&mut memory.inbox, small_table),
            dispatcher: Dispatcher::new(&mut memory.replies, small_table),
            vision,
            clock,
            name,
            session,
            told: (Statistics::default(), 0),
            beaten: 0,
            beats: 0,
            last: None,
        }
    }

    /// Says who this is and what the streams carry.
    ///
    /// # Errors
    /// [`SendError`] of the wire; so for all of these.
    pub fn announce(&mut self) -> Result<(), SendError<W::Error>> {
        self.sender.send(&Packet::Hello(Hello {
            oldest: VERSION,
            newest: VERSION,
            takes: COMMAND_BODY_MAX as u16,
            sends: BODY as u16,
            streams: STREAMS,
            commands: ALL_COMMANDS,
            encodings: Encoding::bits(&Encoding::ALL),
            session: self.session,
            name: self.name,
        }))?;
        (0..STREAMS).try_for_each(|stream| self.describe(stream))
    }

    fn describe(&mut self, stream: u8) -> Result<(), SendError<W::Error>> {
        let control = &mut self.control;
        control.changed &= !(1 << stream);
        let mut text = Text { room: [0; 64], length: 0 };
        if stream == MADE {
            // It fits: the longest has less than 60 characters.
            let _ = core::fmt::Write::write_fmt(&mut text, format_args!("{}", control.stages));
        }
        let Picture { width, height, meaning, .. } = control.picture;
        self.sender.send(&Packet::Stream(Stream {
            stream,
            format: control.format(stream),
            encoding: encoding(control, stream),
            on: control.on >> stream & 1 == 1,
            width,
            height,
            meaning,
            pipeline: text.as_str(),
            name: if stream == RAW { "raw" } else { "stages" },
        }))
    }

    /// Adds a line to the log; what does not fit 64 bytes is cut.
    ///
    /// # Errors
    /// As [`Station::announce`].
    pub fn log(&mut self, level: Level, line: core::fmt::Arguments<'_>) -> Result<(), SendError<W::Error>> {
        let mut text = Text { room: [0; 64], length: 0 };
        let cut = core::fmt::Write::write_fmt(&mut text, line).is_err();
        let time = (self.clock)();
        self.sender.send(&Packet::Log(Log { level, cut, lost: 0, time, text: text.as_str() }))
    }

    /// Takes what has come in and answers it; gives a sign of life when it is time. Call it often.
    ///
    /// # Errors
    /// As [`Station::announce`].
    pub fn serve(&mut self) -> Result<(), SendError<W::Error>> {
        let mut bytes = [0; 32];
        while self.sender.writer_mut().read_ready().map_err(SendError::Write)? {
            let count = self.sender.writer_mut().read(&mut bytes).map_err(SendError::Write)?;
            let mut rest = bytes.get(..count).unwrap_or_default();
            while !rest.is_empty() {
                let taken = self.inbox.push(rest);
                rest = rest.get(taken..).unwrap_or_default();
                self.answer()?;
            }
        }
        let changed = self.control.changed;
        (0..STREAMS)
            .filter(|stream| changed >> stream & 1 == 1)
            .try_for_each(|stream| self.describe(stream))?;
        if (self.clock)().saturating_sub(self.beaten) >= BEAT {
            self.beaten = (self.clock)();
            self.beats = self.beats.wrapping_add(1);
            self.heartbeat()?;
            if self.beats.is_multiple_of(DESCRIBE) {
                let on = self.control.on;
                (0..STREAMS)
                    .filter(|stream| on >> stream & 1 == 1)
                    .try_for_each(|stream| self.describe(stream))?;
            }
        }
        Ok(())
    }

    fn answer(&mut self) -> Result<(), SendError<W::Error>> {
        match self.inbox.received() {
            Some(Received::Packet(Packet::Command(command))) => {
                let (reply, then) = self.dispatcher.handle(&mut self.control, &command);
                self.sender.send(&Packet::Reply(reply))?;
                match then {
                    Then::Nothing => Ok(()),
                    Then::Hello => self.announce(),
                    Then::Heartbeat => self.heartbeat(),
                }
            }
            Some(Received::OtherVersion { .. }) => self.announce(),
            _ => Ok(()),
        }
    }

    fn heartbeat(&mut self) -> Result<(), SendError<W::Error>> {
        let counts = self.inbox.counts();
        let (frames, cause) = self.told;
        self.sender.send(&Packet::Heartbeat(Heartbeat {
            session: self.session,
            uptime: (self.clock)(),
            frames,
            packets_sent: self.sender.packets(),
            bytes_sent: self.sender.bytes(),
            packets_unsent: 0,
            packets_received: counts.received,
            packets_damaged: counts.damaged.wrapping_add(counts.malformed).wrapping_add(counts.other_version),
            baud: 0,
            state: self.control.state,
            cause,
        }))
    }

    /// What became of the frames so far, and why none came, for the next heartbeat.
    pub fn tell(&mut self, statistics: Statistics, cause: Option<Cause>) {
        self.told = (statistics, cause_code(cause));
    }

    /// Sends a frame on every stream that is on, and answers commands between its lines.
    ///
    /// # Errors
    /// As [`Station::announce`].
    pub fn frame(&mut self, bytes: &[u8], verdict: &Verdict) -> Result<(), SendError<W::Error>> {
        self.control.held = None;
        let verdict = &Verdict { sequence: self.control.number(verdict.sequence), ..*verdict };
        let vision = core::mem::take(&mut self.vision);
        let sent = self.send_frame(bytes, verdict, vision);
        self.vision = vision;
        self.control.sent();
        self.control.held = self.last.map(|last| last.start().sequence);
        sent
    }

    fn send_frame(
        &mut self,
        bytes: &[u8],
        verdict: &Verdict,
        vision: &mut [u32],
    ) -> Result<(), SendError<W::Error>> {
        let on = self.control.on;
        let mut raw = if on >> RAW & 1 == 1 { Some(self.begin(RAW, verdict)?) } else { None };
        let settings = self.control.settings(self.control.stages.output()).filter(|_| on >> MADE & 1 == 1);
        let mut pipeline = settings.and_then(|settings| Pipeline::new(settings, vision).ok());
        let mut made = match pipeline {
            Some(_) => Some(self.begin(MADE, verdict)?),
            None => None,
        };
        let Picture { width, height, format, .. } = self.control.picture;
        let (width, line_bytes) = (usize::from(width), format.line_bytes(width.into()).max(1));
        let (mut number, mut result) = (0_u16, Ok(()));
        for (line, pixels) in (0..height).zip(bytes.chunks_exact(line_bytes)) {
            if let Some(raw) = &mut raw {
                self.sender.line(raw, line, pixels)?;
            }
            if let (Some(pipeline), Some(made)) = (&mut pipeline, &mut made) {
                let sender = &mut self.sender;
                let mut sink = |product: Product<'_>| {
                    if result.is_ok() {
                        result = send_product(sender, made, number, product, width);
                        number = number.saturating_add(1);
                    }
                };
                // A line is as long as the picture's; a pipeline refuses nothing else.
                let _ = pipeline.push(pixels, &mut sink);
            }
            self.serve()?;
        }
        if let (Some(mut pipeline), Some(made)) = (pipeline, &mut made) {
            let sender = &mut self.sender;
            pipeline.finish(&mut |product: Product<'_>| {
                if result.is_ok() {
                    result = send_product(sender, made, number, product, width);
                    number = number.saturating_add(1);
                }
            });
        }
        result?;
        for outgoing in [raw, made].into_iter().flatten() {
            self.sender.end(outgoing.end().judged(verdict))?;
        }
        self.last = raw;
        Ok(())
    }

    fn begin(&mut self, stream: u8, verdict: &Verdict) -> Result<Outgoing, SendError<W::Error>> {
        let Picture { width, height, meaning, .. } = self.control.picture;
        let start = FrameStart {
            stream,
            format: self.control.format(stream),
            meaning,
            snapshot: self.control.state == State::Snapshot,
            sequence: verdict.sequence,
            width,
            height,
            captured: (self.clock)(),
            palette: 0,
        };
        self.sender.begin(start, encoding(&self.control, stream))
    }

    /// Sends lines again that were asked for, of the frame that was sent last and whose bytes these are.
    ///
    /// # Errors
    /// As [`Station::announce`].
    pub fn send_again(&mut self, bytes: &[u8]) -> Result<(), SendError<W::Error>> {
        let (Some(lines), Some(last)) = (self.control.again.take(), self.last) else { return Ok(()) };
        let Picture { width, format, .. } = self.control.picture;
        let line_bytes = format.line_bytes(width.into()).max(1);
        let numbered = (0_u16..).zip(bytes.chunks_exact(line_bytes));
        for (line, pixels) in numbered.skip(lines.first.into()).take(lines.count.into()) {
            self.sender.resend(&last, line, pixels)?;
        }
        Ok(())
    }
}

/// The encoding that is asked for.
fn encoding<R>(control: &Control<R>, stream: u8) -> Choice {
    control.encodings.get(usize::from(stream)).copied().unwrap_or(Choice::Sender)
}

fn send_product<W: Write>(
    sender: &mut Sender<'_, W>,
    frame: &mut Outgoing,
    line: u16,
    product: Product<'_>,
    width: usize,
) -> Result<(), SendError<W::Error>> {
    match product {
        Product::Color(pixels) => sender.line(frame, line, rgb888::as_bytes(pixels)),
        Product::Gray(pixels) | Product::Indices(pixels) => sender.line(frame, line, pixels),
        Product::Edges(words) => {
            // A line of a map has less bits than one of colours has bytes.
            let mut packed = [0; BODY];
            for (bytes, word) in packed.as_chunks_mut().0.iter_mut().zip(words) {
                *bytes = word.to_le_bytes();
            }
            sender.bits_line(frame, line, packed.get(..width.div_ceil(8)).unwrap_or_default(), width)
        }
    }
}

/// A short text.
struct Text {
    room: [u8; 64],
    length: usize,
}

impl Text {
    fn as_str(&self) -> &str {
        self.room.get(..self.length).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or_default()
    }
}

impl core::fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        let rest = self.room.get_mut(self.length..).ok_or(core::fmt::Error)?;
        rest.get_mut(..text.len()).ok_or(core::fmt::Error)?.copy_from_slice(text.as_bytes());
        self.length += text.len();
        Ok(())
    }
}
