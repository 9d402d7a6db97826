//! The DCMI of an emulated STM32: a register-level adapter around [`firmware::camif::Camif`], the project's one model.
//!
//! ```text
//! footage ─► Camif (sync, FIFO) ─► request line ─► the part's own DMA ─► read of DR ─► memory
//!                └─► interrupt line ─► NVIC
//! ```
//!
//! Virtual time is pixel clocks. An event of the emulator costs some microseconds, for every model of the part is asked
//! what it wants, so an event brings a batch of clocks: one FIFO's worth at first, and twice as many each time that the
//! reader has kept up, to the next edge of a sync wire at most, where interrupts rise. Within the batch the clocks are
//! played one FIFO's worth at a time, the next when the reader has taken the last word of those before. The request line
//! rises when the FIFO is full, or at an edge with what is in it, and stands until it is empty. The emulator's DMA answers
//! within the same instant; a [`Bus`] with latency or stalls holds the request back for as many pixel clocks as it says, so
//! overruns happen for a reason.
//!
//! What the core sees is not late: an access of it plays the clocks that are due before it. An interrupt of the camera
//! interface at a sync edge is not late either, for the batch ends there. The DMA's interrupts come at the end of the batch
//! in which they fall, [`BATCH_WORDS`] late at most, and the core sees the DMA's counter move in such steps.

use std::marker::PhantomData;

use firmware::camif::registers::{Control, Register, Registers};
use firmware::camif::{Bus, Camif, FIFO_WORDS, Part};
use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::Layout;
use rigless::time::{EventId, VirtualNanos};

use crate::camera::Camera;

/// Position of the instance's one interrupt in its table, and number of its one request output.
const LINE: usize = 0;

/// Words that one event brings, at most.
pub const BATCH_WORDS: u64 = 64;

