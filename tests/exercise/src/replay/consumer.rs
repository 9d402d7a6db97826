//! What the main loop does with lines and frames, and what it tells of them.

use algos_nostd::pixel::rgb888;
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use firmware::driver::deadline::{Cause, Timeout};
use firmware::driver::verdict::{Outcome, Statistics};
use firmware::driver::{FrameCamera, LineCamera, LineEvent};
use firmware::pipeline::{Pipeline, Product};
use firmware::port::Port;

static CRC32: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A time at which every wait ends: the trace does.
pub const END: u64 = u64::MAX;

/// What is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// A frame came: its number, what came of it, CRC-32 of its bytes or of what the pipeline made of it.
    Frame(u32, &'static str, u32),
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

/// Takes frames until the trace ends. `idle` sleeps until the next tick, and returns its number, or [`END`].
pub fn frames<'m, P: Port<'m>, const N: usize>(
    camera: &FrameCamera<'m, P, N>,
    (patience, hoard): (u64, bool),
    mut idle: impl FnMut() -> u64,
    tell: &mut dyn FnMut(Told),
) {
    let mut now = 0;
    // Frames that are never given back.
    let mut kept = [const { None }; N];
    let mut held = 0;
    loop {
        let deadline = now + patience;
        let result = camera.wait_frame(deadline, || {
            now = idle();
            now
        });
        match result {
            Ok(frame) => {
                let verdict = frame.verdict();
                tell(Told::Frame(verdict.sequence, outcome(verdict.outcome), CRC32.checksum(frame.bytes())));
                if hoard && let Some(place) = kept.get_mut(held) {
                    *place = Some(frame);
                    held += 1;
                }
            }
            Err(timeout) => tell(Told::Timeout(cause(&timeout))),
        }
        if now == END {
            break;
        }
    }
    tell(Told::total(&camera.statistics()));
}

/// Takes lines through a pipeline until the trace ends.
pub fn lines<'m, P: Port<'m>, const N: usize>(
    camera: &LineCamera<'m, P, N>,
    patience: u64,
    pipeline: &mut Pipeline<'_>,
    mut idle: impl FnMut() -> u64,
    tell: &mut dyn FnMut(Told),
) {
    let (mut now, mut sum) = (0, 0);
    loop {
        let deadline = now + patience;
        let result = camera.wait_line(deadline, || {
            now = idle();
            now
        });
        match result {
            Ok(LineEvent::Line(line)) => {
                if pipeline.push(line.bytes(), &mut |product| sum = checksum(sum, product)).is_err() {
                    tell(Told::Refused);
                }
            }
            Ok(LineEvent::FrameEnd(verdict)) => {
                pipeline.finish(&mut |product| sum = checksum(sum, product));
                tell(Told::Frame(verdict.sequence, outcome(verdict.outcome), sum));
                sum = 0;
            }
            Err(timeout) => tell(Told::Timeout(cause(&timeout))),
        }
        if now == END {
            break;
        }
    }
    tell(Told::total(&camera.statistics()));
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
