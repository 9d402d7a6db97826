//! The DCMI of an emulated STM32: a register-level adapter around [`firmware::camif::Camif`], the project's one model.
//!
//! ```text
//! footage ─► Camif (sync, FIFO) ─► request line ─► the part's own DMA ─► read of DR ─► memory
//!                └─► interrupt line ─► NVIC
//! ```
//!
//! Virtual time is pixel clocks: an event of the emulator plays as many of them as fill the FIFO at most, so the DMA drains
//! it in between, and stops earlier where the interrupt line rises. The request line stands while the FIFO holds a word.
//! The emulator's DMA answers within the same instant; a [`Bus`] with latency or stalls holds the request back for as many
//! pixel clocks as it says, so overruns happen for a reason.

use std::marker::PhantomData;

use firmware::camif::registers::{Control, Register, Registers};
use firmware::camif::{Bus, Camif, FIFO_WORDS, Part};
use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::Layout;
use rigless::time::{EventId, VirtualNanos};

use crate::camera::Camera;

/// Position of the instance's one interrupt in its table, and number of its one request output.
const LINE: usize = 0;

/// Virtual nanoseconds after which a sensor that does not send is looked at again.
const LOOK: u64 = 100_000;

/// What went through the block, for the report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pixel clocks played.
    pub clocks: u64,
    /// Words that were read from DR, by DMA or by the core.
    pub words: u64,
    /// Times that the interrupt line rose.
    pub interrupts: u64,
    /// Times that the overrun flag rose.
    pub overruns: u64,
    /// Times that the frame flag rose.
    pub frames: u64,
}

/// The camera interface in the slot of a part whose registers are laid out as `R`.
#[derive(Debug)]
pub struct Dcmi<R> {
    camif: Camif<'static>,
    part: Part,
    bus: Bus,
    camera: Camera,
    counts: Counts,
    /// An instant and the clocks that had been played by then, from which the next clocks' instants are counted.
    since: Option<(VirtualNanos, u64)>,
    /// The event in which the next clocks are played.
    next: Option<EventId>,
    /// Clock at which a request that the bus holds back is made.
    grant_at: Option<u64>,
    requests: u64,
    interrupt: Level,
    request: Level,
    raised_before: u32,
    layout: PhantomData<R>,
}

impl<R: Layout> Dcmi<R> {
    /// The block as `part` has it, in front of `camera`, behind `bus`.
    #[must_use]
    pub fn new(part: Part, camera: Camera, bus: Bus) -> Self {
        Self {
            camif: Camif::new(part, Bus::IDEAL),
            part,
            bus,
            camera,
            counts: Counts::default(),
            since: None,
            next: None,
            grant_at: None,
            requests: 0,
            interrupt: Level::Low,
            request: Level::Low,
            raised_before: 0,
            layout: PhantomData,
        }
    }

    /// What went through so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The image has switched the interface on.
    #[must_use]
    pub fn is_enabled(&self) -> bool {
        Control::new_with_raw_value(self.camif.peek(Register::Control)).enable()
    }

