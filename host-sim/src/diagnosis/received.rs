//! The frame that a device received, against the frames of the trace.
//!
//! ```text
//! trace     A B C D E F G H        received = a frame of the trace     the receiver is right
//! received  A B C F G H …          goes on elsewhere after a place     words were lost there: DMA or bus
//! received  B A D C F E H G        another order or bits, all along    byte order or wires behind the probe
//! ```

use super::finding::{Evidence, Finding, Remedy};
use super::structure::{At, found};
use crate::fault::FaultKind;
use crate::profile::Profile;

/// Bytes that must agree for a piece to be found again.
const PIECE: usize = 64;

/// A frame of the trace, and the clock at which it ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sent {
    /// Its bytes as the block and an ideal DMA leave them.
    pub bytes: Vec<u8>,
    /// The clock of its end.
    pub end: u64,
}

/// What the comparison says.
#[derive(Clone, Debug, PartialEq)]
pub enum Comparison {
    /// The frame is one of the trace's.
    Same {
        /// Which, from 0.
        frame: usize,
    },
    /// It is one of them damaged on the way from the pins into memory.
    Damaged(Box<Finding>),
    /// It is none of them.
    Unrelated,
}

/// Compares a frame received with those of the trace.
#[must_use]
pub fn compare(received: &[u8], sent: &[Sent], profile: &Profile) -> Comparison {
    if let Some(frame) = sent.iter().position(|sent| sent.bytes == received) {
        return Comparison::Same { frame };
    }
    let likely = sent.iter().map(|sent| (agreement(received, &sent.bytes), sent));
    let Some((share, nearest)) = likely.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Comparison::Unrelated;
    };
    let finding = reordered(received, nearest, profile)
        .or_else(|| lost(received, nearest, sent, profile))
        .or_else(|| (share > 0.5).then(|| scattered(received, nearest, share)));
    finding.map_or(Comparison::Unrelated, |finding| Comparison::Damaged(Box::new(finding)))
}

/// The share of bytes that are alike.
fn agreement(a: &[u8], b: &[u8]) -> f64 {
    let alike = a.iter().zip(b).filter(|(a, b)| a == b).count();
    alike as f64 / a.len().max(b.len()).max(1) as f64
}

/// The same bytes in another order, or through other wires, all along.
fn reordered(received: &[u8], sent: &Sent, profile: &Profile) -> Option<Finding> {
    if received.len() != sent.bytes.len() {
        return None;
    }
    for size in [2usize, 4] {
        let swapped = sent.bytes.chunks(size).flat_map(|word| word.iter().rev());
        if swapped.eq(received) {
            let evidence = Evidence::new(format!(
                "the frame is the trace's with the bytes of every {} bits in reverse",
                8 * size
            ))
            .with("bytes_a_group", size as f64);
            let remedy = Remedy::new(
                "the receiver stores words in the other byte order: set it in the DMA or the display, not at the sensor",
            );
            return Some(found(FaultKind::ByteSwap, 0.97, At::default(), evidence, remedy));
        }
    }
    if profile.bus.bits != 8 {
        return None;
    }
    // A wire each: what of the trace does this bit of the memory follow?
    let mut follows = [None::<usize>; 8];
    let mut constant = [None::<bool>; 8];
    for (bit, (follows, constant)) in follows.iter_mut().zip(&mut constant).enumerate() {
        let level = |byte: u8, bit: usize| byte >> bit & 1 == 1;
        *follows = (0..8)
            .map(|offset| (bit + offset) % 8)
            .find(|&other| received.iter().zip(&sent.bytes).all(|(r, s)| level(*r, bit) == level(*s, other)));
        *constant =
            [false, true].into_iter().find(|fixed| received.iter().all(|byte| level(*byte, bit) == *fixed));
    }
    let wrong: Vec<usize> = (0..8).filter(|&bit| follows[bit] != Some(bit)).collect();
    match wrong[..] {
        [bit] => constant[bit].map(|high| {
            let level = if high { "high" } else { "low" };
            let evidence =
                Evidence::new(format!("bit {bit} is always {level} in memory and changes in the trace"))
                    .with("bit", bit as f64);
            let remedy = Remedy::new(format!(
                "check the receiver's pin for D{bit}: its alternate function and its solder joint"
            ));
            found(FaultKind::StuckBit, 0.97, At::default(), evidence, remedy)
        }),
        [a, b] if follows[a] == Some(b) && follows[b] == Some(a) => {
            let evidence =
                Evidence::new(format!("bits {a} and {b} of memory are D{b} and D{a} of the trace"))
                    .with("a", a as f64)
                    .with("b", b as f64);
            let remedy = Remedy::new(format!("exchange the receiver's pins for D{a} and D{b}"));
            Some(found(FaultKind::SwappedBits, 0.97, At::default(), evidence, remedy))
        }
        _ => None,
    }
}

