//! What both state machines do alike: they serve the interrupts, and say why nothing comes.
//!
//! ```text
//!  events ─► damage? ──────────► lose ─┐
//!              │ no                    ├─► VSYNC: count the frame ─► at rest after a flush: restart
//!              └─► run (its own) ──────┘
//! ```

use super::deadline::Timeout;
use super::engine::Engine;
use super::meter::Meter;
use super::tally::Tally;
use super::verdict::Outcome;
use crate::camif::registers::Events;
use crate::port::Port;

/// What capture is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// Not started, stopped, or refused by the DMA.
    Stopped,
    /// A snapshot has been taken, and no other was asked for.
    Idle,
    /// A frame is awaited or captured.
    Running,
    /// The rest of a frame passes by before capture can start again.
    Flushing,
    /// No buffer is free.
    Paused,
}

/// What every state machine has.
pub(super) struct Parts<'a, 'm, P> {
    pub(super) engine: &'a mut Engine<'m, P>,
    pub(super) phase: Phase,
    pub(super) meter: &'a mut Meter,
    pub(super) tally: &'a mut Tally,
    /// Something has become ready since the consumer was last woken.
    pub(super) fresh: &'a mut bool,
}

/// A state machine behind a camera.
pub(super) trait Machine<'m> {
    type Port: Port<'m>;

    fn parts(&mut self) -> Parts<'_, 'm, Self::Port>;

    /// Events while capture runs; `Err` if what is in flight can't be trusted any more.
    fn run(&mut self, events: Events) -> Result<(), Outcome>;

    /// Gives up all that is in flight, the frame on the wires too if `in_frame`.
    fn lose(&mut self, outcome: Outcome, in_frame: bool);

    /// The DMA has stopped: captures again as soon as the block has come to rest.
    fn restart(&mut self);

    /// Words of the frame in progress that have reached memory.
    fn position(&mut self) -> u32;

    /// Does what the interrupts ask for. True if something has become ready.
    fn service(&mut self) -> bool {
        let Parts { engine, phase, tally, .. } = self.parts();
        if phase == Phase::Stopped {
            return false;
        }
        let events = engine.take_events();
        if events.line() {
            tally.line();
        }
        if phase == Phase::Running {
            let sound = tally.events(events);
            if let Err(outcome) = sound.and_then(|()| self.run(events)) {
                // Between frames nothing but what has ended can be lost.
                let between = !events.vsync() && self.parts().engine.status().vsync();
                self.lose(outcome, !between);
            }
        }
        if events.vsync() {
            let Parts { phase, meter, tally, .. } = self.parts();
            tally.vsync(phase);
            // Lines before this were measured for a frame that ended, or for one that was lost on the way.
            *meter = Meter::default();
        }
        if self.parts().phase == Phase::Flushing {
            self.restart();
        }
        core::mem::take(self.parts().fresh)
    }

    /// Why nothing would come if a wait ended now.
    fn diagnose(&mut self) -> Timeout {
        let status = self.parts().engine.status();
        let words = if self.parts().phase == Phase::Running { self.position() } else { 0 };
        let Parts { phase, tally, .. } = self.parts();
        let evidence = &mut tally.evidence;
        evidence.look(status);
        evidence.words = words;
        evidence.words_moved |= words > 0;
        evidence.no_buffer = phase == Phase::Paused;
        evidence.stopped = matches!(phase, Phase::Stopped | Phase::Idle);
        Timeout::new(*evidence)
    }
}
