use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use firmware::link::packet::{Heartbeat, Hello, Level, Log, Palette, State, Stream as Described};
use firmware::link::{
    ALL_COMMANDS, BODY_MAX, COMMAND_BODY_MAX, Dispatcher, Encoding, Inbox, Outgoing, Packet, Received,
    SendError, Sender, Then, VERSION,
};

use super::board::{Board, Held};
use super::line::Line;
use super::noise::Rates;
use super::transport::Change;
use crate::picture::crc32_after;

/// Between two heartbeats.
const BEAT: Duration = Duration::from_secs(1);
/// Between two STREAM and PALETTE of a stream that is on, in heartbeats.
const DESCRIBE: u32 = 2;
/// The longest wait, so that Ctrl-C is not waited for.
const LOOK: Duration = Duration::from_millis(100);

/// A frame on its way: for each stream what was sent of it, and the next line.
struct UnderWay {
    held: Rc<Held>,
    streams: Vec<Option<Outgoing>>,
    line: u16,
}

/// Memory that the link is lent.
pub(super) struct Memory {
    sender: Vec<u8>,
    inbox: Vec<u8>,
    replies: Vec<u8>,
}

impl Memory {
    pub(super) fn new() -> Self {
        Self {
            sender: vec![0; firmware::link::wire_bytes(BODY_MAX)],
            inbox: vec![0; COMMAND_BODY_MAX],
            replies: vec![0; firmware::link::REPLY_MEMORY],
        }
    }
}

/// The device and its serial line: takes commands, and sends what there is to send.
pub(super) struct Station<'s, 'c, 'm> {
    pub(super) board: Board<'c, 'm>,
    sender: Sender<'s, Line>,
    inbox: Inbox<'s>,
    dispatcher: Dispatcher<'s>,
    received: Vec<u8>,
    name: String,
    session: u32,
    baud: u32,
    noise: Rates,
    seed: u64,
    started: Instant,
    beaten: Instant,
    beats: u32,
    way: Option<UnderWay>,
    /// Palettes of the streams as they were sent last.
    palettes: Vec<u32>,
    stop: &'s AtomicBool,
    /// Frames that were sent to their END.
    pub(super) frames: u64,
    /// It is over after so many.
    pub(super) frames_wanted: Option<u64>,
}

/// What was sent is in a queue without an end; only a packet that is too long fails, and no packet of ours is.
fn sent<E: std::fmt::Debug>(result: Result<(), SendError<E>>) {
    if let Err(error) = result {
        debug_assert!(false, "{error:?}");
    }
}

impl<'s, 'c, 'm> Station<'s, 'c, 'm> {
    pub(super) fn new(
        board: Board<'c, 'm>,
        line: Line,
        memory: &'s mut Memory,
        stop: &'s AtomicBool,
        name: String,
        (baud, noise, seed): (Option<u32>, Rates, u64),
    ) -> Self {
        let now = Instant::now();
        let streams = board.streams.len();
        Self {
            board,
            sender: Sender::new(line, &mut memory.sender, crc32_after),
            inbox: Inbox::new(&mut memory.inbox, crc32_after),
            dispatcher: Dispatcher::new(&mut memory.replies, crc32_after),
            received: Vec::new(),
            name,
            session: session(),
            baud: baud.unwrap_or(0),
            noise,
            seed,
            started: now,
            beaten: now,
            beats: 0,
            way: None,
            palettes: vec![0; streams],
            stop,
            frames: 0,
            frames_wanted: None,
        }
    }

    pub(super) fn line(&mut self) -> &mut Line {
        self.sender.writer_mut()
    }

    /// It was told to stop, or has sent all its frames.
    pub(super) fn is_over(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.frames_wanted.is_some_and(|wanted| self.frames >= wanted)
    }

    /// Nobody listens, or nothing is to be captured.
    pub(super) fn rests(&mut self) -> bool {
        self.board.state == State::Stopped || !self.line().is_open()
    }

    fn now(&self) -> u64 {
        self.started.elapsed().as_micros() as u64
    }

    /// Talks with the host until that time; at least once around.
    pub(super) fn serve(&mut self, until: Instant) {
        loop {
            self.listen();
            self.tell();
            let mut busy = true;
            while busy && self.line().has_room() && !self.is_over() {
                busy = self.send_line();
            }
            self.listen();
            let now = Instant::now();
            if now >= until || self.is_over() {
                return;
            }
            if !(busy && self.line().has_room()) {
                let longest = (until - now).min(LOOK);
                self.line().wait(longest);
            }
        }
    }

    /// Moves bytes, and carries out the commands among them.
    fn listen(&mut self) {
        let mut received = std::mem::take(&mut self.received);
        match self.line().attend(&mut received) {
            Some(Change::Came) => {
                self.dispatcher.forget();
                self.hello();
            }
            Some(Change::Gone) => self.way = None,
            None => {}
        }
        let mut rest = received.as_slice();
        while !rest.is_empty() {
            let taken = self.inbox.push(rest);
            rest = rest.get(taken..).unwrap_or_default();
            let then = match self.inbox.received() {
                Some(Received::Packet(Packet::Command(command))) => {
                    let (reply, then) = self.dispatcher.handle(&mut self.board, &command);
                    sent(self.sender.send(&Packet::Reply(reply)));
                    then
                }
                Some(Received::OtherVersion { .. }) => Then::Hello,
                _ => Then::Nothing,
            };
            match then {
                Then::Nothing => {}
                Then::Hello => self.hello(),
                Then::Heartbeat => self.heartbeat(),
            }
        }
        received.clear();
        self.received = received;
    }

