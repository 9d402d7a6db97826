//! What the main loop does with lines and frames, and what it tells of them.

use algos_nostd::pixel::rgb888;
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use firmware::driver::config::Policy;
use firmware::driver::deadline::{Cause, Timeout};
use firmware::driver::verdict::{Outcome, Statistics};
use firmware::driver::{FrameCamera, LineCamera, LineEvent};
use firmware::pipeline::{Pipeline, Product};
use firmware::port::Port;

use super::scenario::{Scenario, Trouble};

static CRC32: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A time at which every wait ends: the trace does.
pub const END: u64 = u64::MAX;

/// What is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// A frame came: its number, what came of it, CRC-32 of its bytes or of what the pipeline made of it.
    Frame(u32, &'static str, u32),
    /// A frame was lost for this; it is never handed out.
    Lost(&'static str),
    /// None came in time.
    Timeout(&'static str),
    /// A line was not as long as the pipeline was told.
    Refused,
    /// All that happened: frames delivered, dropped, lost and skipped, and overruns.
    Total([u32; 5]),
}

impl Told {
    fn total(statistics: &Statistics) -> Self {
        let Statistics { delivered, dropped, lost, skipped, overruns, .. } = *statistics;
        Self::Total([delivered, dropped, lost, skipped, overruns])
    }
}

/// In a word or two.
#[must_use]
pub const fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Good => "good",
        Outcome::Short { .. } => "short",
        Outcome::Long { .. } => "long",
        Outcome::LineCount { .. } => "wrong number of lines",
        Outcome::LineLength { .. } => "uneven lines",
        Outcome::LinesDropped { .. } => "lines dropped",
        Outcome::Overrun => "overrun",
        Outcome::SyncError => "sync error",
        Outcome::DmaError => "DMA error",
        Outcome::DmaStalled => "DMA stalled",
        Outcome::LateInterrupt => "late interrupt",
    }
}

/// In a word or two.
#[must_use]
pub const fn cause(timeout: &Timeout) -> &'static str {
    match timeout.cause {
        Cause::NoClock => "no clock",
        Cause::NoVsync => "no VSYNC",
        Cause::NoData => "no data",
        Cause::ShortFrame { .. } => "short frames",
        Cause::DmaStalled => "DMA stalled",
        Cause::Overrun { .. } => "overrun",
        Cause::Damaged(damage) => outcome(damage),
        Cause::Unfinished { .. } => "unfinished",
        Cause::NoBuffer => "no buffer",
        Cause::Stopped => "stopped",
        _ => "refused",
    }
}

/// Takes frames until the trace ends. `idle` sleeps until the next tick, and returns its number, from 1, or [`END`].
pub fn frames<'m, P: Port<'m>, const N: usize>(
    camera: &FrameCamera<'m, P, N>,
    scenario: &Scenario,
    mut idle: impl FnMut() -> u64,
    tell: &mut impl FnMut(Told),
) {
    let (mut now, mut lost) = (0, 0);
    let mut kept = [const { None }; N];
    let mut held = 0;
    loop {
        if scenario.policy == Policy::Snapshot {
            camera.trigger();
        }
        let result = camera.wait_frame(now + scenario.patience, || {
            now = sleep(scenario, Trouble::Masked, now, &mut idle);
            // A frame that is lost is told of as it happens: nobody is handed it.
            if core::mem::replace(&mut lost, camera.statistics().lost) != camera.statistics().lost
                && let Some(damage) = camera.diagnose().evidence.last_damage
            {
                tell(Told::Lost(outcome(damage)));
            }
            now
        });
        match result {
            Ok(frame) => {
                let verdict = frame.verdict();
                tell(Told::Frame(verdict.sequence, outcome(verdict.outcome), CRC32.checksum(frame.bytes())));
                if scenario.hoard
                    && let Some(place) = kept.get_mut(held)
                {
                    *place = Some(frame);
                    held += 1;
                } else {
                    now = doze(scenario, now, &mut idle);
                }
            }
            Err(timeout) if now != END => {
                tell(Told::Timeout(cause(&timeout)));
                // Whoever kept frames gives them back, and starts to keep again no more.
                kept = [const { None }; N];
            }
            Err(_) => {}
        }
        if now == END {
            break;
        }
    }
    tell(Told::total(&camera.statistics()));
}

/// What is done with lines.
#[derive(Debug)]
pub enum Work<'w, 'm> {
    /// Their bytes are told by a checksum.
    Nothing,
    /// They go through a pipeline, and what comes out is told.
    Pipeline(&'w mut Pipeline<'m>),
}

/// Takes lines until the trace ends.
pub fn lines<'m, P: Port<'m>, const N: usize>(
    camera: &LineCamera<'m, P, N>,
    scenario: &Scenario,
    mut work: Work<'_, '_>,
    mut idle: impl FnMut() -> u64,
    tell: &mut impl FnMut(Told),
) {
    let (mut now, mut sum) = (0, 0);
    loop {
        let result = camera.wait_line(now + scenario.patience, || {
            now = sleep(scenario, Trouble::Masked, now, &mut idle);
            now
        });
        match result {
            Ok(LineEvent::Line(line)) => {
                match &mut work {
                    Work::Nothing => sum = checksum(sum, Product::Gray(line.bytes())),
                    Work::Pipeline(pipeline) => {
                        if pipeline.push(line.bytes(), &mut |product| sum = checksum(sum, product)).is_err() {
                            tell(Told::Refused);
                        }
                    }
                }
                now = doze(scenario, now, &mut idle);
            }
            Ok(LineEvent::FrameEnd(verdict)) => {
                if let Work::Pipeline(pipeline) = &mut work {
                    pipeline.finish(&mut |product| sum = checksum(sum, product));
                }
                tell(Told::Frame(verdict.sequence, outcome(verdict.outcome), sum));
                sum = 0;
            }
            Err(timeout) if now != END => tell(Told::Timeout(cause(&timeout))),
            Err(_) => {}
        }
        if now == END {
            break;
        }
    }
    tell(Told::total(&camera.statistics()));
}

/// Sleeps for a tick, and on while the ticks are of this trouble.
fn sleep(scenario: &Scenario, trouble: Trouble, mut now: u64, idle: &mut impl FnMut() -> u64) -> u64 {
    let disturbance = scenario.disturbance.filter(|disturbance| disturbance.what == trouble);
    loop {
        let before = now;
        now = idle();
        if !disturbance.is_some_and(|disturbance| disturbance.covers(before)) {
            return now;
        }
    }
}

/// Sleeps through a nap, if it is time for one.
fn doze(scenario: &Scenario, now: u64, idle: &mut impl FnMut() -> u64) -> u64 {
    let nap = scenario.disturbance.filter(|disturbance| disturbance.what == Trouble::Nap);
    if nap.is_some_and(|nap| nap.covers(now)) { sleep(scenario, Trouble::Nap, now, idle) } else { now }
}

/// The checksum of what came before and this.
fn checksum(before: u32, product: Product<'_>) -> u32 {
    let mut digest = CRC32.digest_with_initial(before.reverse_bits() ^ u32::MAX);
    match product {
        Product::Color(line) => digest.update(rgb888::as_bytes(line)),
        Product::Gray(line) | Product::Indices(line) => digest.update(line),
        Product::Edges(line) => line.iter().for_each(|word| digest.update(&word.to_le_bytes())),
    }
    digest.finalize()
}
