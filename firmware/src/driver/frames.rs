//! Capture of whole frames: the state machine behind [`FrameCamera`](super::FrameCamera).
//!
//! ```text
//!            arm                  frame's end, no buffer            a buffer comes back
//!  Stopped ───────► Running ───────────────────────────► Paused ──────────────────────┐
//!                    ▲   │ damage                                                      │
//!                    │   ▼                                                             │
//!                    └─ Flushing (until CAPTURE reads 0) ◄─────────────────────────────┘
//! ```
//!
//! Two ways to follow a frame. *Seamless*: equal transfers fill it, and while its last one runs the next frame's buffer
//! is found, or capture is told to stop behind this frame. *One by one*: capture stops by itself at the frame's end, the
//! FIFO is drained, and the DMA's position tells the length. After any damage the DMA starts again at the beginning of a
//! buffer, before the next frame that is let in; what was in flight is lost, and nothing torn is ever ready.
//!
//! How a frame's end is judged stands in `judge.rs`.

use super::chunks::Plan;
use super::config::{Config, Damaged, Policy};
use super::engine::{Engine, Progress, even_burst};
use super::machine::{Machine, Parts, Phase};
use super::meter::{Expectation, Meter};
use super::tally::{Absence, Tally};
use super::verdict::{Outcome, Verdict};
use crate::buffers::pool::{FramePool, Order};
use crate::camif::registers::{DmaMode, Events, FrameRate};
use crate::port::{DmaError, Port, Target, Transfer};

/// The buffer at which the DMA is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filling {
    pub(super) slot: u8,
    /// Transfer of the frame that is in progress.
    pub(super) window: u32,
    /// The frame has ended on the wires, and its last words are on their way.
    pub(super) ended: Option<Verdict>,
}

/// The state of a capture of frames.
#[derive(Debug)]
pub(super) struct Frames<'m, P, const N: usize> {
    pub(super) engine: Engine<'m, P>,
    pub(super) pool: FramePool<N>,
    pub(super) phase: Phase,
    pub(super) plan: Plan,
    transfer: Transfer,
    pub(super) policy: Policy,
    pub(super) damaged: Damaged,
    pub(super) expected: Expectation,
    pub(super) meter: Meter,
    pub(super) filling: Option<Filling>,
    /// The buffer that is full to the last word, while the frame's end has not been seen.
    pub(super) transferred: Option<u8>,
    /// The buffer that follows.
    pub(super) next: Option<u8>,
    /// A snapshot was asked for that has not been taken yet.
    pub(super) pending: bool,
    /// A frame has become ready since the consumer was last woken.
    pub(super) fresh: bool,
    pub(super) tally: Tally,
}

impl<'m, P: Port<'m>, const N: usize> Machine<'m> for Frames<'m, P, N> {
    type Port = P;

    fn parts(&mut self) -> Parts<'_, 'm, P> {
        let Self { engine, phase, meter, tally, fresh, .. } = self;
        Parts { engine, phase: *phase, meter, tally, fresh }
    }

    fn run(&mut self, events: Events) -> Result<(), Outcome> {
        let stood_before_last = self.filling.is_some_and(|filling| filling.window + 1 < self.plan.count);
        self.advance()?;
        let reached_last = self.filling.is_none_or(|filling| filling.window + 1 == self.plan.count);
        if self.plan.seamless && events.frame() && stood_before_last && reached_last {
            // What follows the frame had to be decided before its end, and the DMA did not wait for it.
            return Err(Outcome::LateInterrupt);
        }
        if events.line() {
            let bytes =
                if self.engine.has_counters() { self.engine.line_bytes() } else { self.position() * 4 };
            self.meter.line(&self.expected, bytes);
        }
        if events.frame() { self.frame_ended() } else { Ok(()) }
    }

    fn lose(&mut self, outcome: Outcome, in_frame: bool) {
        self.tally.evidence.words_moved |= self.position() > 0;
        let ended = self.filling.is_some_and(|filling| filling.ended.is_some());
        self.tally.lose_in_flight(outcome, ended, in_frame);
        self.recover();
    }

