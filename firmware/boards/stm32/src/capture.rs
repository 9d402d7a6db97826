//! What a board does while its sensor sends: frames out, commands in, until the sensor is to be programmed anew.

use algos_nostd::pixel::rgb888;
use algos_nostd::quantize::Probe;
use embedded_io::Write;
use firmware::driver::deadline::Timeout;
use firmware::driver::verdict::{Statistics, Verdict};
use firmware::driver::{Config, Frame, FrameCamera, StartError};
use firmware::link::packet::{FrameStart, State, cause_code};
use firmware::link::{Choice, Outgoing, Sender, small_table};
use firmware::pipeline::{Pipeline, Product};
use firmware::port::{Port, Registers};
use firmware::sensor::Mode;

use crate::device::{BoardDevice, RAW, SensorRegisters, VISION};
use crate::stages::COLORS;
use crate::station::{Sent, Station, start};

/// Why capture ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// Another mode was chosen.
    Mode,
    /// No frame came in time.
    Timeout(Timeout),
    /// The driver does not start.
    Refused(StartError),
}

/// Time, in microseconds since the start.
pub trait Time {
    /// Now.
    fn now(&mut self) -> u64;
    /// Sleeps until something happens, a millisecond at most; returns the time then.
    fn sleep(&mut self) -> u64;
}

/// What a board has besides its camera.
#[derive(Debug)]
pub struct Bench<'b, 'm, W, R, Q, X> {
    /// Its end of the line.
    pub station: &'b mut Station<'m, W, R>,
    /// What the host wants of it.
    pub device: &'b mut BoardDevice<Q, X>,
    /// Number on the link of the first frame since capture was started last.
    base: u32,
}

