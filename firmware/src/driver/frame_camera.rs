//! A camera that captures whole frames.

use super::chunks::Plan;
use super::config::{Config, Policy};
use super::deadline::Timeout;
use super::engine::Engine;
use super::error::StartError;
use super::frame::Frame;
use super::frames::Frames;
use super::lint::{self, Layout};
use super::machine::Machine;
use super::shared::Shared;
use super::verdict::{Statistics, Verdict};
use crate::port::{Port, SLOTS};

/// A camera with `N` frame buffers, 1 to 8, of a lifetime `'m`.
///
/// Share it between tasks and the interrupt handler, for instance in a `static`. Both interrupts, the block's and the
/// DMA's, call [`FrameCamera::on_interrupt`]; a blocking wait works without any interrupt at all.
///
/// Capture goes on without a gap as long as two buffers are free or ready: three make sure of that while one is leased. With
/// two and [`Policy::NewestWins`] a ready frame is given up when the last transfer of the next one begins.
/// While the DMA writes, it must be served within the time of one transfer, at least half a frame for frames up to the
/// DMA's limit; a later service is noticed and costs frames, but never tears one.
pub struct FrameCamera<'m, P, const N: usize> {
    pub(super) shared: Shared<Frames<'m, P, N>>,
}

impl<'m, P: Port<'m>, const N: usize> FrameCamera<'m, P, N> {
    /// A camera at rest, which owns the port and the buffers.
    ///
    /// # Errors
    /// [`StartError::SlotTaken`] if the port already holds memory.
    pub fn new(port: P, buffers: [&'m mut [u32]; N]) -> Result<Self, StartError> {
        const { assert!(N >= 1 && N <= SLOTS, "a camera takes 1 to 8 buffers") };
        Ok(Self { shared: Shared::new(Frames::new(Engine::new(port, buffers)?)) })
    }

    /// Starts capture, afresh if it runs already. Leased frames keep their buffers until they are dropped.
    ///
    /// # Errors
    /// A configuration that the [linter](super::lint) forbids, a buffer that is too small, or a DMA that refuses. Nothing
    /// runs then.
    pub fn start(&self, config: &Config) -> Result<(), StartError> {
        self.shared.with(|state| {
            let frames = &mut state.machine;
            frames.stop();
            let part = frames.engine.port().part();
            if let Some(finding) = lint::first_error(config, &part, Layout::Frames) {
                return Err(StartError::Refused(finding));
            }
            let plan = frame_plan(config, part.transfer_limit).unwrap_or_default();
            frames.engine.check_room(plan.room())?;
            frames.start(config, plan).map_err(StartError::Dma)
        })
    }

    /// Stops capture at once. Frames that were ready are given up; leased ones stay valid.
    pub fn stop(&self) {
        self.shared.with(|state| state.machine.stop());
    }

    /// Serves the block and the DMA: the handler of both their interrupts. Takes a bounded time.
    pub fn on_interrupt(&self) {
        self.shared.with_wake(Frames::service);
    }

    /// Asks for one frame ([`Policy::Snapshot`]; without effect otherwise). If it comes damaged, the next one is taken.
    pub fn trigger(&self) {
        self.shared.with(|state| state.machine.trigger());
    }

    /// A frame, if one is ready: the newest or the oldest one, by [`Policy`].
    pub fn try_frame(&self) -> Option<Frame<'_, 'm, P, N>> {
        self.shared.with(|state| self.lease(&mut state.machine))
    }

    /// Waits for a frame until `deadline`. `idle` is called over and over; it may sleep until an interrupt, and returns
    /// the time in ticks of its own.
    ///
    /// # Errors
    /// [`Timeout`] with the cause, when `idle` returns `deadline` or later and no frame is ready.
    pub fn wait_frame(
        &self,
        deadline: u64,
        idle: impl FnMut() -> u64,
    ) -> Result<Frame<'_, 'm, P, N>, Timeout> {
        self.shared.wait(deadline, idle, |frames| self.lease(frames))
    }

    /// Waits for a frame until `deadline`, in the ticks that [`FrameCamera::advance`] is told; `u64::MAX` is for ever.
    /// Woken by [`FrameCamera::on_interrupt`]. If several tasks wait, each frame goes to one of them.
    ///
    /// # Errors
    /// [`Timeout`] with the cause.
    pub async fn next_frame(&self, deadline: u64) -> Result<Frame<'_, 'm, P, N>, Timeout> {
        self.shared.next(deadline, |frames| self.lease(frames)).await
    }

    /// Tells the time to tasks that wait with a deadline: call it from a timer's interrupt. Time does not go back.
    pub fn advance(&self, now: u64) {
        self.shared.advance(now);
    }

    /// What became of the frames so far.
    pub fn statistics(&self) -> Statistics {
        self.shared.with(|state| state.machine.tally.statistics)
    }

    /// Why no frame would come if a wait ended now.
    pub fn diagnose(&self) -> Timeout {
        self.shared.with(|state| state.machine.diagnose())
    }

    /// Stops, and gives the port and the buffers back.
    pub fn into_parts(self) -> (P, [Option<&'m mut [u32]>; N]) {
        let mut frames = self.shared.into_machine();
        frames.stop();
        frames.engine.into_parts()
    }

    fn lease(&self, frames: &mut Frames<'m, P, N>) -> Option<Frame<'_, 'm, P, N>> {
        let (memory, slot, length, verdict) = frames.lease()?;
        Some(Frame::new(self, memory, slot, length, verdict))
    }

    /// A leased buffer comes back.
    pub(super) fn give_back(&self, slot: usize, memory: &'m mut [u32]) {
        self.shared.with_wake(|frames| {
            // The slot is empty since the lease, and nobody else lends.
            if frames.engine.port().lend(slot, memory).is_ok() {
                frames.release(slot);
            }
            core::mem::take(&mut frames.fresh)
        });
    }
}

/// How frames of this configuration are cut; `None` if they are empty or too long.
#[must_use]
pub fn frame_plan(config: &Config, transfer_limit: u32) -> Option<Plan> {
    let geometry = config.geometry();
    let words = if config.jpeg { geometry.bytes().div_ceil(4) } else { geometry.words() };
    let one_by_one = config.jpeg || config.policy == Policy::Snapshot;
    Plan::new(u32::try_from(words).ok()?, transfer_limit, one_by_one)
}

impl<'m, P: Port<'m>, const N: usize> Frames<'m, P, N> {
    /// Takes a ready frame out, memory and all.
    fn lease(&mut self) -> Option<(&'m mut [u32], usize, usize, Verdict)> {
        let lease = self.pool.lease(self.order())?;
        self.tally.drop_ready(lease.recycled);
        let Some(memory) = self.engine.port().take_back(lease.slot) else {
            // The DMA does not aim at a ready buffer; should a port disagree, the frame is not to be trusted.
            self.pool.release(lease.slot);
            self.tally.drop_ready(1);
            return None;
        };
        let mut verdict = lease.verdict;
        self.tally.deliver(&mut verdict);
        // The last bytes of a frame that don't fill a word are padded for compressed frames, and else missing.
        let bytes =
            if self.expected.jpeg { verdict.bytes } else { verdict.bytes.min(self.expected.bytes) & !3 };
        let length = (bytes as usize).min(memory.len().saturating_mul(4));
        Some((memory, lease.slot, length, verdict))
    }
}
