//! The whole way: what is sent comes back, whatever happens to it, and nothing is ever in a wrong place.

use std::vec;
use std::vec::Vec;

use proptest::prelude::*;

use super::packet::{Level, Log, Meaning, Stream};
use super::*;
use crate::driver::verdict::{Outcome, Verdict};

const WIDTH: u16 = 24;
const HEIGHT: u16 = 40;

/// A pixel that says which it is: frame, line, place in the line.
fn line_of(sequence: u32, line: u16) -> Vec<u8> {
    (0..WIDTH).flat_map(|x| [(sequence as u8).wrapping_add(1), line as u8, x as u8]).collect()
}

fn start(sequence: u32) -> packet::FrameStart {
    packet::FrameStart {
        stream: 0,
        format: Format::RGB888,
        meaning: Meaning::default(),
        snapshot: false,
        sequence,
        width: WIDTH,
        height: HEIGHT,
        captured: 0,
        palette: 0,
    }
}

/// Frames from `first` on as packets, each as its bytes, with a STREAM before each frame.
fn packets(first: u32, frames: u32, body: usize, choice: Choice) -> Vec<Vec<u8>> {
    let (mut memory, mut all) = (vec![0; wire_bytes(body)], Vec::new());
    for sequence in first..first + frames {
        let mut bytes = Vec::new();
        let mut sender = Sender::new(&mut bytes, &mut memory, small_table);
        let (format, meaning) = (Format::RGB888, Meaning::default());
        let described = Stream {
            stream: 0,
            format,
            encoding: choice,
            on: true,
            width: WIDTH,
            height: HEIGHT,
            meaning,
            pipeline: "",
            name: "raw",
        };
        sender.send(&Packet::Stream(described)).unwrap();
        let mut frame = sender.begin(start(sequence), choice).unwrap();
        for line in 0..HEIGHT {
            sender.line(&mut frame, line, &line_of(sequence, line)).unwrap();
        }
        sender.end(frame.end().judged(&Verdict { sequence, ..Verdict::default() })).unwrap();
        // A zero ends each packet; those before a packet go with it.
        let packets = bytes.split_inclusive(|&byte| byte == 0).filter(|packet| packet.len() > 1);
        all.extend(packets.map(<[u8]>::to_vec));
    }
    all
}

/// An ended frame: its sequence, missing lines, whether END came, whether its CRC is right, whether it was repaired.
type Ended = (u32, Vec<u16>, bool, Option<bool>, bool);

/// What a receiver makes of bytes that come in chunks. Every pixel that is there is checked.
struct Heard {
    frames: Vec<Ended>,
    counts: Counts,
    dropped: Dropped,
    bodies: Vec<Vec<u8>>,
}

fn listen(bytes: &[u8], chunk: usize) -> Heard {
    let (mut picture, mut marks) = (vec![0xAA; 3 * 64 * 64], [u32::MAX; 2]);
    let mut memory = [0; BODY_MAX];
    let mut inbox = Inbox::new(&mut memory, small_table);
    let mut assembler = Assembler::new(0, &mut picture, &mut marks, small_table);
    let (mut frames, mut bodies) = (Vec::new(), Vec::new());
    let mut on_frame = |frame: Assembled<'_>| {
        assert_eq!((frame.width, frame.height), (WIDTH, HEIGHT));
        for (line, row) in (0..).zip(frame.picture.chunks(3 * usize::from(WIDTH))) {
            if frame.is_missing(line) {
                assert!(row.iter().all(|&byte| byte == 0));
            } else {
                assert_eq!(row, line_of(frame.sequence, line), "frame {}, line {line}", frame.sequence);
            }
        }
        let missing = frame.missing().collect();
        frames.push((frame.sequence, missing, frame.end.is_some(), frame.crc, frame.repaired));
    };
    let mut framing = [0; wire_bytes(BODY_MAX)];
    let mut framer = Framer::new(&mut framing, small_table);
    for chunk in bytes.chunks(chunk) {
        inbox.feed(chunk, |received| {
            if let Received::Packet(packet) = received {
                assembler.push(&packet, &mut on_frame);
                bodies.push(packet.frame(&mut framer).unwrap().to_vec());
            }
        });
    }
    assembler.finish(&mut on_frame);
    Heard { frames, counts: inbox.counts(), dropped: assembler.dropped(), bodies }
}

