//! What the host has chosen, and what is to be done about it.

use core::fmt;

use super::stages::{KNOWN, Stages};
use crate::link::packet::{Meaning, State, Status};
use crate::link::{Choice, Device, Format, Parameter, Resend};
use crate::pipeline::{Output, Settings, Smoothing};
use crate::port::Registers;
use algos_nostd::pixel::format::Meaning as Means;
use algos_nostd::pixel::yuv422::Coefficients;

/// The raw frames.
pub(super) const RAW: u8 = 0;
/// What the stages make of them.
pub(super) const MADE: u8 = 1;
/// Both.
pub(super) const STREAMS: u8 = 2;

/// The picture that the camera is configured for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels a line.
    pub width: u16,
    /// Lines.
    pub height: u16,
    /// What its bytes mean; a format of whole pixels.
    pub format: Format,
    /// What the format leaves open.
    pub meaning: Meaning,
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
pub struct Control<R> {
    registers: R,
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

impl<R> Control<R> {
    /// Capture runs, and the raw frames are on.
    pub(super) fn new(registers: R, picture: Picture, room: usize, period_ms: i32) -> Self {
        let mut control = Self {
            registers,
            picture,
            state: State::Running,
            left: 0,
            order: Some(Order::Start),
            on: 1 << RAW,
            encodings: [Choice::Sender; STREAMS as usize],
            stages: Stages::Color,
            room,
            changed: 0,
            period: period_ms,
            held: None,
            base: 0,
            next: 0,
            again: None,
        };
        let sobel = Stages::Sobel(Smoothing::Gaussian3);
        if control.fits(sobel) {
            control.stages = sobel;
        }
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

    /// A frame was sent: after the last one of a snapshot, the device stops.
    pub(super) fn sent(&mut self) {
        if self.state == State::Snapshot {
            self.left = self.left.saturating_sub(1);
            if self.left == 0 {
                (self.state, self.order) = (State::Stopped, Some(Order::Stop));
            }
        }
    }

    /// What makes the second stream.
    pub(super) fn settings(&self, output: Output<'static>) -> Option<Settings<'static>> {
        let Picture { width, height, format: Format::Pixels(format), .. } = self.picture else { return None };
        let mut settings = Settings::new(width.into(), height.into());
        (settings.format, settings.output) = (format, output);
        let Meaning { bayer, matrix, range } = self.picture.meaning;
        settings.meaning = Means { yuv: Coefficients::new(matrix, range), bayer };
        Some(settings)
    }

    fn fits(&self, stages: Stages) -> bool {
        self.settings(stages.output()).is_some_and(|settings| settings.memory() <= self.room)
    }

    /// The format of a stream.
    pub(super) fn format(&self, stream: u8) -> Format {
        match (stream, self.stages) {
            (RAW, _) => self.picture.format,
            (_, Stages::Color) => Format::RGB888,
            _ => Format::GRAY8,
        }
    }
}

impl<R: Registers> Device for Control<R> {
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
        let stages = Stages::read(pipeline).ok_or_else(|| say(format_args!("{KNOWN}")));
        match (stream, stages) {
            (RAW, Ok(Stages::Color)) => Ok(()),
            (RAW, _) => {
                say(format_args!("stream {RAW} is the raw picture; stages go to stream {MADE}"));
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
            (MADE, Err(())) => Err(Status::OutOfRange),
            _ => Err(Status::NoStream),
        }
    }

    fn parameter(&self, number: u16) -> Option<Parameter<'_>> {
        let period = Parameter { name: "frame period (ms)", value: self.period, least: 0, greatest: 60_000 };
        (number == 0).then_some(period)
    }

    fn set_parameter(&mut self, _number: u16, value: i32) -> Result<(), Status> {
        self.period = value;
        Ok(())
    }

    fn registers(&mut self) -> &mut dyn Registers {
        &mut self.registers
    }

    fn resend(&mut self, lines: &Resend) -> Result<u16, Status> {
        if lines.stream != RAW {
            return Err(if lines.stream < STREAMS { Status::Unsupported } else { Status::NoStream });
        }
        if self.held != Some(lines.sequence) {
            return Err(Status::Gone);
        }
        let count = lines.count.min(self.picture.height.saturating_sub(lines.first));
        self.again = Some(Resend { count, ..*lines });
        Ok(count)
    }
}
