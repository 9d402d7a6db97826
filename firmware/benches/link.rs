//! The receiving end of the link on a host: bytes of the wire into packets, and into frames; beside a byte-by-byte
//! decoder (the crate `cobs`) with the same CRC.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use firmware::link::packet::{FrameStart, Meaning};
use firmware::link::{
    Assembler, BODY_MAX, Choice, Encoding, Format, Inbox, Packet, Received, Sender, marks_words,
    picture_bytes, wire_bytes,
};

const WIDTH: u16 = 640;
const HEIGHT: u16 = 480;
/// Bytes that come at a time, as from a socket.
const CHUNK: usize = 64 * 1024;

fn crc(before: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(bytes);
    hasher.finalize()
}

/// A VGA frame on the wire. `zero_in`: one byte of so many is zero, the others are not.
fn frame(zero_in: u32, encoding: Encoding) -> Vec<u8> {
    let mut state = 1u32;
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        if (state >> 8).is_multiple_of(zero_in) { 0 } else { (state >> 24) as u8 | 1 }
    };
    let (mut memory, mut wire) = (vec![0; wire_bytes(BODY_MAX)], Vec::new());
    let mut sender = Sender::new(&mut wire, &mut memory, crc);
    let start = FrameStart {
        stream: 0,
        format: Format::RGB888,
        meaning: Meaning::default(),
        snapshot: false,
        sequence: 1,
        width: WIDTH,
        height: HEIGHT,
        captured: 0,
        palette: 0,
    };
    let mut outgoing = sender.begin(start, Choice::One(encoding)).unwrap();
    for line in 0..HEIGHT {
        let pixels: Vec<u8> = (0..3 * WIDTH).map(|_| byte()).collect();
        sender.line(&mut outgoing, line, &pixels).unwrap();
    }
    sender.end(outgoing.end()).unwrap();
    wire
}

/// Packets, their fields read; returns the bytes of their payloads.
fn packets(wire: &[u8], memory: &mut [u8]) -> usize {
    let (mut inbox, mut bytes) = (Inbox::new(memory, crc), 0);
    for chunk in wire.chunks(CHUNK) {
        inbox.feed(chunk, |received| {
            if let Received::Packet(Packet::Line(line)) = received {
                bytes += line.payload.len();
            }
        });
    }
    assert_eq!(inbox.counts().damaged, 0);
    bytes
}

/// Frames, with their own CRC checked; returns how many were right.
fn frames(wire: &[u8], memory: &mut [u8], picture: &mut [u8], marks: &mut [u32]) -> usize {
    let (mut inbox, mut right) = (Inbox::new(memory, crc), 0);
    let mut assembler = Assembler::new(0, picture, marks, crc);
    for chunk in wire.chunks(CHUNK) {
        inbox.feed(chunk, |received| {
            if let Received::Packet(packet) = received {
                assembler.push(&packet, &mut |frame| right += usize::from(frame.crc == Some(true)));
            }
        });
    }
    right
}

/// The same as `packets` by the crate `cobs`, without reading any field.
fn peer(wire: &[u8], memory: &mut [u8]) -> usize {
    let mut bytes = 0;
    for packet in wire.split(|&byte| byte == 0).filter(|packet| !packet.is_empty()) {
        let report = cobs::decode(packet, memory).unwrap();
        let (body, expected) = memory[..report.frame_size()].split_last_chunk::<4>().unwrap();
        assert_eq!(crc(0, body), u32::from_le_bytes(*expected));
        bytes += body.len();
    }
    bytes
}

fn receive(criterion: &mut Criterion) {
    let mut memory = vec![0; BODY_MAX];
    let format = Format::RGB888;
    let mut picture = vec![0; picture_bytes(format, WIDTH.into(), HEIGHT.into())];
    let mut marks = vec![0; marks_words(HEIGHT.into())];
    for (name, zero_in) in [("no zeros", u32::MAX), ("1 zero in 256", 256), ("1 zero in 16", 16)] {
        let wire = frame(zero_in, Encoding::Raw);
        let mut group = criterion.benchmark_group(format!("link receive, {name}"));
        group.throughput(Throughput::Bytes(wire.len() as u64));
        group.bench_function("packets", |bench| bench.iter(|| packets(black_box(&wire), &mut memory)));
        group.bench_function("frames", |bench| {
            bench.iter(|| assert_eq!(frames(black_box(&wire), &mut memory, &mut picture, &mut marks), 1));
        });
        group.bench_function("peer: cobs, crc32fast", |bench| {
            bench.iter(|| peer(black_box(&wire), &mut memory));
        });
        group.finish();
    }
}

criterion_group!(benches, receive);
criterion_main!(benches);