#[test]
fn a_quiet_line_loses_nothing() {
    for body in [BODY_MAX, 64] {
        for choice in [Choice::Sender, Choice::One(Encoding::Raw), Choice::One(Encoding::RunLength)] {
            let packets = packets(65_534, 4, body, choice);
            let heard = listen(&packets.concat(), 97);
            let expected: Vec<_> =
                (65_534..65_538).map(|sequence| (sequence, vec![], true, Some(true), false)).collect();
            assert_eq!(heard.frames, expected);
            assert_eq!(heard.counts, Counts { received: packets.len() as u32, ..Counts::default() });
            assert_eq!(heard.dropped, Dropped::default());
        }
    }
}

#[test]
fn lines_that_are_asked_for_repair_a_frame() {
    let mut memory = [0; wire_bytes(512)];
    let mut bytes = Vec::new();
    let mut sender = Sender::new(&mut bytes, &mut memory, small_table);
    let mut frame = sender.begin(start(7), Choice::Sender).unwrap();
    let all: Vec<_> = (0..HEIGHT).map(|line| line_of(7, line)).collect();
    for line in 0..HEIGHT {
        if line == 3 || line == 30 {
            // Counted as sent, and lost.
            let mut memory = [0; wire_bytes(512)];
            let mut nowhere = Sender::new(Vec::new(), &mut memory, small_table);
            nowhere.line(&mut frame, line, &all[usize::from(line)]).unwrap();
        } else {
            sender.line(&mut frame, line, &all[usize::from(line)]).unwrap();
        }
    }
    sender.end(frame.end()).unwrap();
    for line in [3, 30, 3] {
        sender.resend(&frame, line, &all[usize::from(line)]).unwrap();
    }
    let heard = listen(&bytes, 1000);
    // The frame's CRC is that of the lines in the order in which they were sent: top to bottom.
    let expected = [(7, vec![3, 30], true, None, false), (7, vec![], true, Some(true), true)];
    assert_eq!(heard.frames, expected);
    assert_eq!(heard.dropped, Dropped { doubled: 1, ..Dropped::default() });
}

/// Every packet cut at every length: what is left of it is no packet, and the next one is received.
#[test]
fn every_truncation_costs_one_packet() {
    let all = packets(1, 1, BODY_MAX, Choice::Sender);
    let (line, next) = (&all[5], &all[6]);
    for length in 0..line.len() - 1 {
        let bytes = [&line[..length], &[0], next].concat();
        let heard = listen(&bytes, 4096);
        assert_eq!(heard.counts.received, 1, "cut to {length}");
        assert_eq!(heard.bodies, std::slice::from_ref(next));
        // Without the zero, two packets are one.
        let heard = listen(&[&line[..length], next.as_slice()].concat(), 4096);
        assert_eq!(heard.counts.received, u32::from(length == 0), "cut to {length}");
    }
}

/// Every bit of every kind of packet flipped: it is not received, and the packet after the next zero is.
#[test]
fn every_flip_costs_one_packet() {
    let all = packets(1, 1, BODY_MAX, Choice::Sender);
    let end = all.len() - 1;
    for at in [0, 1, 2, end] {
        let packet = &all[at];
        let last = packet.len() - 1;
        for bit in 0..8 * packet.len() {
            let mut hit = packet.clone();
            hit[bit / 8] ^= 1 << (bit % 8);
            let joined = bit / 8 == last;
            let bytes = [hit, all[3].clone(), all[4].clone()].concat();
            let heard = listen(&bytes, 4096);
            assert_eq!(heard.bodies.len(), if joined { 1 } else { 2 }, "packet {at}, bit {bit}");
            assert_eq!(heard.bodies.last(), Some(&all[4]));
        }
    }
}

#[test]
fn any_bytes_are_no_packet_and_harmless() {
    let mut state = 1u64;
    let noise: Vec<u8> = (0..200_000)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 56) as u8
        })
        .collect();
    let heard = listen(&noise, 1000);
    assert_eq!((heard.counts.received, heard.frames.len()), (0, 0));
    assert!(heard.counts.damaged > 500);
}

#[test]
fn a_log_that_does_not_fit_is_cut_between_characters() {
    let mut memory = [0; wire_bytes(40)];
    let mut framer = Framer::new(&mut memory, small_table);
    let text = "µµµµµµµµµµµµµµµµ";
    let log = Packet::Log(Log { level: Level::Warning, cut: false, lost: 0, time: 9, text });
    let wire = log.frame(&mut framer).unwrap().to_vec();
    let mut body = [0; 64];
    let mut inbox = Inbox::new(&mut body, small_table);
    inbox.feed(&wire, |received| {
        let Received::Packet(Packet::Log(log)) = received else { panic!("{received:?}") };
        assert_eq!((log.text, log.cut), ("µµµµµµµµµµ", true));
    });
    assert_eq!(inbox.counts().received, 1);
}

