//! A camera that captures line by line, into memory for a few lines only.

use core::fmt;
use core::ops::Deref;

use super::config::Config;
use super::deadline::Timeout;
use super::engine::Engine;
use super::error::StartError;
use super::lines::Lines;
use super::lint::{self, Layout};
use super::machine::Machine;
use super::shared::Shared;
use super::verdict::{Statistics, Verdict};
use crate::buffers::ring::{LineInfo, Next};
use crate::port::{Port, SLOTS};

/// A camera with `N` line buffers, 3 to 8, of a lifetime `'m`. Memory does not depend on a frame's height.
///
/// Two buffers are with the DMA at any time, so with four the consumer may lag by two lines. A line for which no buffer is
/// free is dropped and counted. Share it as [`FrameCamera`](super::FrameCamera); it must be served once a line.
pub struct LineCamera<'m, P, const N: usize> {
    pub(super) shared: Shared<Lines<'m, P, N>>,
}

/// What comes from the wires.
#[derive(Debug)]
pub enum LineEvent<'c, 'm, P: Port<'m>, const N: usize> {
    /// A line.
    Line(Line<'c, 'm, P, N>),
    /// The end of the frame whose lines came before.
    FrameEnd(Verdict),
}

impl<'m, P: Port<'m>, const N: usize> LineCamera<'m, P, N> {
    /// A camera at rest, which owns the port and the buffers.
    ///
    /// # Errors
    /// [`StartError::SlotTaken`] if the port already holds memory.
    pub fn new(port: P, buffers: [&'m mut [u32]; N]) -> Result<Self, StartError> {
        const { assert!(N >= 3 && N <= SLOTS, "a camera takes 3 to 8 line buffers") };
        Ok(Self { shared: Shared::new(Lines::new(Engine::new(port, buffers)?)) })
    }

    /// Starts capture, afresh if it runs already. [`Policy`](super::config::Policy) and
    /// [`Damaged`](super::config::Damaged) have no meaning here: lines come as they are.
    ///
    /// # Errors
    /// A configuration that the [linter](super::lint) forbids, a buffer that is too small, or a DMA that refuses. Nothing
    /// runs then.
    pub fn start(&self, config: &Config) -> Result<(), StartError> {
        self.shared.with(|state| {
            let lines = &mut state.machine;
            lines.stop();
            let part = lines.engine.port().part();
            if let Some(finding) = lint::first_error(config, &part, Layout::Lines) {
                return Err(StartError::Refused(finding));
            }
            lines.engine.check_room(u64::from(config.geometry().line_words()))?;
            lines.start(config).map_err(StartError::Dma)
        })
    }

    /// Stops capture at once. Lines that were ready are given up; leased ones stay valid.
    pub fn stop(&self) {
        self.shared.with(|state| state.machine.stop());
    }

    /// Serves the block and the DMA: the handler of both their interrupts. Takes a bounded time.
    pub fn on_interrupt(&self) {
        self.shared.with_wake(Lines::service);
    }

    /// The next line or end of a frame, if there is one.
    pub fn try_line(&self) -> Option<LineEvent<'_, 'm, P, N>> {
        self.shared.with(|state| self.lease(&mut state.machine))
    }

    /// Waits for a line or the end of a frame until `deadline`. `idle` is called over and over; it may sleep until an
    /// interrupt, and returns the time in ticks of its own.
    ///
    /// # Errors
    /// [`Timeout`] with the cause, when `idle` returns `deadline` or later and nothing has come.
    pub fn wait_line(
        &self,
        deadline: u64,
        idle: impl FnMut() -> u64,
    ) -> Result<LineEvent<'_, 'm, P, N>, Timeout> {
        self.shared.wait(deadline, idle, |lines| self.lease(lines))
    }

    /// Waits for a line or the end of a frame until `deadline`, in the ticks that [`LineCamera::advance`] is told;
    /// `u64::MAX` is for ever. Woken by [`LineCamera::on_interrupt`].
    ///
    /// # Errors
    /// [`Timeout`] with the cause.
    pub async fn next_line(&self, deadline: u64) -> Result<LineEvent<'_, 'm, P, N>, Timeout> {
        self.shared.next(deadline, |lines| self.lease(lines)).await
    }

    /// Tells the time to tasks that wait with a deadline: call it from a timer's interrupt. Time does not go back.
    pub fn advance(&self, now: u64) {
        self.shared.advance(now);
    }

    /// What became of the frames so far. A frame counts as delivered if all its lines were handed on.
    pub fn statistics(&self) -> Statistics {
        self.shared.with(|state| state.machine.tally.statistics)
    }

    /// Why no line would come if a wait ended now.
    pub fn diagnose(&self) -> Timeout {
        self.shared.with(|state| state.machine.diagnose())
    }

    /// Stops, and gives the port and the buffers back.
    pub fn into_parts(self) -> (P, [Option<&'m mut [u32]>; N]) {
        let mut lines = self.shared.into_machine();
        lines.stop();
        lines.engine.into_parts()
    }

    fn lease(&self, lines: &mut Lines<'m, P, N>) -> Option<LineEvent<'_, 'm, P, N>> {
        match lines.next()? {
            (Next::End(verdict), _) => Some(LineEvent::FrameEnd(verdict)),
            (Next::Line { slot, line }, memory) => {
                Some(LineEvent::Line(Line { camera: self, memory, slot, info: line }))
            }
        }
    }

    fn give_back(&self, slot: usize, memory: &'m mut [u32]) {
        self.shared.with(|state| {
            // The slot is empty since the lease, and nobody else lends.
            if state.machine.engine.port().lend(slot, memory).is_ok() {
                state.machine.release(slot);
            }
        });
    }
}

impl<'m, P: Port<'m>, const N: usize> Lines<'m, P, N> {
    /// Takes out what comes next, memory and all.
    fn next(&mut self) -> Option<(Next, Option<&'m mut [u32]>)> {
        let mut next = self.ring.pop()?;
        let memory = match &mut next {
            Next::Line { slot, .. } => self.engine.port().take_back(*slot),
            Next::End(verdict) => {
                self.tally.hand_out(verdict);
                None
            }
        };
        Some((next, memory))
    }
}

