//! The main loop's part: commands answered, frames sent, signs of life given.

use embedded_io::{Read, ReadReady, Write};

use super::board::Board;
use super::control::{Control, MADE, Picture, RAW, STREAMS};
use super::stages::COLORS;
use crate::driver::deadline::Cause;
use crate::driver::verdict::{Statistics, Verdict};
use crate::link::packet::{FrameStart, Heartbeat, Hello, Level, Log, Palette, State, Stream, cause_code};
use crate::link::{
    ALL_COMMANDS, COMMAND_BODY_MAX, Dispatcher, Encoding, Format, Inbox, Outgoing, Packet, REPLY_MEMORY,
    Received, SendError, Sender, Then, VERSION, small_table, wire_bytes,
};
use crate::pipeline::{Light, Pipeline, Product};
use algos_nostd::pixel::rgb888;
use algos_nostd::quantize::Probe;

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

/// Who this is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The device's name.
    pub name: &'static str,
    /// Another number after every start.
    pub session: u32,
    /// Bits a second on the wire; 0 if it has no rate.
    pub baud: u32,
}

/// A device on a wire.
#[derive(Debug)]
pub struct Station<'m, W, B> {
    /// What the host has chosen.
    pub control: Control<B>,
    sender: Sender<'m, W>,
    inbox: Inbox<'m>,
    dispatcher: Dispatcher<'m>,
    /// Memory of the stages.
    vision: &'m mut [u32],
    /// The light on the scene, as the frames before have shown it.
    light: Option<Light>,
    /// Microseconds since the device started.
    clock: fn() -> u64,
    identity: Identity,
    /// What became of the frames when the board last said so, and why none came.
    told: (Statistics, u8),
    beaten: u64,
    beats: u32,
    /// The frame that was sent last, for who asks for lines of it again.
    last: Option<Outgoing>,
}

