//! The loop that takes frames from a device and hands them on, and never lets the device wait.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::time::{Duration, Instant};

use super::convert::{Converter, FrameFault};
use super::cpu::ThreadTime;
use super::device::{CaptureDevice, Captured};
use super::statistics::Statistics;
use super::{CaptureError, Output};

/// Buffers that are the device's whatever happens: one that it fills, and one that it goes on with.
const RESERVE: usize = 2;

/// Frames between the device and what is done with them; how many there can be is said by the device's buffers.
const QUEUE: usize = 64;

/// How often a wait looks whether it is to end.
const SLICE: Duration = Duration::from_millis(100);

/// When a capture ends.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Frames to be used; without a number there is no end.
    pub frames: Option<u64>,
    /// The longest time without a frame, and without a whole one.
    pub timeout: Duration,
}

/// What came of a capture.
#[derive(Debug)]
pub struct Session {
    /// The frames.
    pub statistics: Statistics,
    /// From the start to the last frame.
    pub took: Duration,
    /// From the first frame to the last.
    pub between: Duration,
    /// Processor time of taking frames and of what is done with them; nothing where the system does not tell.
    pub processor: Option<Duration>,
    /// Why it ended before its time. What was taken by then is in the output.
    pub error: Option<CaptureError>,
}

/// What the worker did.
#[derive(Debug, Default)]
struct Worked {
    broken: u64,
    copied: u64,
    converted: u64,
    processor: Option<Duration>,
    error: Option<CaptureError>,
}

/// Takes frames until there are enough, `stop` is set or the device fails, and hands good ones to the output, which
/// works in a thread of its own on the memory of the device.
///
/// The device never waits for the output: it keeps two buffers, and a frame for which there is no other is
/// given back at once and counted as dropped. Damaged and short frames are counted and not handed on.
/// `watch` is told the count after each frame.
pub fn capture(
    device: &mut dyn CaptureDevice,
    limits: Limits,
    output: Option<&mut Output<'_>>,
    stop: &AtomicBool,
    watch: &mut dyn FnMut(&Statistics),
) -> Session {
    let (sender, receiver) = sync_channel(QUEUE);
    let failed = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let failed = &failed;
        let worker = output.map(|output| scope.spawn(move || work(output, &receiver, failed)));
        let sender = worker.is_some().then_some(sender);
        let ends = || stop.load(Ordering::Relaxed) || failed.load(Ordering::Relaxed);
        let time = ThreadTime::start();
        let mut session = take(device, limits, sender.as_ref(), &ends, watch);
        // The worker ends when there is nobody to send it a frame.
        drop(sender);
        let spent = time.spent();
        let worked =
            worker.map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        let worked =
            worked.unwrap_or_else(|| Worked { processor: Some(Duration::ZERO), ..Worked::default() });
        session.processor = spent.zip(worked.processor).map(|(a, b)| a + b);
        let statistics = &mut session.statistics;
        (statistics.broken, statistics.good) = (worked.broken, statistics.good - worked.broken);
        (statistics.copied_bytes, statistics.converted_bytes) = (worked.copied, worked.converted);
        // What the output says is why the loop ended.
        session.error = worked.error.or(session.error);
        session
    })
}

fn take(
    device: &mut dyn CaptureDevice,
    limits: Limits,
    sender: Option<&SyncSender<Box<dyn Captured>>>,
    ends: &dyn Fn() -> bool,
    watch: &mut dyn FnMut(&Statistics),
) -> Session {
    let converter = Converter::new(&device.opened().format);
    let mut statistics = Statistics::default();
    let started = Instant::now();
    let (mut first, mut last, mut whole) = (None, started, started);
    let (mut used, mut between) = (0, Duration::ZERO);
    let mut error = None;
    while !ends() && limits.frames.is_none_or(|frames| used < frames) {
        let waited = last.elapsed();
        if waited >= limits.timeout {
            error = Some(CaptureError::Timeout {
                device: device.opened().name.clone(),
                waited,
                frames: statistics.taken,
            });
            break;
        }
        let waited_for_whole = whole.elapsed();
        if waited_for_whole >= limits.timeout && last > whole {
            error = Some(CaptureError::NoneWhole {
                device: device.opened().name.clone(),
                waited: waited_for_whole,
                frames: statistics.taken,
                damaged: statistics.damaged,
                short: statistics.short,
            });
            break;
        }
        let frame = match device.next(SLICE.min(limits.timeout - waited)) {
            Ok(Some(frame)) => frame,
            Ok(None) => continue,
            Err(failed) => {
                error = Some(failed.after(statistics.taken));
                break;
            }
        };
        last = Instant::now();
        between = last - *first.get_or_insert(last);
        let planes = frame.planes();
        statistics.saw(frame.sequence(), planes.iter().map(|plane| plane.len()).sum());
        if frame.is_damaged() {
            statistics.damaged += 1;
        } else if let Err(FrameFault::Short { .. }) = converter.check(&planes) {
            statistics.short += 1;
        } else {
            statistics.good += 1;
            whole = last;
            drop(planes);
            if hand_on(frame, sender, device.buffers()) {
                used += 1;
            } else {
                statistics.dropped += 1;
            }
        }
        watch(&statistics);
    }
    Session { statistics, took: last - started, between, processor: None, error }
}

/// Whether a frame found its place.
fn hand_on(frame: Box<dyn Captured>, sender: Option<&SyncSender<Box<dyn Captured>>>, buffers: usize) -> bool {
    let Some(sender) = sender else { return true };
    buffers >= RESERVE
        && match sender.try_send(frame) {
            // One that has gone has failed, which the loop sees.
            Ok(()) | Err(TrySendError::Disconnected(_)) => true,
            Err(TrySendError::Full(_)) => false,
        }
}

fn work(output: &mut Output<'_>, receiver: &Receiver<Box<dyn Captured>>, failed: &AtomicBool) -> Worked {
    let time = ThreadTime::start();
    let mut worked = Worked::default();
    for frame in receiver {
        match output.take(&frame.planes(), frame.sequence()) {
            Ok(Ok(())) => {}
            Ok(Err(_)) => worked.broken += 1,
            Err(error) => {
                worked.error = Some(error);
                failed.store(true, Ordering::Relaxed);
                break;
            }
        }
    }
    (worked.copied, worked.converted) = (output.copied_bytes(), output.converted_bytes());
    worked.processor = time.spent();
    worked
}

#[cfg(test)]
#[path = "session_tests.rs"]
mod tests;