/// Pixel clocks that one event brings while the block takes none of their samples, at most.
const BATCH_IDLE: u64 = 65_536;

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
    /// Times that the level of VSYNC changed.
    pub vsync_edges: u64,
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
    /// The clock up to which time has come; more than have been played while words wait for their reader.
    due: u64,
    /// Clocks that the next event brings.
    batch: u64,
    /// Words taken when the last event was over.
    words_before: u64,
    /// Clock at which a request that the bus holds back is made.
    grant_at: Option<u64>,
    requests: u64,
    /// The level of VSYNC at the last clock.
    vsync: bool,
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
            due: 0,
            batch: 0,
            words_before: 0,
            grant_at: None,
            requests: 0,
            vsync: false,
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
        Register::at(offset)
    }

    /// Pixel clocks that make a word.
    fn clocks_a_word(&self) -> u64 {
        let control = Control::new_with_raw_value(self.camif.peek(Register::Control));
        4 / u64::from(control.bus_width().bytes_per_sample())
    }

    /// The clocks that have come by now, by the pixel clock's rate.
    fn come(&self, now: VirtualNanos) -> u64 {
        let Some((since, played)) = self.since else { return self.counts.clocks };
        let nanos = u128::from(now.0.saturating_sub(since.0));
        let clocks = nanos * u128::from(self.camera.pclk_hz()) / 1_000_000_000;
        played.saturating_add(u64::try_from(clocks).unwrap_or(u64::MAX))
    }

    /// The instant of a clock, rounded up.
    fn instant(&self, clock: u64) -> VirtualNanos {
        let Some((since, played)) = self.since else { return VirtualNanos(0) };
        let nanos = u128::from(clock.saturating_sub(played)) * 1_000_000_000;
        let nanos = nanos.div_ceil(u128::from(self.camera.pclk_hz()));
        VirtualNanos(since.0.saturating_add(u64::try_from(nanos).unwrap_or(u64::MAX)))
    }

    /// Plays the clocks that are due, until the block has words that its reader may take, or raises its interrupt.
    ///
    /// If `late`, the words that are there have waited since an earlier instant, so nobody takes them at once, and the clocks
    /// do not wait for them.
    fn play(&mut self, late: bool, context: &mut DeviceContext<'_>) {
        let clocks_a_word = self.clocks_a_word();
        while self.counts.clocks < self.due {
            let left = self.due - self.counts.clocks;
            // No further than the clock at which the FIFO may be full: some clocks of a word may have come before.
            let words = (FIFO_WORDS - self.camif.fifo_level()) as u64;
            let room = words.checked_sub(1).map_or(u64::MAX, |words| words * clocks_a_word + 1);
            let until_grant =
                self.grant_at.map_or(u64::MAX, |at| at.saturating_sub(self.counts.clocks).max(1));
            let most = if late { left } else { left.min(room).min(until_grant) };
            let Some((sync, samples)) = self.camera.ahead() else { break };
            let was = self.interrupt;
            // Stops at the clock at which an interrupt line rises, for the handler to come in between.
            let played = self.camif.run(sync, samples.take(usize::try_from(most).unwrap_or(usize::MAX)));
            let is_edge = played == samples.len();
            self.camera.advance(played);
            self.counts.clocks += played as u64;
            self.counts.vsync_edges += u64::from(played > 0 && sync.vsync != self.vsync);
            self.vsync = sync.vsync;
            self.settle(is_edge, context);
            if played == 0 || (was, self.interrupt) == (Level::Low, Level::High) {
                // What else was due comes after the handler: the pixel clock runs on from here.
                self.due = self.counts.clocks;
                self.since = Some((context.now(), self.due));
                break;
            }
            if self.request == Level::High && !late {
                break;
            }
        }
    }

    /// Plays what has come by now.
    fn catch_up(&mut self, context: &mut DeviceContext<'_>) {
        let late = self.request == Level::High;
        let come = self.come(context.now());
        if come > self.due {
            self.due = come;
            self.play(late, context);
        }
    }

    /// Asks to be called when the next batch is due; a sensor that does not send yet is looked at again later.
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
            self.due = self.counts.clocks;
        }
        // Those before `due` are played in this instant still, as fast as the reader takes their words.
        let pending = self.due - self.counts.clocks;
        let clocks = self.camera.until_edge(pending).map_or(1, |edge| edge.min(self.batch).max(1));
        self.next = Some(context.schedule(self.instant(self.due + clocks).max(VirtualNanos(now.0 + 1))));
    }

    /// As many clocks for the next event as the last ones have shown to be right.
    fn fit_batch(&mut self) {
        let fifo = FIFO_WORDS as u64 * self.clocks_a_word();
        let kept_up = self.counts.clocks == self.due && self.request == Level::Low;
        let most = if self.counts.words == self.words_before {
            BATCH_IDLE
        } else {
            BATCH_WORDS * self.clocks_a_word()
        };
        self.words_before = self.counts.words;
        self.batch = if kept_up { (2 * self.batch).clamp(fifo, most) } else { fifo };
    }

    /// Brings the lines to the levels that the block's state asks for. A FIFO that is not full asks for its reader only at
    /// an `edge` of a sync wire, when no more words may come for a while.
    fn settle(&mut self, edge: bool, context: &mut DeviceContext<'_>) {
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
        let words = self.camif.fifo_level();
        let waits = words > 0;
        if !waits {
            self.grant_at = None;
        } else if self.request == Level::Low && self.grant_at.is_none() && (edge || words == FIFO_WORDS) {
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
        self.catch_up(context);
        if register != Register::Data {
            return Some(self.camif.peek(register).into());
        }
        let word = self.camif.read(register);
        self.counts.words += 1;
        self.settle(false, context);
        if self.request == Level::Low {
            self.play(false, context);
        }
        Some(word.into())
    }

    fn peek(&self, register: R, _: &RegisterFile, _: VirtualNanos) -> Option<u64> {
        Some(self.camif.peek(Self::register(register)?).into())
    }

    fn write(&mut self, register: R, value: u64, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if let Some(register) = Self::register(register) {
            self.catch_up(context);
            self.camif.write(register, value as u32);
            self.settle(false, context);
            self.start_if_enabled(context);
        }
    }

    fn on_event(&mut self, event: EventId, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        if self.next == Some(event) {
            self.fit_batch();
            self.catch_up(context);
            self.schedule(context);
        }
    }

    fn reset(&mut self) {
        self.camif = Camif::new(self.part, Bus::IDEAL);
        self.since = None;
        self.next = None;
        self.due = self.counts.clocks;
        self.batch = 0;
        self.grant_at = None;
        self.interrupt = Level::Low;
        self.request = Level::Low;
        self.raised_before = 0;
    }
}