    /// The camera has nothing more to show.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.camera.is_over()
    }

    fn register(register: R) -> Option<Register> {
        let offset = R::REGISTERS.get(register.index())?.offset;
        Register::at(u32::try_from(offset).ok()?)
    }

    /// Words that may still come before the FIFO is full, as pixel clocks.
    fn room(&self) -> usize {
        let control = Control::new_with_raw_value(self.camif.peek(Register::Control));
        let clocks_a_word = 4 / control.bus_width().bytes_per_sample() as usize;
        (FIFO_WORDS - self.camif.fifo_level()).max(1) * clocks_a_word
    }

    /// Plays the clocks that are due, sets the lines, and asks to be called when the next ones are.
    fn play(&mut self, context: &mut DeviceContext<'_>) {
        let room = self.room();
        if let Some((sync, samples)) = self.camera.ahead() {
            let due = samples.take(self.grant_at.map_or(room, |grant_at| {
                room.min(usize::try_from(grant_at.saturating_sub(self.counts.clocks)).unwrap_or(room).max(1))
            }));
            // Stops at the clock at which an interrupt line rises, for the handler to come in between.
            let done = self.camif.run(sync, due);
            self.camera.advance(done);
            self.counts.clocks += done as u64;
        }
        self.settle(context);
        self.schedule(context);
    }

    /// Asks to be called at the last clock of the next few; a sensor that does not send yet is looked at again later.
    fn schedule(&mut self, context: &mut DeviceContext<'_>) {
        let now = context.now();
        let stood_still = self.camera.ahead().is_none();
        if !self.camera.refill() {
            let wait = VirtualNanos(now.0.saturating_add(LOOK));
            self.next = (!self.camera.is_over()).then(|| context.schedule(wait));
            return;
        }
        if stood_still || self.since.is_none() {
            self.since = Some((now, self.counts.clocks));
        }
        let (Some((since, played)), Some((_, samples))) = (self.since, self.camera.ahead()) else { return };
        let clocks = self.counts.clocks - played + samples.len().min(self.room()) as u64;
        let nanos = u128::from(clocks) * 1_000_000_000 / u128::from(self.camera.pclk_hz());
        let at = VirtualNanos(since.0.saturating_add(u64::try_from(nanos).unwrap_or(u64::MAX)));
        self.next = Some(context.schedule(at));
    }

    /// Brings the lines to the levels that the block's state asks for.
    fn settle(&mut self, context: &mut DeviceContext<'_>) {
        let raised = self.camif.peek(Register::RawInterrupt);
        let rose = raised & !self.raised_before;
        self.counts.frames += u64::from(rose & 1);
        self.counts.overruns += u64::from(rose >> 1 & 1);
        self.raised_before = raised;
        let interrupt = Level::from(self.camif.interrupts().camif);
        if interrupt != self.interrupt {
            self.interrupt = interrupt;
            self.counts.interrupts += u64::from(interrupt == Level::High);
            context.interrupt(LINE, interrupt);
        }
        let waits = self.camif.fifo_level() > 0;
        if !waits {
            self.grant_at = None;
        } else if self.request == Level::Low && self.grant_at.is_none() {
            self.grant_at = Some(self.counts.clocks + u64::from(self.bus.delay(self.requests)));
            self.requests += 1;
        }
        let granted = self.grant_at.is_some_and(|at| at <= self.counts.clocks);
        let request = Level::from(waits && (granted || self.request == Level::High));
        if request != self.request {
            self.request = request;
            context.request(LINE, request);
        }
    }

    fn start_if_enabled(&mut self, context: &mut DeviceContext<'_>) {
        if self.next.is_none() && self.is_enabled() {
            self.schedule(context);
        }
    }
}

impl<R: Layout + 'static> Device for Dcmi<R> {
    type Register = R;

    fn read(&mut self, register: R, _: &mut RegisterFile, context: &mut DeviceContext<'_>) -> Option<u64> {
        let register = Self::register(register)?;
        if register != Register::Data {
            return Some(self.camif.peek(register).into());
        }
        let word = self.camif.read(register);
        self.counts.words += 1;
        self.settle(context);
        Some(word.into())
    }

    fn peek(&self, register: R, _: &RegisterFile, _: VirtualNanos) -> Option<u64> {
        Some(self.camif.peek(Self::register(register)?).into())
    }

    fn write(&mut self, register: R, value: u64, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if let Some(register) = Self::register(register) {
            self.camif.write(register, value as u32);
            self.settle(context);
            self.start_if_enabled(context);
        }
    }

    fn on_event(&mut self, event: EventId, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if self.next == Some(event) {
            self.play(context);
        }
    }

    fn reset(&mut self) {
        self.camif = Camif::new(self.part, Bus::IDEAL);
        self.since = None;
        self.next = None;
        self.grant_at = None;
        self.interrupt = Level::Low;
        self.request = Level::Low;
        self.raised_before = 0;
    }
}
