use std::convert::Infallible;
use std::time::{Duration, Instant};

use super::noise::{Damage, Noise, Rates};
use super::pace::Pace;
use super::transport::{Change, Transport};

/// Bytes that may wait where nothing limits the rate.
const QUEUE: usize = 256 * 1024;
/// Bytes that may wait at least: two packets.
const QUEUE_MIN: usize = 8 * 1024;
/// Seconds' worth of bytes that may wait on a line of a given rate: replies come behind them.
const QUEUE_SECONDS: f64 = 0.02;
/// Between two looks at a line that is waited for because of its rate.
const TICK: Duration = Duration::from_millis(2);

/// The serial line of the device: a queue, the rate at which it empties, and noise both ways.
pub(super) struct Line {
    transport: Box<dyn Transport>,
    is_open: bool,
    to_host: Noise,
    from_host: Noise,
    pace: Pace,
    /// What waits to leave, from `start` on.
    queue: Vec<u8>,
    start: usize,
    room: usize,
    read: Vec<u8>,
    /// Bytes that left.
    pub(super) sent: u64,
}

impl Line {
    pub(super) fn new(transport: Box<dyn Transport>, baud: Option<u32>, noise: Rates, seed: u64) -> Self {
        let pace = Pace::new(baud);
        let room =
            pace.bytes_per_second().map_or(QUEUE, |rate| ((rate * QUEUE_SECONDS) as usize).max(QUEUE_MIN));
        Self {
            transport,
            is_open: false,
            to_host: Noise::new(noise, seed),
            from_host: Noise::new(noise, !seed),
            pace,
            queue: Vec::new(),
            start: 0,
            room,
            read: vec![0; 64 * 1024],
            sent: 0,
        }
    }

    /// A host is there.
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// There is room for another packet.
    pub(super) fn has_room(&self) -> bool {
        self.waiting() < self.room
    }

    /// All that was sent has left.
    pub(super) fn is_idle(&self) -> bool {
        self.waiting() == 0
    }

    fn waiting(&self) -> usize {
        self.queue.len() - self.start
    }

    /// What the noise did to the bytes to the host.
    pub(super) fn damage(&self) -> Damage {
        self.to_host.damage()
    }

    /// Other noise from now on, with counts from 0.
    pub(super) fn set_noise(&mut self, noise: Rates, seed: u64) {
        (self.to_host, self.from_host) = (Noise::new(noise, seed), Noise::new(noise, !seed));
    }

    /// Moves what can be moved, and appends what came in to `received`. Does not wait.
    pub(super) fn attend(&mut self, received: &mut Vec<u8>) -> Option<Change> {
        let change = self.transport.attend();
        if let Some(change) = change {
            self.is_open = change == Change::Came;
            self.queue.clear();
            self.start = 0;
        }
        loop {
            let count = self.transport.read(&mut self.read);
            self.from_host.pass(self.read.get(..count).unwrap_or_default(), received);
            if count < self.read.len() {
                break;
            }
        }
        let allowed = self.pace.allow(Instant::now(), self.waiting());
        let ready = self.queue.get(self.start..self.start + allowed).unwrap_or_default();
        let count = self.transport.write(ready);
        self.pace.spend(count);
        self.start += count;
        self.sent += count as u64;
        if self.start == self.queue.len() || self.start > self.room {
            self.queue.drain(..self.start);
            self.start = 0;
        }
        change
    }

    /// Waits until something can be moved.
    pub(super) fn wait(&self, longest: Duration) {
        let waits = !self.is_idle();
        let paced = self.pace.bytes_per_second().is_some();
        let longest = if waits && paced { longest.min(TICK) } else { longest };
        self.transport.wait(longest, waits && !paced);
    }

    pub(super) fn url(&self) -> String {
        self.transport.url()
    }
}

impl embedded_io::ErrorType for Line {
    type Error = Infallible;
}

impl embedded_io::Write for Line {
    /// Puts bytes into the queue, noise included; without a host they are gone.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        if self.is_open {
            self.to_host.pass(bytes, &mut self.queue);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
