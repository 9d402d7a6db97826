//! The driver on the model: a sender plays frames on the wires, a bench calls the handler when an interrupt line is high.

mod cost;
mod frames;
mod lines;
mod overrun;
mod random;
mod waits;

use core::cell::RefCell;

use super::config::tests::{GATED, MARKER};
use super::{Config, FrameCamera};
use crate::camif::pins::{Samples, Sync};
use crate::camif::registers::SyncCodes;
use crate::camif::{Bus, Camif, Part};
use crate::driver::config::SyncMode;

/// The model behind a shared reference: the driver's port.
pub(super) type Model<'c, 'm> = &'c RefCell<Camif<'m>>;

/// How the sender tells lines and frames apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wires {
    Gated,
    Marker,
    Embedded,
}

pub(super) const ALL_WIRES: [Wires; 3] = [Wires::Gated, Wires::Marker, Wires::Embedded];

impl Wires {
    pub(super) fn mode(self) -> SyncMode {
        match self {
            Self::Gated => GATED,
            Self::Marker => MARKER,
            Self::Embedded => SyncMode::Embedded {
                codes: SyncCodes::new_with_raw_value(0xFF9D_80FF),
                unmask: SyncCodes::new_with_raw_value(0xFFFF_FFFF),
            },
        }
    }
}

/// A frame as a list of lines.
pub(super) type Lines = Vec<Vec<u8>>;

/// A frame whose every byte tells its frame and place; no byte is 00 or FF, which embedded codes are made of.
pub(super) fn picture(number: usize, line_bytes: usize, lines: usize) -> Lines {
    let byte = |y: usize, x: usize| {
        let mixed = (number * 40_503 + y * 2_654_435 + x * 7_919 + 12_345).wrapping_mul(0x9E37_79B9) >> 16;
        (mixed % 254 + 1) as u8
    };
    (0..lines).map(|y| (0..line_bytes).map(|x| byte(y, x)).collect()).collect()
}

/// Plays frames on the wires, and calls the handler `latency` clocks after an interrupt line has risen.
pub(super) struct Sender<'a, 'm> {
    pub(super) model: &'a RefCell<Camif<'m>>,
    pub(super) handler: &'a dyn Fn(),
    pub(super) wires: Wires,
    pub(super) latency: usize,
    /// Pixel clocks between lines and between frames.
    pub(super) blanking: (usize, usize),
    /// Clocks until the handler is called.
    due: Option<usize>,
    first: bool,
    ticks: u32,
}

impl<'a, 'm> Sender<'a, 'm> {
    pub(super) fn new(model: &'a RefCell<Camif<'m>>, handler: &'a dyn Fn(), wires: Wires) -> Self {
        Self { model, handler, wires, latency: 0, blanking: (3, 40), due: None, first: true, ticks: 0 }
    }

    /// How often this was called, from 1.
    pub(super) fn tick(&mut self) -> u32 {
        self.ticks += 1;
        self.ticks
    }

    /// Samples at constant levels.
    pub(super) fn samples(&mut self, hsync: bool, vsync: bool, bytes: &[u8]) {
        let mut rest = Samples::Bytes(bytes);
        self.serve();
        while !rest.is_empty() {
            let part = rest.take(self.due.unwrap_or(usize::MAX));
            let done = self.model.borrow_mut().run(Sync { hsync, vsync }, part);
            rest = rest.skip(done);
            self.due = self.due.map(|due| due - done);
            self.serve();
        }
    }

    /// Calls the handler when it is time, until the lines are low.
    fn serve(&mut self) {
        for round in 0.. {
            if !self.model.borrow().interrupts().any() {
                self.due = None;
                break;
            }
            if *self.due.get_or_insert(self.latency) > 0 {
                break;
            }
            assert!(round < 32, "the interrupt line stays high");
            (self.handler)();
        }
    }

    fn blank(&mut self, vsync: bool, clocks: usize) {
        self.samples(true, vsync, &vec![0x55; clocks]);
    }

    fn code(&mut self, code: u8) {
        self.samples(false, false, &[0xFF, 0, 0, code]);
    }

    /// A frame. For marking wires its end is told by the next one's start, or by `close`.
    pub(super) fn frame(&mut self, lines: &[Vec<u8>]) {
        let (horizontal, vertical) = self.blanking;
        match self.wires {
            Wires::Gated => {
                if core::mem::take(&mut self.first) {
                    self.blank(true, 4);
                }
                self.blank(false, horizontal);
                for line in lines {
                    self.samples(false, false, line);
                    self.blank(false, horizontal);
                }
                self.blank(true, vertical);
            }
            Wires::Marker => {
                for (y, line) in lines.iter().enumerate() {
                    let marked = !core::mem::take(&mut self.first);
                    let (head, tail) = line.split_at(usize::from(!line.is_empty()));
                    self.samples(marked, marked && y == 0, head);
                    self.samples(false, false, tail);
                }
            }
            Wires::Embedded => {
                if core::mem::take(&mut self.first) {
                    self.code(0xB6);
                }
                for line in lines {
                    self.code(0x80);
                    self.samples(false, false, line);
                    self.code(0x9D);
                    self.samples(false, false, &vec![0x10; horizontal]);
                }
                self.code(0xB6);
                self.samples(false, false, &vec![0x10; vertical]);
            }
        }
    }

    /// Ends the last frame, and lets the bus settle.
    pub(super) fn close(&mut self) {
        match self.wires {
            Wires::Gated => self.blank(true, 200),
            Wires::Marker => {
                self.samples(true, true, &[0x55]);
            }
            Wires::Embedded => self.samples(false, false, &[0x10; 200]),
        }
        for _ in 0..500 {
            self.model.borrow_mut().elapse(1);
            self.due = self.due.map(|_| 0);
            self.serve();
        }
    }
}

/// A camera of `N` buffers of `words` words on a model of `part` and `bus`, for the length of `body`.
pub(super) fn with_camera<const N: usize>(
    part: Part,
    bus: Bus,
    words: usize,
    body: impl for<'c, 'm> FnOnce(Model<'c, 'm>, &FrameCamera<'m, Model<'c, 'm>, N>),
) {
    let mut memory = vec![0; words * N];
    let mut chunks = memory.chunks_exact_mut(words);
    let buffers: [&mut [u32]; N] = core::array::from_fn(|_| chunks.next().unwrap());
    let model = RefCell::new(Camif::new(part, bus));
    let camera = FrameCamera::new(&model, buffers).unwrap();
    body(&model, &camera);
}
