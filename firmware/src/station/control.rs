//! What the host has chosen, and what is to be done about it.

use core::fmt;

use super::board::Board;
use super::stages::{Made, Stages};
use crate::link::packet::{Meaning, State, Status};
use crate::link::{Choice, Device, Format, Parameter, Resend};
use crate::pipeline::Smoothing;
use crate::port::Registers;

/// The raw frames.
pub const RAW: u8 = 0;
/// What the stages make of them.
pub const MADE: u8 = 1;
/// Both.
pub const STREAMS: u8 = 2;

/// Parameters of the station itself; the board's follow.
const PARAMETERS: u16 = 1;

/// The picture that the camera is configured for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Picture {
    /// What the raw stream is called.
    pub name: &'static str,
    /// Pixels a line.
    pub width: u16,
    /// Lines.
    pub height: u16,
    /// What its bytes mean; a format of whole pixels.
    pub format: Format,
    /// What the format leaves open.
    pub meaning: Meaning,
}

impl Picture {
    /// Bytes of a line, one at least.
    pub(super) fn line_bytes(&self) -> usize {
        self.format.line_bytes(self.width.into()).max(1)
    }
}

/// What the board is to do with its camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Start capture, afresh if it runs.
    Start,
    /// Stop capture.
    Stop,
}

/// What the host has chosen.
#[derive(Debug)]
pub struct Control<B> {
    /// The board.
    pub board: B,
    pub(super) picture: Picture,
    pub(super) state: State,
    /// Frames of the snapshot that are still to come.
    left: u16,
    order: Option<Order>,
    /// Streams that are on, a bit each.
    pub(super) on: u32,
    pub(super) encodings: [Choice; STREAMS as usize],
    pub(super) stages: Stages,
    /// Words that the stages may take.
    room: usize,
    /// Streams of which something has changed, a bit each.
    pub(super) changed: u32,
    /// Milliseconds from frame to frame at least.
    period: i32,
    /// The frame that can be sent again.
    pub(super) held: Option<u32>,
    /// Number of the first frame since capture was started last, and of the next one: numbers never go back.
    base: u32,
    next: u32,
    pub(super) again: Option<Resend>,
}

impl<B> Control<B> {
    /// Capture runs, and the raw frames are on. The stages are the best that fit.
    pub(super) fn new(board: B, picture: Picture, room: usize, period_ms: i32) -> Self {
        let sobel = Stages { balance: false, made: Made::Sobel(Smoothing::Gaussian3) };
        let mut control = Self {
            board,
            picture,
            state: State::Running,
            left: 0,
            order: Some(Order::Start),
            on: 1 << RAW,
            encodings: [Choice::Sender; STREAMS as usize],
            stages: Stages::COLOR,
            room,
            changed: 0,
            period: period_ms,
            held: None,
            base: 0,
            next: 0,
            again: None,
        };
        let best = [Stages::START, sobel].into_iter().find(|stages| control.fits(*stages));
        control.stages = best.unwrap_or(Stages::COLOR);
        control
    }

    /// What the camera is to do, once.
    pub fn take_order(&mut self) -> Option<Order> {
        let order = self.order.take();
        if order == Some(Order::Start) {
            self.base = self.next;
        }
        order
    }

    /// The number on the wire of a frame, which the driver counts from the start of capture.
    pub(super) fn number(&mut self, sequence: u32) -> u32 {
        let number = self.base.wrapping_add(sequence);
        self.next = number.wrapping_add(1);
        number
    }

    /// Frames are wanted.
    #[must_use]
    pub fn is_capturing(&self) -> bool {
        self.state != State::Stopped
    }

    /// Milliseconds from frame to frame at least.
    #[must_use]
    pub fn period_ms(&self) -> u32 {
        self.period.unsigned_abs()
    }

    /// The camera is configured for other pictures now, and starts afresh if it ran.
    pub fn show(&mut self, picture: Picture) {
        self.picture = picture;
        self.changed = (1 << STREAMS) - 1;
        self.release();
        if self.is_capturing() {
            self.order = Some(Order::Start);
        }
    }

    /// The frame that was sent last is no longer there to be sent again.
    pub fn release(&mut self) {
        (self.held, self.again) = (None, None);
    }

    /// A frame was sent: after the last one of a snapshot, the device stops. One from before a new order does not count.
    pub(super) fn sent(&mut self) {
        if self.state == State::Snapshot && self.order.is_none() {
            self.left = self.left.saturating_sub(1);
            if self.left == 0 {
                (self.state, self.order) = (State::Stopped, Some(Order::Stop));
            }
        }
    }

