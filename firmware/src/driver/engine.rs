//! The hands of the driver: every access to the block and its DMA, in an order that is safe.
//!
//! Three rules stand behind it. Registers are read and written a bounded number of times. A frame is only let in once the
//! DMA is ready for it: CAPTURE is set last. And what the DMA has done is told by the target it is at, not by its flag
//! alone, so that an interrupt that was served too late is seen rather than believed.

use core::marker::PhantomData;

use super::config::Config;
use super::error::StartError;
use super::verdict::Outcome;
use crate::camif::FIFO_WORDS;
use crate::camif::registers::{Burst, Control, DmaMode, Events, Register, Status};
use crate::port::{DmaError, DmaEvents, Port, Target, Transfer};

/// Times that the FIFO's state is read, at most, while the DMA empties it after a frame's end. On silicon some 10 µs.
pub(super) const POLLS: u32 = 256;

/// The longest burst, up to `most`, that divides a transfer: no burst straddles two of them, which DMA controllers forbid
/// (RM0090 §10.3.11 has the count be a multiple of the burst).
pub(super) fn even_burst(most: Burst, words: u32) -> Burst {
    let divides = |burst: &Burst| burst.words() <= most.words() && words.is_multiple_of(burst.words());
    [Burst::Four, Burst::Two].into_iter().find(divides).unwrap_or(Burst::One)
}

/// A camera interface, and what the driver knows of its state.
#[derive(Debug)]
pub(super) struct Engine<'m, P> {
    port: P,
    /// The shortest of the buffers and its words.
    shortest: (u8, u32),
    /// CR as it is to be while capture is off.
    control: Control,
    /// Words a transfer.
    chunk: u32,
    double: bool,
    /// The target at which the DMA was when last looked at.
    current: Target,
    memory: PhantomData<&'m mut [u32]>,
}

/// What the DMA did since it was last asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// Nothing that counts.
    Nothing,
    /// It completed a transfer.
    Completed {
        /// The target that is free now; any, if the DMA stopped.
        freed: Target,
        /// Words of the line (line by line only).
        line_words: u32,
    },
}

