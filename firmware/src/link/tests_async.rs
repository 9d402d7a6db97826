//! The async halves of sender and receiver, over a line that takes and gives a few bytes at a time and often nothing.

use std::vec;
use std::vec::Vec;

use embassy_futures::block_on;
use embassy_futures::yield_now;

use super::packet::{FrameStart, Level, Log, Meaning};
use super::*;

const WIDTH: u16 = 24;

/// A line that is seldom ready. It breaks after `limit` bytes.
struct Slow {
    bytes: Vec<u8>,
    at: usize,
    turn: usize,
    limit: usize,
}

impl Slow {
    fn new(bytes: Vec<u8>) -> Self {
        Self { bytes, at: 0, turn: 0, limit: usize::MAX }
    }

    /// Waits a while, and says how many bytes pass now: 1 to 7.
    async fn pass(&mut self) -> usize {
        self.turn += 1;
        for _ in 0..self.turn % 3 {
            yield_now().await;
        }
        1 + self.turn % 7
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Broken;

impl core::fmt::Display for Broken {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the line is broken")
    }
}

impl core::error::Error for Broken {}

impl embedded_io::Error for Broken {
    fn kind(&self) -> embedded_io::ErrorKind {
        embedded_io::ErrorKind::BrokenPipe
    }
}

impl embedded_io::ErrorType for Slow {
    type Error = Broken;
}

impl embedded_io_async::Write for Slow {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Broken> {
        let count = self.pass().await.min(bytes.len());
        if self.bytes.len() + count > self.limit {
            return Err(Broken);
        }
        self.bytes.extend_from_slice(&bytes[..count]);
        Ok(count)
    }

    async fn flush(&mut self) -> Result<(), Broken> {
        Ok(())
    }
}

impl embedded_io_async::Read for Slow {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Broken> {
        let rest = self.bytes.len() - self.at;
        let count = self.pass().await.min(bytes.len()).min(rest);
        if self.at + count > self.limit {
            return Err(Broken);
        }
        bytes[..count].copy_from_slice(&self.bytes[self.at..][..count]);
        self.at += count;
        Ok(count)
    }
}

fn start(format: Format) -> FrameStart {
    FrameStart {
        stream: 0,
        format,
        meaning: Meaning::default(),
        snapshot: false,
        sequence: 7,
        width: WIDTH,
        height: 2,
        captured: 9,
        palette: 0,
    }
}

fn log() -> Packet<'static> {
    Packet::Log(Log { level: Level::Debug, cut: false, lost: 0, time: 1, text: "0 ✓" })
}

fn color_line() -> Vec<u8> {
    (0..3 * WIDTH).map(|at| (at * 11) as u8).collect()
}

const MAP: [u8; 3] = [0xA5, 0, 0xFF];

/// Bodies so small that a line goes in pieces, and large ones.
const BODIES: [usize; 2] = [62, BODY_MAX];

/// Every kind of call, blocking.
fn blocking(body: usize) -> (Vec<u8>, u32, u32) {
    let (mut memory, mut wire) = (vec![0; wire_bytes(body)], Vec::new());
    let mut sender = Sender::new(&mut wire, &mut memory, small_table);
    sender.send(&log()).unwrap();
    for choice in [Choice::One(Encoding::Raw), Choice::Sender] {
        let mut frame = sender.begin(start(Format::RGB888), choice).unwrap();
        sender.line(&mut frame, 0, &color_line()).unwrap();
        sender.line(&mut frame, 1, &[5; 3 * WIDTH as usize]).unwrap();
        sender.resend(&frame, 0, &color_line()).unwrap();
        sender.end(frame.end()).unwrap();
    }
    let mut frame = sender.begin(start(Format::GRAY8), Choice::Sender).unwrap();
    sender.bits_line(&mut frame, 1, &MAP, WIDTH.into()).unwrap();
    sender.end(frame.end()).unwrap();
    let counts = (sender.packets(), sender.bytes());
    (wire, counts.0, counts.1)
}