/// After a place the frame goes on with a later part of the trace.
fn lost(received: &[u8], sent: &Sent, all: &[Sent], profile: &Profile) -> Option<Finding> {
    let start = received.iter().zip(&sent.bytes).take_while(|(a, b)| a == b).count();
    if start < PIECE.min(received.len() / 2) {
        return None;
    }
    let kind = FaultKind::ClockTooFast;
    let line = start / (profile.bytes_per_line() as usize).max(1);
    let at = At {
        // Counted back from the frame's end, with the blanking that the profile promises.
        clock: sent.end.saturating_sub(
            (sent.bytes.len() - start) as u64 / u64::from(profile.bus.bytes_per_sample())
                + u64::from(profile.timing.hblank)
                    * u64::from(profile.frame.height).saturating_sub(line as u64 + 1)
                + u64::from(profile.timing.vfront),
        ),
        line: Some(line as u32),
    };
    let remedy = || super::remedy::of(kind, profile);
    let place = format!("up to byte {start} (line {line}) the frame is the trace's");
    if start == received.len() {
        let evidence = Evidence::new(format!(
            "{place}, and there it breaks off, {} bytes short",
            sent.bytes.len() - start
        ))
        .with("first_wrong_byte", start as f64);
        return Some(found(kind, 0.8, at, evidence, remedy()));
    }
    let piece = received.get(start..start + PIECE)?;
    if piece.iter().all(|byte| *byte == piece[0]) {
        let evidence = Evidence::new(format!(
            "{place}, then memory holds {} over and over: nothing was written there",
            piece[0]
        ))
        .with("first_wrong_byte", start as f64);
        return Some(found(kind, 0.8, at, evidence, remedy()));
    }
    // In this frame further on, or at another's beginning: an overrun waits for the next frame and goes on writing.
    let later = sent.bytes[start..].windows(PIECE).position(|window| window == piece);
    let (text, confidence) = match later {
        Some(skip) => (format!("{place}, then {skip} bytes are missing and it goes on"), 0.95),
        None => all
            .iter()
            .find_map(|other| other.bytes.windows(PIECE).position(|window| window == piece))
            .map(|from| {
                (
                    format!(
                        "{place}, then comes byte {from} of another frame: capture overran and began anew"
                    ),
                    0.95,
                )
            })?,
    };
    let evidence = Evidence::new(text)
        .with("first_wrong_byte", start as f64)
        .with("bytes_missing", later.unwrap_or(sent.bytes.len() - start) as f64);
    Some(found(kind, confidence, at, evidence, remedy()))
}

/// Single bytes differ.
fn scattered(received: &[u8], sent: &Sent, share: f64) -> Finding {
    let start = received.iter().zip(&sent.bytes).take_while(|(a, b)| a == b).count();
    let evidence = Evidence::new(format!(
        "{:.2} % of the bytes differ from the trace's, the first at byte {start}, and no bytes are missing",
        100.0 * (1.0 - share)
    ))
    .with("share_alike", share)
    .with("first_wrong_byte", start as f64);
    let remedy =
        Remedy::new("the receiver samples close to where data changes: compare its edge with the analyser's")
            .register("CR.PCKPOL = the other value");
    found(FaultKind::ClockJitter, 0.6, At::default(), evidence, remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: u64) -> Vec<u8> {
        let mut random = crate::fault::Random::new(seed);
        (0..4_096).map(|_| random.bits() as u8).collect()
    }

    #[test]
    fn a_frame_is_told_from_its_damages() {
        let sent: Vec<Sent> =
            (0..3).map(|seed| Sent { bytes: noise(seed), end: 5_000 * (seed + 1) }).collect();
        let profile = Profile::from_toml("[frame]\nwidth = 64\nheight = 64\nformat = \"gray8\"\n").unwrap();
        let said = |received: &[u8]| match compare(received, &sent, &profile) {
            Comparison::Damaged(finding) => Some((finding.fault, finding.evidence.text)),
            _ => None,
        };
        let frame = &sent[1].bytes;
        assert_eq!(compare(frame, &sent, &profile), Comparison::Same { frame: 1 });
        assert_eq!(compare(&noise(9), &sent, &profile), Comparison::Unrelated);
        let swapped: Vec<u8> = frame.chunks(4).flat_map(|word| word.iter().rev().copied()).collect();
        assert_eq!(said(&swapped).unwrap().0, FaultKind::ByteSwap);
        let stuck: Vec<u8> = frame.iter().map(|byte| byte | 4).collect();
        assert_eq!(said(&stuck).unwrap().0, FaultKind::StuckBit);
        let crossed: Vec<u8> =
            frame.iter().map(|&byte| crate::fault::swap_bits(byte.into(), 1, 6) as u8).collect();
        assert_eq!(said(&crossed).unwrap().0, FaultKind::SwappedBits);
        let torn = [&frame[..1_000], &frame[1_016..], &[0; 16]].concat();
        let (fault, text) = said(&torn).unwrap();
        assert_eq!(fault, FaultKind::ClockTooFast);
        assert!(text.contains("byte 1000 (line 15)") && text.contains("16 bytes are missing"), "{text}");
        let rolled = [&frame[..1_000], &sent[2].bytes[..3_096]].concat();
        assert!(said(&rolled).unwrap().1.contains("began anew"));
        assert!(said(&frame[..2_000]).unwrap().1.contains("2096 bytes short"));
    }
}