impl<'m, P: Port<'m>> Engine<'m, P> {
    /// Lends all buffers to the port.
    pub(super) fn new<const N: usize>(mut port: P, buffers: [&'m mut [u32]; N]) -> Result<Self, StartError> {
        let mut shortest = (0, u32::MAX);
        for (slot, buffer) in buffers.into_iter().enumerate() {
            // A transfer reaches no further than 2²⁸ words, so a longer buffer counts as that.
            let words = u32::try_from(buffer.len()).unwrap_or(u32::MAX);
            if words < shortest.1 {
                shortest = (slot as u8, words);
            }
            port.lend(slot, buffer).map_err(|_| StartError::SlotTaken { slot })?;
        }
        Ok(Self {
            port,
            shortest,
            control: Control::default(),
            chunk: 0,
            double: false,
            current: Target::Zero,
            memory: PhantomData,
        })
    }

    pub(super) fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// The port, and what of the buffers is not leased.
    pub(super) fn into_parts<const N: usize>(mut self) -> (P, [Option<&'m mut [u32]>; N]) {
        let buffers = core::array::from_fn(|slot| self.port.take_back(slot));
        (self.port, buffers)
    }

    /// Every buffer has the words that are needed.
    pub(super) fn check_room(&self, needed: u64) -> Result<(), StartError> {
        let (buffer, words) = self.shortest;
        if needed > u64::from(words) {
            return Err(StartError::BufferTooSmall { buffer: usize::from(buffer), needed, words });
        }
        Ok(())
    }

    pub(super) fn has_counters(&self) -> bool {
        self.port.part().counters
    }

    /// Turns everything off.
    pub(super) fn off(&mut self) {
        self.control = Control::default();
        self.port.write(Register::InterruptEnable, 0);
        self.port.write(Register::Control, 0);
        self.port.stop();
        self.drain();
        self.port.write(Register::InterruptClear, Events::MASK);
        let all = DmaEvents { half: true, complete: true, error: true, line_words: 0 };
        self.port.acknowledge(all);
    }

    /// Programs all registers; nothing is enabled yet. Events of lines are taken if `lines`.
    pub(super) fn program(&mut self, config: &Config, one_frame: bool, lines: bool) {
        self.off();
        let part = self.port.part();
        config.program(&mut self.port, &part);
        let events = Events::default()
            .with_frame(true)
            .with_overrun(true)
            .with_error(true)
            .with_vsync(true)
            .with_line(lines);
        self.port.write(Register::InterruptEnable, events.raw_value());
        self.control = config.control(one_frame).with_enable(true);
    }

    /// Starts the DMA at target 0, then lets the next frame in. Both must be at rest, and the targets aimed.
    pub(super) fn arm(&mut self, transfer: Transfer) -> Result<(), DmaError> {
        self.drain();
        self.port.start(transfer)?;
        self.chunk = transfer.words;
        self.double = transfer.mode == DmaMode::Double;
        self.current = Target::Zero;
        // A frame end on the wires still counts; all else belongs to what was before.
        let stale = Events::default().with_frame(true).with_overrun(true).with_error(true).with_line(true);
        self.port.write(Register::InterruptClear, stale.raw_value());
        self.capture(true);
        Ok(())
    }

    /// Lets frames in, or no more after the one in progress.
    pub(super) fn capture(&mut self, on: bool) {
        self.port.write(Register::Control, self.control.with_capture(on).raw_value());
    }

    /// No frame is being captured, and none will be: CAPTURE reads 0.
    pub(super) fn is_quiet(&mut self) -> bool {
        !Control::new_with_raw_value(self.port.read(Register::Control)).capture()
    }

    pub(super) fn stop_dma(&mut self) {
        self.port.stop();
    }

    /// Takes what is left in the FIFO out.
    fn drain(&mut self) {
        for _ in 0..2 * FIFO_WORDS {
            if !self.status().fifo_not_empty() {
                break;
            }
            self.port.read(Register::Data);
        }
    }

    /// The enabled events that happened, now cleared.
    pub(super) fn take_events(&mut self) -> Events {
        let events = self.port.read(Register::MaskedInterrupt);
        if events != 0 {
            self.port.write(Register::InterruptClear, events);
        }
        Events::new_with_raw_value(events)
    }

    /// The end of a frame is to be served.
    pub(super) fn frame_has_ended(&mut self) -> bool {
        Events::new_with_raw_value(self.port.read(Register::MaskedInterrupt)).frame()
    }

    pub(super) fn status(&mut self) -> Status {
        Status::new_with_raw_value(self.port.read(Register::Status))
    }

    /// Bytes of the line that ended last.
    pub(super) fn line_bytes(&mut self) -> u32 {
        self.port.read(Register::LineBytes)
    }

    /// Bytes and lines of the frame that ended last.
    pub(super) fn frame_counts(&mut self) -> (u32, u32) {
        (self.port.read(Register::FrameBytes), self.port.read(Register::FrameLines))
    }

    /// What the DMA did. `Err` if it failed, or went on further than it was aimed.
    pub(super) fn progress(&mut self) -> Result<Progress, Outcome> {
        let events = self.port.events();
        if events.error || events.complete || events.half {
            self.port.acknowledge(events);
        }
        if events.error {
            return Err(Outcome::DmaError);
        }
        let moved_on = self.double && self.port.target() != self.current;
        match (events.complete, moved_on) {
            (false, false) => return Ok(Progress::Nothing),
            (true, true) => {}
            (true, false) if !self.double => {}
            // An even number of transfers: one at least went where it should not.
            (true, false) => return Err(Outcome::LateInterrupt),
            // It completed between the two looks.
            (false, true) => {
                let complete = DmaEvents { complete: true, ..DmaEvents::default() };
                self.port.acknowledge(complete);
            }
        }
        let freed = self.current;
        if self.double {
            self.current = freed.other();
        }
        let line_words =
            if moved_on && !events.complete { self.port.events().line_words } else { events.line_words };
        Ok(Progress::Completed { freed, line_words })
    }

    /// Words that the transfer in progress has moved. A single transfer stops at its end, and then has moved none.
    pub(super) fn moved(&mut self) -> u32 {
        self.chunk.saturating_sub(self.port.remaining())
    }

    /// The target that is not in use.
    pub(super) fn free_target(&self) -> Target {
        self.current.other()
    }

    /// Points a target, before the DMA starts.
    pub(super) fn aim(&mut self, target: Target, slot: u8, start: usize) -> Result<(), DmaError> {
        self.port.aim(target, usize::from(slot), start)
    }

    /// Points the target that is not in use. `Err` if the DMA has come to use it meanwhile, or refuses.
    pub(super) fn aim_free(&mut self, slot: u8, start: usize) -> Result<(), Outcome> {
        let free = self.free_target();
        self.port.aim(free, usize::from(slot), start).map_err(|_| Outcome::DmaError)?;
        if self.port.target() == free { Err(Outcome::LateInterrupt) } else { Ok(()) }
    }
}