/// A line in its buffer; reads as bytes. Dropping it gives the buffer back.
pub struct Line<'c, 'm, P: Port<'m>, const N: usize> {
    camera: &'c LineCamera<'m, P, N>,
    memory: Option<&'m mut [u32]>,
    slot: usize,
    info: LineInfo,
}

impl<'m, P: Port<'m>, const N: usize> Line<'_, 'm, P, N> {
    /// Sequence number of its frame; see [`Verdict::sequence`].
    #[must_use]
    pub fn frame(&self) -> u32 {
        self.info.frame
    }

    /// Number of the line in its frame, from 0.
    #[must_use]
    pub fn index(&self) -> u32 {
        self.info.index
    }

    /// Its bytes as the DMA wrote them. If it is shorter than configured, its length is known to the byte with
    /// [`Config::line_interrupts`] only, and if it left the FIFO before the next line ended; else to the end of the word.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        let memory: &[u8] = bytemuck::cast_slice(self.memory.as_deref().unwrap_or(&[]));
        memory.get(..self.info.bytes as usize).unwrap_or(memory)
    }
}

impl<'m, P: Port<'m>, const N: usize> Deref for Line<'_, 'm, P, N> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.bytes()
    }
}

impl<'m, P: Port<'m>, const N: usize> fmt::Debug for Line<'_, 'm, P, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Line").field("slot", &self.slot).field("info", &self.info).finish_non_exhaustive()
    }
}

impl<'m, P: Port<'m>, const N: usize> Drop for Line<'_, 'm, P, N> {
    fn drop(&mut self) {
        if let Some(memory) = self.memory.take() {
            self.camera.give_back(self.slot, memory);
        }
    }
}