impl<'m, W: Wire, B: Board> Station<'m, W, B> {
    /// Capture is wanted at once, with `period_ms` from frame to frame at least; `vision` is the memory for the stages of the
    /// second stream, see [`Stages::memory`](super::Stages::memory).
    pub fn new(
        (wire, memory, vision): (W, &'m mut Memory, &'m mut [u32]),
        (board, picture, period_ms): (B, Picture, u16),
        identity: Identity,
        clock: fn() -> u64,
    ) -> Self {
        Self {
            control: Control::new(board, picture, vision.len(), period_ms.into()),
            sender: Sender::new(wire, &mut memory.sender, small_table),
            inbox: Inbox::new(&mut memory.inbox, small_table),
            dispatcher: Dispatcher::new(&mut memory.replies, small_table),
            vision,
            light: None,
            clock,
            identity,
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
            session: self.identity.session,
            name: self.identity.name,
        }))?;
        (0..STREAMS).try_for_each(|stream| self.describe(stream))
    }

    /// The device has another name now; announce it.
    pub fn rename(&mut self, name: &'static str) {
        self.identity.name = name;
    }

    fn describe(&mut self, stream: u8) -> Result<(), SendError<W::Error>> {
        let control = &mut self.control;
        control.changed &= !(1 << stream);
        let mut text = Text::<128>::new();
        if stream == MADE {
            // It fits: the longest has less than 90 characters.
            let _ = core::fmt::Write::write_fmt(&mut text, format_args!("{}", control.stages));
        }
        let Picture { name, width, height, .. } = control.picture;
        let format = control.format(stream);
        self.sender.send(&Packet::Stream(Stream {
            stream,
            format,
            encoding: control.encoding(stream),
            on: control.on >> stream & 1 == 1,
            width,
            height,
            meaning: control.meaning(stream),
            pipeline: text.as_str(),
            name: if stream == RAW { name } else { "stages" },
        }))?;
        if stream == MADE && format == Format::Index8 {
            let colors = rgb888::as_bytes(&COLORS).as_chunks().0;
            self.sender.send(&Packet::Palette(Palette { stream, colors }))?;
        }
        Ok(())
    }

    /// Adds a line to the log; what does not fit 250 bytes is cut.
    ///
    /// # Errors
    /// As [`Station::announce`].
    pub fn log(&mut self, level: Level, line: core::fmt::Arguments<'_>) -> Result<(), SendError<W::Error>> {
        let mut text = Text::<250>::new();
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
        // Noise on the way in is no reason to say nothing any more.
        while self.sender.writer_mut().read_ready().unwrap_or(false) {
            let count @ 1.. = self.sender.writer_mut().read(&mut bytes).unwrap_or(0) else { break };
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
            session: self.identity.session,
            uptime: (self.clock)(),
            frames,
            packets_sent: self.sender.packets(),
            bytes_sent: self.sender.bytes(),
            packets_unsent: 0,
            packets_received: counts.received,
            packets_damaged: counts.damaged.wrapping_add(counts.malformed).wrapping_add(counts.other_version),
            baud: self.identity.baud,
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
        // What is chosen meanwhile is for the next frame.
        let (on, stages, picture) = (self.control.on, self.control.stages, self.control.picture);
        let mut raw = if on >> RAW & 1 == 1 { Some(self.begin(RAW, verdict)?) } else { None };
        let mut probes = [Probe::EMPTY; COLORS.len()];
        let settings = stages.settings(&picture, &mut probes).filter(|_| on >> MADE & 1 == 1);
        let pipeline = settings.and_then(|settings| Pipeline::new(settings, vision).ok());
        let light = self.light;
        let mut pipeline = pipeline.map(|pipeline| pipeline.lit(light));
        let mut made = match pipeline {
            Some(_) => Some(self.begin(MADE, verdict)?),
            None => None,
        };
        let (width, line_bytes) = (usize::from(picture.width), picture.line_bytes());
        let (mut number, mut result) = (0_u16, Ok(()));
        for (line, pixels) in (0..picture.height).zip(bytes.chunks_exact(line_bytes)) {
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
            self.light = pipeline.light();
        }
        result?;
        for outgoing in [raw, made].into_iter().flatten() {
            self.sender.end(outgoing.end().judged(verdict))?;
        }
        self.last = raw;
        Ok(())
    }

    fn begin(&mut self, stream: u8, verdict: &Verdict) -> Result<Outgoing, SendError<W::Error>> {
        let Picture { width, height, .. } = self.control.picture;
        let format = self.control.format(stream);
        let start = FrameStart {
            stream,
            format,
            meaning: self.control.meaning(stream),
            snapshot: self.control.state == State::Snapshot,
            sequence: verdict.sequence,
            width,
            height,
            captured: (self.clock)(),
            palette: if format == Format::Index8 { small_table(0, rgb888::as_bytes(&COLORS)) } else { 0 },
        };
        self.sender.begin(start, self.control.encoding(stream))
    }

    /// Sends lines again that were asked for, of the frame that was sent last and whose bytes these are.
    ///
    /// # Errors
    /// As [`Station::announce`].
    pub fn send_again(&mut self, bytes: &[u8]) -> Result<(), SendError<W::Error>> {
        let (Some(lines), Some(last)) = (self.control.again.take(), self.last) else { return Ok(()) };
        let line_bytes = self.control.picture.line_bytes();
        let numbered = (0_u16..).zip(bytes.chunks_exact(line_bytes));
        for (line, pixels) in numbered.skip(lines.first.into()).take(lines.count.into()) {
            self.sender.resend(&last, line, pixels)?;
        }
        Ok(())
    }
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
struct Text<const N: usize> {
    room: [u8; N],
    length: usize,
}

impl<const N: usize> Text<N> {
    fn new() -> Self {
        Self { room: [0; N], length: 0 }
    }

    fn as_str(&self) -> &str {
        self.room.get(..self.length).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or_default()
    }
}

impl<const N: usize> core::fmt::Write for Text<N> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        let rest = self.room.get_mut(self.length..).ok_or(core::fmt::Error)?;
        let whole = text.len().min(rest.len());
        // No character is cut in two.
        let fits = (0..=whole).rev().find(|&length| text.is_char_boundary(length)).unwrap_or(0);
        let (Some(rest), Some(taken)) = (rest.get_mut(..fits), text.as_bytes().get(..fits)) else {
            return Err(core::fmt::Error);
        };
        rest.copy_from_slice(taken);
        self.length += fits;
        if fits == text.len() { Ok(()) } else { Err(core::fmt::Error) }
    }
}