    fn fits(&self, stages: Stages) -> bool {
        stages.needs(self.picture.width.into(), self.picture.height.into()) <= self.room
    }

    /// The format of a stream.
    pub(super) fn format(&self, stream: u8) -> Format {
        if stream == RAW { self.picture.format } else { self.stages.format() }
    }

    /// What the format of a stream leaves open.
    pub(super) fn meaning(&self, stream: u8) -> Meaning {
        if stream == RAW { self.picture.meaning } else { Meaning::default() }
    }

    /// The encoding that is asked for.
    pub(super) fn encoding(&self, stream: u8) -> Choice {
        self.encodings.get(usize::from(stream)).copied().unwrap_or(Choice::Sender)
    }
}

impl<B: Board> Device for Control<B> {
    fn start(&mut self) -> Result<(), Status> {
        if self.state != State::Running {
            (self.state, self.order) = (State::Running, Some(Order::Start));
        }
        Ok(())
    }

    fn stop(&mut self) -> Result<(), Status> {
        if self.state != State::Stopped {
            (self.state, self.order) = (State::Stopped, Some(Order::Stop));
        }
        Ok(())
    }

    fn snapshot(&mut self, frames: u16) -> Result<(), Status> {
        (self.state, self.left, self.order) = (State::Snapshot, frames, Some(Order::Start));
        Ok(())
    }

    fn select_streams(&mut self, on: u32) -> Result<u32, Status> {
        if on >> STREAMS != 0 {
            return Err(Status::NoStream);
        }
        self.changed |= self.on ^ on;
        self.on = on;
        Ok(on)
    }

    fn choose_encoding(&mut self, stream: Option<u8>, choice: Choice) -> Result<(), Status> {
        for (number, encoding) in (0..).zip(&mut self.encodings) {
            if stream.is_none_or(|stream| stream == number) {
                *encoding = choice;
                self.changed |= 1 << number;
            }
        }
        if stream.is_none_or(|stream| stream < STREAMS) { Ok(()) } else { Err(Status::NoStream) }
    }

    fn choose_stages(&mut self, stream: u8, pipeline: &str, text: &mut dyn fmt::Write) -> Result<(), Status> {
        // What does not fit the reply is cut.
        let mut say = |what: fmt::Arguments<'_>| _ = text.write_fmt(what);
        match (stream, Stages::read(pipeline)) {
            (RAW, Ok(Stages::COLOR)) => Ok(()),
            (RAW, _) => {
                say(format_args!("stream {RAW} is the frame as captured; stages go to stream {MADE}"));
                Err(Status::Unsupported)
            }
            (MADE, Ok(stages)) if self.fits(stages) => {
                say(format_args!("{stages}"));
                self.stages = stages;
                self.changed |= 1 << MADE;
                Ok(())
            }
            (MADE, Ok(_)) => {
                say(format_args!("not enough memory for that"));
                Err(Status::Unsupported)
            }
            (MADE, Err(error)) => {
                say(format_args!("{error}"));
                Err(Status::OutOfRange)
            }
            _ => Err(Status::NoStream),
        }
    }

    fn parameter(&self, number: u16) -> Option<Parameter<'_>> {
        match number.checked_sub(PARAMETERS) {
            None => {
                let (name, value) = ("frame period (ms)", self.period);
                Some(Parameter { name, value, least: 0, greatest: 60_000 })
            }
            Some(number) => self.board.parameter(number),
        }
    }

    fn set_parameter(&mut self, number: u16, value: i32) -> Result<(), Status> {
        match number.checked_sub(PARAMETERS) {
            None => self.period = value,
            Some(number) => self.board.set_parameter(number, value)?,
        }
        Ok(())
    }

    fn registers(&mut self) -> &mut dyn Registers {
        self.board.registers()
    }

    fn read_sensor(&mut self, register: u32) -> Result<u32, Status> {
        self.board.read_sensor(register)
    }

    fn write_sensor(&mut self, register: u32, value: u32) -> Result<(), Status> {
        self.board.write_sensor(register, value)
    }

    fn resend(&mut self, lines: &Resend) -> Result<u16, Status> {
        if lines.stream >= STREAMS {
            return Err(Status::NoStream);
        }
        // What the stages made is not kept.
        if lines.stream != RAW || self.held != Some(lines.sequence) {
            return Err(Status::Gone);
        }
        let count = lines.count.min(self.picture.height.saturating_sub(lines.first));
        self.again = Some(Resend { count, ..*lines });
        Ok(count)
    }
}