    fn restart(&mut self) {
        if self.policy == Policy::Snapshot && !self.pending {
            self.phase = Phase::Idle;
            self.tally.absence = Absence::Skipped;
        } else if self.engine.is_quiet() {
            // A refusal is told to whoever waits.
            let _ = self.launch();
        } else {
            self.phase = Phase::Flushing;
        }
    }

    fn position(&mut self) -> u32 {
        match self.filling {
            _ if self.transferred.is_some() => self.expected.words,
            Some(filling) => filling.window * self.plan.chunk + self.engine.moved(),
            None => 0,
        }
    }
}

impl<'m, P: Port<'m>, const N: usize> Frames<'m, P, N> {
    pub(super) fn new(engine: Engine<'m, P>) -> Self {
        let burst = crate::camif::registers::Burst::One;
        Self {
            engine,
            pool: FramePool::new(),
            phase: Phase::Stopped,
            plan: Plan::default(),
            transfer: Transfer {
                words: 0,
                mode: DmaMode::Single,
                burst,
                line_by_line: false,
                half_interrupt: false,
            },
            policy: Policy::NewestWins,
            damaged: Damaged::Discard,
            expected: Expectation::default(),
            meter: Meter::default(),
            filling: None,
            transferred: None,
            next: None,
            pending: false,
            fresh: false,
            tally: Tally::new(0, FrameRate::All),
        }
    }

    /// Starts as configured. The configuration has been linted, and the buffers are long enough for the plan.
    pub(super) fn start(&mut self, config: &Config, plan: Plan) -> Result<(), DmaError> {
        self.stop();
        let part = self.engine.port().part();
        self.plan = plan;
        self.transfer = Transfer {
            words: plan.chunk,
            mode: if plan.count > 1 { DmaMode::Double } else { DmaMode::Single },
            burst: even_burst(config.burst, plan.chunk),
            line_by_line: false,
            half_interrupt: false,
        };
        (self.policy, self.damaged) = (config.policy, config.damaged);
        self.expected = Expectation::new(config, &part);
        self.tally = Tally::new(self.expected.words, config.frame_rate);
        self.engine.program(config, !plan.seamless, config.line_interrupts);
        (self.phase, self.pending) = (Phase::Idle, false);
        if self.policy == Policy::Snapshot {
            self.tally.absence = Absence::Skipped;
            self.engine.capture(false);
            return Ok(());
        }
        self.launch()
    }

    /// Stops at once. Frames that are ready are given up; leased ones stay.
    pub(super) fn stop(&mut self) {
        self.engine.off();
        self.phase = Phase::Stopped;
        (self.filling, self.transferred, self.next) = (None, None, None);
        let ready = self.pool.clear();
        self.tally.drop_ready(ready);
    }

    /// Keeps the DMA supplied.
    pub(super) fn advance(&mut self) -> Result<(), Outcome> {
        let Progress::Completed { .. } = self.engine.progress()? else { return Ok(()) };
        self.tally.evidence.words_moved = true;
        let count = self.plan.count;
        let Some(filling) = &mut self.filling else { return Err(self.too_long()) };
        filling.window += 1;
        let (slot, window) = (filling.slot, filling.window);
        if !self.plan.seamless {
            // At the end of the buffer the DMA goes on at its stale target: what it moves there is too much, and shows.
            return match () {
                () if window + 1 < count => self.engine.aim_free(slot, self.plan.start(window + 1)),
                () if window > count => Err(self.too_long()),
                () => Ok(()),
            };
        }
        match count - window {
            0 => self.filled(),
            1 => self.look_ahead(),
            _ => self.engine.aim_free(slot, self.plan.start(window + 1)),
        }
    }

    /// The last transfer of a frame runs: finds the next frame a buffer, or stops capture behind this one.
    fn look_ahead(&mut self) -> Result<(), Outcome> {
        let slot = self.pool.claim().or_else(|| {
            let recycled = (self.policy == Policy::NewestWins).then(|| self.pool.recycle()).flatten();
            self.tally.drop_ready(u32::from(recycled.is_some()));
            recycled
        });
        match slot {
            Some(slot) => {
                self.next = Some(slot as u8);
                self.engine.aim_free(slot as u8, 0)
            }
            None => {
                self.engine.capture(false);
                // Had this frame ended before, capture would stop behind the next one only.
                if self.engine.frame_has_ended() { Err(Outcome::LateInterrupt) } else { Ok(()) }
            }
        }
    }

    /// The last transfer of a frame is complete, and the DMA is in the next frame's buffer.
    fn filled(&mut self) -> Result<(), Outcome> {
        let Some(full) = self.filling.take() else { return Ok(()) };
        if let Some(slot) = self.next.take() {
            self.filling = Some(Filling { slot, window: 0, ended: None });
            self.engine.aim_free(slot, self.plan.start(1))?;
        }
        match full.ended {
            Some(verdict) => {
                let finished = self.finish(full.slot, verdict);
                return finished.inspect_err(|&outcome| self.tally.lose(outcome));
            }
            None => {
                if let Some(slot) = self.transferred.replace(full.slot) {
                    self.pool.abandon(usize::from(slot));
                    return Err(self.too_long());
                }
            }
        }
        Ok(())
    }

    /// A good frame is whole in memory.
    pub(super) fn finish(&mut self, slot: u8, verdict: Verdict) -> Result<(), Outcome> {
        let last = self.filling.is_none();
        if last && self.plan.seamless && self.engine.moved() > 0 {
            // Capture was told too late to stop behind it, and the DMA is in its buffer again.
            self.pool.abandon(usize::from(slot));
            return Err(Outcome::LateInterrupt);
        }
        self.pool.finish(usize::from(slot), verdict);
        (self.fresh, self.pending) = (true, false);
        if last {
            self.engine.stop_dma();
            self.restart();
        }
        Ok(())
    }

    /// Stops the DMA and what is being captured, and starts again.
    pub(super) fn recover(&mut self) {
        self.engine.stop_dma();
        let filling = self.filling.take().map(|filling| filling.slot);
        for slot in [filling, self.transferred.take(), self.next.take()].into_iter().flatten() {
            self.pool.abandon(usize::from(slot));
        }
        self.engine.capture(false);
        self.tally.absence = Absence::Lost;
        self.restart();
    }

    /// Aims at a free buffer and lets the next frame in.
    fn launch(&mut self) -> Result<(), DmaError> {
        self.meter = Meter::default();
        let Some(slot) = self.pool.claim() else {
            self.phase = Phase::Paused;
            self.tally.absence = Absence::Dropped;
            return Ok(());
        };
        let first = slot as u8;
        let aimed = self.engine.aim(Target::Zero, first, 0).and_then(|()| {
            let second = if self.plan.count > 1 { self.plan.start(1) } else { 0 };
            self.engine.aim(Target::One, first, second)
        });
        match aimed.and_then(|()| self.engine.arm(self.transfer)) {
            Ok(()) => {
                self.phase = Phase::Running;
                self.filling = Some(Filling { slot: first, window: 0, ended: None });
            }
            Err(error) => {
                self.pool.abandon(slot);
                self.stop();
                self.tally.evidence.refused = true;
                return Err(error);
            }
        }
        Ok(())
    }

    /// Asks for a snapshot.
    pub(super) fn trigger(&mut self) {
        self.pending = true;
        if self.phase == Phase::Idle {
            self.restart();
        }
    }

    /// A leased buffer is free again.
    pub(super) fn release(&mut self, slot: usize) {
        self.pool.release(slot);
        match self.phase {
            Phase::Paused => self.restart(),
            Phase::Running => {
                self.service();
                // Capture was told to stop behind the frame in progress, for want of this buffer.
                let last = self.filling.is_some_and(|filling| filling.window + 1 == self.plan.count);
                if self.plan.seamless && last && self.next.is_none() && self.phase == Phase::Running {
                    self.revoke_stop();
                }
            }
            Phase::Stopped | Phase::Idle | Phase::Flushing => {}
        }
    }

    fn revoke_stop(&mut self) {
        let Some(slot) = self.pool.claim() else { return };
        self.next = Some(slot as u8);
        match self.engine.aim_free(slot as u8, 0) {
            Ok(()) => self.engine.capture(true),
            Err(outcome) => self.lose(outcome, true),
        }
    }

    pub(super) fn too_long(&self) -> Outcome {
        Outcome::Long { expected: self.expected.bytes }
    }

    /// How a consumer takes frames.
    pub(super) fn order(&self) -> Order {
        if self.policy == Policy::NewestWins { Order::Newest } else { Order::Oldest }
    }
}