impl<'b, 'm, W, R, Q, X> Bench<'b, 'm, W, R, Q, X>
where
    W: Write,
    R: FnMut(&mut [u8]) -> usize,
    Q: Registers,
    X: SensorRegisters,
{
    /// Nothing captured yet.
    pub fn new(station: &'b mut Station<'m, W, R>, device: &'b mut BoardDevice<Q, X>) -> Self {
        Self { station, device, base: 0 }
    }

    /// Captures frames of this mode and sends them. `memory` is of [`Stages::memory`](crate::stages::Stages::memory) words for its size.
    ///
    /// What the line does not take is lost: a device waits for nobody.
    pub fn capture<'c, P: Port<'c>, const N: usize>(
        &mut self,
        camera: &FrameCamera<'c, P, N>,
        (mode, config): (&Mode, &Config),
        memory: &mut [u32],
        time: &mut impl Time,
    ) -> Ended {
        let (chosen, mut earlier) = (self.device.mode, self.device.statistics);
        let mut held: Option<Frame<'_, 'c, P, N>> = None;
        let mut running = false;
        // Since when a frame is waited for.
        let mut waiting = None;
        loop {
            let stages = self.device.stages;
            let mut probes = [Probe::EMPTY; COLORS.len()];
            let mut pipeline = Pipeline::new(stages.settings(mode, &mut probes), memory).ok();
            while self.device.stages == stages {
                let now = time.sleep();
                if running {
                    self.device.statistics = sum(earlier, camera.statistics());
                }
                let _ = self.station.listen(self.device, now);
                if self.device.mode != chosen {
                    camera.stop();
                    return Ended::Mode;
                }
                let changed = core::mem::take(&mut self.device.changed);
                let _ = self.station.streams(self.device, changed);
                if let Some(frame) = &held {
                    let _ = self.resend(mode, frame.bytes());
                }
                if (self.device.state == State::Stopped) == running {
                    if running {
                        camera.stop();
                        earlier = self.device.statistics;
                    } else if let Err(refusal) = camera.start(config) {
                        return Ended::Refused(refusal);
                    }
                    (running, waiting, self.base) = (!running, None, self.station.next);
                }
                if !running {
                    continue;
                }
                let since = *waiting.get_or_insert_with(|| {
                    if N == 1 {
                        // The only buffer is needed.
                        (held, self.device.held) = (None, None);
                    }
                    camera.trigger();
                    now
                });
                if let Some(frame) = camera.try_frame() {
                    waiting = None;
                    let frame = held.insert(frame);
                    let verdict = *frame.verdict();
                    let sequence = self.base.wrapping_add(verdict.sequence);
                    self.station.next = sequence.wrapping_add(1);
                    self.device.held = Some((sequence, mode.height as u16));
                    let _ = self.send(mode, frame.bytes(), &verdict, (sequence, now), &mut pipeline, time);
                    self.count();
                } else if now.saturating_sub(since) > self.device.deadline_ms as u64 * 1_000 {
                    let timeout = camera.diagnose();
                    self.device.cause = cause_code(Some(timeout.cause));
                    self.device.statistics = sum(earlier, camera.statistics());
                    camera.stop();
                    return Ended::Timeout(timeout);
                }
            }
        }
    }

    /// A frame has been sent: a snapshot may be complete.
    fn count(&mut self) {
        let device = &mut *self.device;
        if device.state == State::Snapshot {
            device.left = device.left.saturating_sub(1);
            if device.left == 0 {
                device.state = State::Stopped;
            }
        }
    }

    /// Sends a frame on the streams that are on, and answers commands between its lines.
    fn send(
        &mut self,
        mode: &Mode,
        bytes: &[u8],
        verdict: &Verdict,
        (sequence, captured): (u32, u64),
        pipeline: &mut Option<Pipeline<'_>>,
        time: &mut impl Time,
    ) -> Sent<W> {
        let on = self.device.on;
        let snapshot = self.device.state == State::Snapshot;
        let begin = |device: &BoardDevice<Q, X>, stream| FrameStart {
            sequence,
            captured,
            snapshot,
            ..start(device, mode, stream)
        };
        let lines = || bytes.chunks_exact(line_bytes(mode)).take(mode.height as usize);
        if on >> RAW & 1 != 0 {
            let start = begin(self.device, RAW);
            let mut outgoing = self.station.sender.begin(start, self.choice(RAW))?;
            for (number, line) in (0..).zip(lines()) {
                self.station.sender.line(&mut outgoing, number, line)?;
                self.station.listen(self.device, time.now())?;
            }
            self.station.sender.end(outgoing.end().judged(verdict))?;
        }
        if on >> VISION & 1 != 0
            && let Some(pipeline) = pipeline
        {
            // What is chosen meanwhile is for the next frame.
            let start = begin(self.device, VISION);
            let mut outgoing = self.station.sender.begin(start, self.choice(VISION))?;
            let mut number = 0;
            for line in lines() {
                let mut sent = Ok(());
                let mut sink = |product: Product<'_>| {
                    let line = put(&mut self.station.sender, &mut outgoing, number, product, mode);
                    (sent, number) = (core::mem::replace(&mut sent, Ok(())).and(line), number + 1);
                };
                // The mode's lines are what the pipeline was made for.
                let _ = pipeline.push(line, &mut sink);
                sent?;
                self.station.listen(self.device, time.now())?;
            }
            let mut sent = Ok(());
            pipeline.finish(&mut |product| {
                let line = put(&mut self.station.sender, &mut outgoing, number, product, mode);
                (sent, number) = (core::mem::replace(&mut sent, Ok(())).and(line), number + 1);
            });
            sent?;
            self.station.sender.end(outgoing.end().judged(verdict))?;
        }
        Ok(())
    }

    /// Sends lines of the frame that is held once more, if they were asked for.
    fn resend(&mut self, mode: &Mode, bytes: &[u8]) -> Sent<W> {
        let Some(again) = self.device.again.take() else { return Ok(()) };
        let start = FrameStart { sequence: again.sequence, ..start(self.device, mode, RAW) };
        let outgoing = Outgoing::new(start, self.choice(RAW), small_table);
        let lines = (0..).zip(bytes.chunks_exact(line_bytes(mode)));
        for (number, line) in lines.skip(again.first.into()).take(again.count.into()) {
            self.station.sender.resend(&outgoing, number, line)?;
        }
        Ok(())
    }

    fn choice(&self, stream: u8) -> Choice {
        self.device.choices.get(usize::from(stream)).copied().unwrap_or_default()
    }
}

fn line_bytes(mode: &Mode) -> usize {
    mode.format.line_bytes(mode.width as usize).max(1)
}

/// Sends a line that the pipeline made.
fn put<W: Write>(
    sender: &mut Sender<'_, W>,
    outgoing: &mut Outgoing,
    number: u16,
    product: Product<'_>,
    mode: &Mode,
) -> Sent<W> {
    let width = mode.width as usize;
    match product {
        Product::Color(line) => sender.line(outgoing, number, rgb888::as_bytes(line)),
        Product::Gray(line) | Product::Indices(line) => sender.line(outgoing, number, line),
        Product::Edges(line) => {
            // Both have the first pixel lowest.
            let bytes = line.iter().flat_map(|word| word.to_le_bytes());
            let mut packed = [0; 128];
            for (to, from) in packed.iter_mut().zip(bytes) {
                *to = from;
            }
            let packed = packed.get(..width.div_ceil(8)).unwrap_or_default();
            sender.bits_line(outgoing, number, packed, width)
        }
    }
}

fn sum(one: Statistics, other: Statistics) -> Statistics {
    Statistics {
        delivered: one.delivered.wrapping_add(other.delivered),
        dropped: one.dropped.wrapping_add(other.dropped),
        lost: one.lost.wrapping_add(other.lost),
        skipped: one.skipped.wrapping_add(other.skipped),
        overruns: one.overruns.wrapping_add(other.overruns),
        sync_errors: one.sync_errors.wrapping_add(other.sync_errors),
        dma_errors: one.dma_errors.wrapping_add(other.dma_errors),
        lines_dropped: one.lines_dropped.wrapping_add(other.lines_dropped),
    }
}
