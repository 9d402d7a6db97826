//! A noisy line, packet by packet: what no bit of was hit arrives, and nothing else does.
//!
//! `LINK_PACKETS` says how many packets; a million takes a minute or two.

use firmware::link::packet::{FrameStart, Meaning};
use firmware::link::{
    BODY_MAX, Choice, Encoding, Format, Inbox, Outgoing, Packet, Received, Sender, wire_bytes,
};
use host_sim::picture::crc32_after;
use host_sim::stream::{Noise, Rates};

const WIDTH: usize = 640;
const HEIGHT: u32 = 480;
const BIT_ERROR_RATE: f64 = 1e-5;
const SEED: u64 = 2026;

/// A line that no other is like: its number, and bytes that follow from it.
fn pixels(number: u32, line: &mut [u8]) {
    let mut state = u64::from(number).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    for eight in line.chunks_mut(8) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        eight.copy_from_slice(&state.to_le_bytes()[..eight.len()]);
    }
}

fn start(number: u32) -> FrameStart {
    FrameStart {
        stream: 0,
        format: Format::RGB888,
        meaning: Meaning::default(),
        snapshot: false,
        sequence: number / HEIGHT,
        width: WIDTH as u16,
        height: HEIGHT as u16,
        captured: 0,
        palette: 0,
    }
}

#[test]
fn every_undamaged_line_arrives_and_no_damaged_one_is_accepted() {
    let packets = std::env::var("LINK_PACKETS").map_or(20_000, |text| text.parse().unwrap());
    let mut noise = Noise::new(Rates { bits: BIT_ERROR_RATE, ..Rates::default() }, SEED);
    let (mut memory, mut body) = (vec![0; wire_bytes(BODY_MAX)], vec![0; BODY_MAX]);
    let mut inbox = Inbox::new(&mut body, crc32_after);
    let (mut line, mut sent, mut arrived) = (vec![0; 3 * WIDTH], Vec::new(), Vec::new());
    let (mut hit, mut joined, mut received) = (0, 0, 0);
    let mut end_was_hit = false;
    for number in 0..packets {
        pixels(number, &mut line);
        sent.clear();
        let mut sender = Sender::new(&mut sent, &mut memory, crc32_after);
        let mut frame = Outgoing::new(start(number), Choice::One(Encoding::Raw), crc32_after);
        sender.line(&mut frame, (number % HEIGHT) as u16, &line).unwrap();
        arrived.clear();
        noise.pass(&sent, &mut arrived);
        let is_hit = arrived != sent;
        // The zero before a packet is as much part of it as the zero behind.
        let whole = !is_hit && !end_was_hit;
        let mut came = 0;
        inbox.feed(&arrived, |packet| {
            if let Received::Packet(packet) = packet {
                assert!(whole, "packet {number} was damaged and taken for {packet:?}");
                let Packet::Line(got) = packet else { panic!("packet {number}: {packet:?}") };
                let place = (got.sequence, u32::from(got.line), got.first, got.payload);
                assert_eq!(place, ((number / HEIGHT) as u16, number % HEIGHT, 0, line.as_slice()));
                came += 1;
            }
        });
        assert_eq!(came, u32::from(whole), "packet {number}");
        hit += u32::from(is_hit);
        joined += u32::from(!is_hit && end_was_hit);
        received += came;
        end_was_hit = arrived.last() != Some(&0);
    }
    println!(
        "{packets} packets, seed {SEED}: {} bits flipped; {hit} packets hit, {joined} more joined to one whose end was hit, \
         {received} received, 0 damaged ones among them",
        noise.damage().bits
    );
    assert_eq!(received + hit + joined, packets);
    assert!(hit > packets / 10, "the line was noisy");
}