/// The same, async.
async fn asynchronous(body: usize) -> (Vec<u8>, u32, u32) {
    let (mut memory, mut line) = (vec![0; wire_bytes(body)], Slow::new(Vec::new()));
    let mut sender = Sender::new(&mut line, &mut memory, small_table);
    sender.send_async(&log()).await.unwrap();
    for choice in [Choice::One(Encoding::Raw), Choice::Sender] {
        let mut frame = sender.begin_async(start(Format::RGB888), choice).await.unwrap();
        sender.line_async(&mut frame, 0, &color_line()).await.unwrap();
        sender.line_async(&mut frame, 1, &[5; 3 * WIDTH as usize]).await.unwrap();
        sender.resend_async(&frame, 0, &color_line()).await.unwrap();
        sender.end_async(frame.end()).await.unwrap();
    }
    let mut frame = sender.begin_async(start(Format::GRAY8), Choice::Sender).await.unwrap();
    sender.bits_line_async(&mut frame, 1, &MAP, WIDTH.into()).await.unwrap();
    sender.end_async(frame.end()).await.unwrap();
    let counts = (sender.packets(), sender.bytes());
    (line.bytes, counts.0, counts.1)
}

#[test]
fn an_async_sender_sends_what_a_blocking_one_does() {
    for body in BODIES {
        let (wire, packets, bytes) = blocking(body);
        assert_eq!(block_on(asynchronous(body)), (wire.clone(), packets, bytes));
        assert_eq!(wire.len(), bytes as usize);
    }
}

#[test]
fn an_async_receiver_receives_what_a_blocking_one_does() {
    let (mut wire, _, _) = blocking(62);
    // Some of it damaged.
    let middle = wire.len() / 2;
    wire[middle] ^= 0x10;
    wire.extend_from_slice(b"no packet\0");
    for chunk in [1, 5, 4096] {
        let (mut body, mut room) = (vec![0; BODY_MAX], vec![0; chunk]);
        let mut expected = Vec::new();
        let mut receiver = Receiver::new(wire.as_slice(), &mut body, &mut room, small_table);
        while let Some(received) = receiver.receive().unwrap() {
            expected.push(std::format!("{received:?}"));
        }
        let counts = receiver.counts();
        assert_eq!(counts.damaged, 2);

        let (mut body, mut room) = (vec![0; BODY_MAX], vec![0; chunk]);
        let mut receiver = Receiver::new(Slow::new(wire.clone()), &mut body, &mut room, small_table);
        let mut got = Vec::new();
        block_on(async {
            while let Some(received) = receiver.receive_async().await.unwrap() {
                got.push(std::format!("{received:?}"));
            }
        });
        assert_eq!((got, receiver.counts()), (expected, counts));
    }
}

#[test]
fn a_broken_line_is_told_and_what_is_too_long_is_not_begun() {
    let mut memory = vec![0; wire_bytes(62)];
    let mut line = Slow::new(Vec::new());
    line.limit = 40;
    let mut sender = Sender::new(&mut line, &mut memory, small_table);
    let long = Packet::Palette(packet::Palette { stream: 0, colors: &[[1; 3]; 40] });
    assert_eq!(block_on(sender.send_async(&long)), Err(SendError::TooLong));
    assert_eq!((sender.packets(), sender.bytes()), (0, 0));
    let broken = block_on(async {
        sender.send_async(&log()).await?;
        let mut frame = sender.begin_async(start(Format::RGB888), Choice::Sender).await?;
        sender.line_async(&mut frame, 0, &color_line()).await
    });
    assert_eq!(broken, Err(SendError::Write(Broken)));

    // A reader that fails keeps what it had begun.
    let (wire, _, _) = blocking(BODY_MAX);
    let (mut body, mut room) = (vec![0; BODY_MAX], vec![0; 8]);
    let mut line = Slow::new(wire.clone());
    line.limit = 10;
    let mut receiver = Receiver::new(line, &mut body, &mut room, small_table);
    assert_eq!(block_on(receiver.receive_async()), Err(Broken));
    receiver.reader_mut().limit = usize::MAX;
    let received = block_on(receiver.receive_async()).unwrap();
    assert_eq!(received, Some(Received::Packet(log())));
}