    /// Says who this is and what it sends.
    fn hello(&mut self) {
        sent(self.sender.send(&Packet::Hello(Hello {
            oldest: VERSION,
            newest: VERSION,
            takes: COMMAND_BODY_MAX as u16,
            sends: BODY_MAX as u16,
            streams: self.board.streams.len() as u8,
            commands: ALL_COMMANDS,
            encodings: Encoding::bits(&Encoding::ALL),
            session: self.session,
            name: &self.name,
        })));
        for number in 0..self.board.streams.len() {
            self.describe(number);
        }
    }

    /// Sends a stream's STREAM, and its PALETTE if it has one.
    fn describe(&mut self, number: usize) {
        let Some(stream) = self.board.streams.get(number) else { return };
        let (format, width, height) = stream.shape;
        sent(self.sender.send(&Packet::Stream(Described {
            stream: number as u8,
            format,
            encoding: stream.choice,
            on: stream.on,
            width,
            height,
            meaning: stream.meaning(&self.board.profile),
            pipeline: &stream.text,
            name: stream.name,
        })));
        self.board.changed &= !(1 << number);
        if let Some(colors) = &stream.palette {
            sent(self.sender.send(&Packet::Palette(Palette { stream: number as u8, colors })));
        }
    }

    fn heartbeat(&mut self) {
        let counts = self.inbox.counts();
        let beat = Heartbeat {
            session: self.session,
            uptime: self.now(),
            frames: self.board.statistics(),
            packets_sent: self.sender.packets(),
            bytes_sent: self.sender.bytes(),
            packets_unsent: 0,
            packets_received: counts.received,
            packets_damaged: counts.damaged + counts.malformed + counts.other_version,
            baud: self.baud,
            state: self.board.state,
            cause: self.board.cause(),
        };
        sent(self.sender.send(&Packet::Heartbeat(beat)));
    }

    /// Says what has changed, and what is due.
    fn tell(&mut self) {
        if std::mem::take(&mut self.board.noise_changed) {
            let noise = Rates { bits: f64::from(self.board.bit_errors) / 1e9, ..self.noise };
            let seed = self.seed;
            self.line().set_noise(noise, seed);
        }
        for number in 0..self.board.streams.len() {
            if self.board.changed >> number & 1 != 0 {
                self.describe(number);
            }
        }
        // What nobody hears is kept for who comes.
        while self.line().is_open()
            && let Some((level, text)) = self.board.log.pop_front()
        {
            let log = Log { level, cut: false, lost: 0, time: self.now(), text: &text };
            sent(self.sender.send(&Packet::Log(log)));
        }
        if self.beaten.elapsed() >= BEAT && self.line().has_room() {
            self.beaten = Instant::now();
            self.beats = self.beats.wrapping_add(1);
            self.heartbeat();
            if self.beats.is_multiple_of(DESCRIBE) {
                for number in 0..self.board.streams.len() {
                    if self.board.streams[number].on {
                        self.describe(number);
                    }
                }
            }
        }
    }

    /// Sends the next line of each stream, or what else of a frame is next. False if there is nothing to send.
    fn send_line(&mut self) -> bool {
        if let Some((held, stream, mut range)) = self.board.again.pop_front() {
            if let (Some(line), Some(frame)) =
                (range.next(), held.streams.get(stream).and_then(Option::as_ref))
            {
                let outgoing = Outgoing::new(frame.start, frame.choice, crc32_after);
                sent(self.sender.resend(&outgoing, line, frame.line(line).unwrap_or_default()));
                self.board.again.push_front((held, stream, range));
            }
            return true;
        }
        let Some(mut way) = self.way.take() else { return self.begin() };
        let mut left = false;
        for (frame, outgoing) in way.held.streams.iter().zip(&mut way.streams) {
            let (Some(frame), Some(outgoing)) = (frame, outgoing) else { continue };
            if let Some(pixels) = frame.line(way.line).filter(|_| way.line < frame.start.height) {
                sent(self.sender.line(outgoing, way.line, pixels));
                left = true;
            }
        }
        way.line = way.line.saturating_add(1);
        if left {
            self.way = Some(way);
            return true;
        }
        for outgoing in way.streams.iter().flatten() {
            sent(self.sender.end(outgoing.end().judged(&way.held.verdict)));
        }
        self.frames += 1;
        true
    }

    /// Begins with the next captured frame.
    fn begin(&mut self) -> bool {
        let now = self.now();
        let Some(held) = self.board.take_frame(now) else { return false };
        let mut streams = Vec::new();
        for (number, frame) in held.streams.iter().enumerate() {
            let Some(frame) = frame else {
                streams.push(None);
                continue;
            };
            if self.palettes[number] != frame.start.palette {
                self.palettes[number] = frame.start.palette;
                if let Some(colors) = &frame.palette {
                    sent(self.sender.send(&Packet::Palette(Palette { stream: number as u8, colors })));
                }
            }
            streams.push(self.sender.begin(frame.start, frame.choice).ok());
        }
        self.way = Some(UnderWay { held, streams, line: 0 });
        true
    }

    /// Says goodbye in the log, and gives what waits a moment to leave.
    pub(super) fn close(&mut self) {
        self.board.say(Level::Information, "the device is switched off");
        let until = Instant::now() + Duration::from_millis(200);
        self.tell();
        while Instant::now() < until && !self.line().is_idle() && self.line().is_open() {
            self.listen();
            self.line().wait(Duration::from_millis(10));
        }
    }
}

/// Another number after every start.
fn session() -> u32 {
    let since = std::time::SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
    crc32_after(std::process::id(), &since.as_nanos().to_le_bytes())
}