/// What may happen to a packet on its way.
#[derive(Clone, Debug)]
enum Fate {
    Fine,
    Lost,
    Doubled,
    Flipped(usize),
    Cut(usize),
    Grown(usize, u8),
}

fn fate() -> impl Strategy<Value = Fate> {
    prop_oneof![
        20 => Just(Fate::Fine),
        1 => Just(Fate::Lost),
        1 => Just(Fate::Doubled),
        1 => any::<usize>().prop_map(Fate::Flipped),
        1 => any::<usize>().prop_map(Fate::Cut),
        1 => (any::<usize>(), any::<u8>()).prop_map(|(at, byte)| Fate::Grown(at, byte)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// After any loss, flip, insertion or duplication every undamaged packet is received, and every line of one is in
    /// its place; `listen` looks at each pixel.
    #[test]
    fn what_is_whole_arrives_and_nothing_is_misplaced(
        fates in prop::collection::vec(fate(), 200),
        first in prop_oneof![Just(0u32), Just(65_530), Just(u32::MAX - 2)],
        body in prop_oneof![Just(BODY_MAX), Just(62usize)],
        chunk in 1usize..3000,
    ) {
        let first = first.min(u32::MAX - 4);
        let packets = packets(first, 3, body, Choice::Sender);
        let (mut wire, mut intact, mut joined) = (Vec::new(), Vec::new(), false);
        for (packet, fate) in packets.iter().zip(fates.iter().chain(std::iter::repeat(&Fate::Fine))) {
            let mut hit = packet.clone();
            // The zero at the end stays in place unless it is what is hit.
            let last = hit.len() - 1;
            let mut times = 1;
            match *fate {
                Fate::Fine => {}
                Fate::Lost => continue,
                Fate::Doubled => times = 2,
                Fate::Flipped(bit) => hit[bit / 8 % packet.len()] ^= 1 << (bit % 8),
                Fate::Cut(at) => _ = hit.remove(at % packet.len()),
                Fate::Grown(at, byte) => hit.insert(at % last, byte),
            }
            // An insertion at the front of a zero changes nothing.
            let same = hit == *packet || hit.strip_prefix(&[0]).is_some_and(|rest| rest == packet);
            if same && (!joined || hit[0] == 0) {
                intact.extend(std::iter::repeat_n(packet.clone(), times));
            } else if same && times == 2 {
                intact.push(packet.clone());
            }
            joined = hit.last() != Some(&0);
            for _ in 0..times {
                wire.extend_from_slice(&hit);
            }
        }
        let heard = listen(&wire, chunk);
        let without_zeros = |packets: &[Vec<u8>]| -> Vec<Vec<u8>> {
            packets.iter().map(|p| p.strip_prefix(&[0]).unwrap_or(p).to_vec()).collect()
        };
        prop_assert_eq!(without_zeros(&heard.bodies), without_zeros(&intact));
        // Lines that were sent whole in one packet, undamaged, are there.
        if body == BODY_MAX {
            let mut arrived = Vec::new();
            for packet in &intact {
                let mut memory = [0; BODY_MAX];
                Inbox::new(&mut memory, small_table).feed(packet, |received| {
                    if let Received::Packet(Packet::Line(line)) = received {
                        arrived.push((line.sequence, line.line));
                    }
                });
            }
            for sequence in first..first + 3 {
                let ended = heard.frames.iter().filter(|frame| frame.0 as u16 == sequence as u16).collect::<Vec<_>>();
                for line in 0..HEIGHT {
                    let arrived = arrived.contains(&(sequence as u16, line));
                    let known = heard.dropped.unplaced == 0;
                    if arrived && known {
                        prop_assert!(ended.iter().any(|frame| !frame.1.contains(&line)), "{sequence} {line}");
                    }
                    if !arrived {
                        prop_assert!(ended.iter().all(|frame| frame.1.contains(&line)), "{sequence} {line}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_capture_s_verdict_comes_back() {
    for outcome in [
        Outcome::Good,
        Outcome::Short { expected: 1 },
        Outcome::Long { expected: 2 },
        Outcome::LineCount { expected: 3 },
        Outcome::LineLength { expected: 4 },
        Outcome::LinesDropped { lines: 5 },
        Outcome::Overrun,
        Outcome::SyncError,
        Outcome::DmaError,
        Outcome::DmaStalled,
        Outcome::LateInterrupt,
    ] {
        let end = Outgoing::new(start(1), Choice::Sender, small_table).end();
        assert_eq!(end.outcome(), None);
        assert_eq!(end.judged(&Verdict { outcome, ..Verdict::default() }).outcome(), Some(outcome));
    }
}
