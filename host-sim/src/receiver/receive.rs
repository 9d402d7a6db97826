use std::cell::RefCell;
use std::convert::Infallible;

use firmware::camif::pins::{Samples, Sync};
use firmware::camif::{Bus, Camif, Part};
use firmware::driver::deadline::{Cause, Timeout};
use firmware::driver::verdict::{Outcome, Statistics, Verdict};
use firmware::driver::{Config, FrameCamera, StartError, frame_plan};
use firmware::trace::StretchSink;

use super::activity::{Activity, Bucket};

/// Frame buffers: two that the DMA fills in turn, and two for frames that ended close to each other.
const BUFFERS: usize = 4;

/// Bus time after the last pixel clock, for the DMA to fetch what is in the FIFO.
const LAST_CLOCKS: u64 = 100_000;

/// Pixel clocks for which FIFO and DMA are watched at most.
pub const WATCHED: u64 = 1 << 24;

/// A frame that came in, or one that was lost.
#[derive(Clone, Copy, Debug)]
pub struct Received<'a> {
    /// What is known of it.
    pub verdict: Verdict,
    /// Its bytes as DMA wrote them; `None` if it was lost.
    pub bytes: Option<&'a [u8]>,
    /// Pixel clocks played until then: its end, and what the DMA took to empty the FIFO.
    pub clock: u64,
}

/// What came of a whole trace.
#[derive(Clone, Copy, Debug)]
pub struct Summary {
    /// Pixel clocks played.
    pub clocks: u64,
    /// What became of the frames.
    pub statistics: Statistics,
    /// Words of a frame that had not ended when the trace did.
    pub unfinished_words: u32,
    /// Why there was no further frame.
    pub last: Timeout,
}

type Port<'a, 'm> = &'a RefCell<Camif<'m>>;

/// Block and driver as a sink of stretches.
pub struct Receiver<'a, 'm> {
    camif: Port<'a, 'm>,
    camera: &'a FrameCamera<'m, Port<'a, 'm>, BUFFERS>,
    on_frame: &'a mut dyn FnMut(Received<'_>),
    clocks: u64,
    lost: u32,
    activity: Option<&'a mut Activity>,
}

impl Receiver<'_, '_> {
    /// The handler of both interrupts, and then the task that takes frames.
    fn serve(&mut self) {
        self.camera.on_interrupt();
        let statistics = self.camera.statistics();
        if statistics.lost > self.lost {
            let outcome = self.camera.diagnose().evidence.last_damage.unwrap_or(Outcome::Overrun);
            for index in (0..statistics.lost - self.lost).rev() {
                let sequence = statistics.frames().wrapping_sub(1 + index);
                let overruns = u32::from(outcome == Outcome::Overrun);
                let verdict = Verdict { sequence, outcome, overruns, ..Verdict::default() };
                (self.on_frame)(Received { verdict, bytes: None, clock: self.clocks });
            }
            self.lost = statistics.lost;
        }
        while let Some(frame) = self.camera.try_frame() {
            let clock = self.clocks;
            (self.on_frame)(Received { verdict: *frame.verdict(), bytes: Some(frame.bytes()), clock });
        }
    }

    /// Pixel clocks taken so far.
    #[must_use]
    pub fn clocks(&self) -> u64 {
        self.clocks
    }
}

impl StretchSink for Receiver<'_, '_> {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        let mut played = 0;
        while played < samples.len() {
            let watching = self.activity.is_some() && self.clocks < WATCHED;
            let mut next = samples.skip(played);
            if watching {
                next = next.take(Activity::LOOK);
            }
            let mut camif = self.camif.borrow_mut();
            let requests = camif.requests();
            let ran = camif.run(sync, next);
            let interrupted = camif.interrupts().any();
            let (level, requests) = (camif.fifo_level() as u8, camif.requests() - requests);
            drop(camif);
            (played, self.clocks) = (played + ran, self.clocks + ran as u64);
            let overruns = if interrupted { self.camera.statistics().overruns } else { 0 };
            if interrupted {
                self.serve();
            }
            if let (Some(activity), true) = (&mut self.activity, watching) {
                let overruns = if interrupted { self.camera.statistics().overruns - overruns } else { 0 };
                activity.add(Bucket { clocks: ran as u64, least: level, most: level, requests, overruns });
            }
        }
        Ok(())
    }
}

/// Makes a block and a driver with these settings, lets `play` feed them, and hands each frame to `on_frame`.
///
/// Interrupts are served at the clock at which they rise.
///
/// # Errors
/// [`StartError`] if the driver refuses the configuration. What `play` returns comes back beside the summary.
pub fn receive<T>(
    config: &Config,
    bus: Bus,
    on_frame: &mut dyn FnMut(Received<'_>),
    play: impl FnOnce(&mut Receiver<'_, '_>) -> T,
) -> Result<(T, Summary), StartError> {
    receive_on(Part::CAMIF, config, bus, None, on_frame, play)
}

/// The same with the block as `part` has it; FIFO and DMA are written down in `activity` for the first [`WATCHED`] clocks, which
/// takes longer.
///
/// # Errors
/// As [`receive`].
pub fn receive_on<T>(
    part: Part,
    config: &Config,
    bus: Bus,
    activity: Option<&mut Activity>,
    on_frame: &mut dyn FnMut(Received<'_>),
    play: impl FnOnce(&mut Receiver<'_, '_>) -> T,
) -> Result<(T, Summary), StartError> {
    let words = frame_plan(config, part.transfer_limit).unwrap_or_default().room();
    let mut memory: [Vec<u32>; BUFFERS] = std::array::from_fn(|_| vec![0; words as usize]);
    let camif = RefCell::new(Camif::new(part, bus));
    let camera = FrameCamera::new(&camif, memory.each_mut().map(Vec::as_mut_slice))?;
    camera.start(config)?;
    let mut receiver = Receiver { camif: &camif, camera: &camera, on_frame, clocks: 0, lost: 0, activity };
    let result = play(&mut receiver);
    camif.borrow_mut().elapse(LAST_CLOCKS);
    receiver.serve();
    let clocks = receiver.clocks;
    let last = camera.diagnose();
    let unfinished_words = match last.cause {
        Cause::Unfinished { words, .. } => words,
        _ => 0,
    };
    Ok((result, Summary { clocks, statistics: camera.statistics(), unfinished_words, last }))
}
