//! Sync by codes in the data, in the manner of ITU-R BT.656-5 §2.4, progressive.
//!
//! ```text
//! line of picture   FF 00 00 80  data …       FF 00 00 9D  80 10 80 10 …
//! line of blanking  FF 00 00 AB  80 10 80 …   FF 00 00 B6  80 10 80 10 …
//!                   SAV                       EAV          hblank - 8 clocks
//! ```
//!
//! The sync wires idle low. A stream starts with lines of blanking, which a receiver needs to see a frame's start,
//! and ends with them. `vblank` holds as many whole lines of blanking as fit; the rest is filler.
//!
//! Where we deviate: the standard changes the EAV with the line that follows, so its last line of picture ends with
//! B6 and its last line of blanking with 9D; here a line's two codes are always of one kind, so that the same two
//! codes stand around every line of picture. And the standard is interlaced with 525 or 625 lines of 1,440 samples.

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::lines::{Lines, lines_of};
use crate::profile::Profile;

const PICTURE_START: [u8; 4] = [0xFF, 0, 0, 0x80];
const PICTURE_END: [u8; 4] = [0xFF, 0, 0, 0x9D];
const BLANK_START: [u8; 4] = [0xFF, 0, 0, 0xAB];
const BLANK_END: [u8; 4] = [0xFF, 0, 0, 0xB6];

/// Chroma and luma of black, over and over.
const FILLER: [u8; 4096] = {
    let mut filler = [0x80; 4096];
    let mut at = 1;
    while at < filler.len() {
        filler[at] = 0x10;
        at += 2;
    }
    filler
};

/// Replaces the two bytes that sync codes are made of by their neighbours: 0x00 by 0x01 and 0xFF by 0xFE.
///
/// BT.656 reserves both. So no data looks like a code, at the cost of one level at either end.
pub fn make_code_free(bytes: &mut [u8]) {
    for byte in bytes {
        *byte = (*byte).clamp(0x01, 0xFE);
    }
}

fn filler<S: StretchSink>(sink: &mut S, mut clocks: usize) -> Result<(), S::Error> {
    while clocks > 0 {
        // A chunk is even, so chroma and luma alternate across chunks.
        let chunk = &FILLER[..clocks.min(FILLER.len())];
        sink.stretch(Sync::default(), Samples::Bytes(chunk))?;
        clocks -= chunk.len();
    }
    Ok(())
}

/// Clocks of filler between the codes of neighbouring lines.
fn between_lines(profile: &Profile) -> usize {
    profile.timing.hblank.saturating_sub(8) as usize
}

pub(super) fn frame<S: StretchSink>(
    profile: &Profile,
    lines: &mut Lines,
    bytes: &[u8],
    _is_first: bool,
    sink: &mut S,
) -> Result<(), S::Error> {
    blanking(profile, sink)?;
    for line in lines_of(profile, bytes) {
        let coded = &mut lines.bytes;
        coded.clear();
        coded.extend(PICTURE_START);
        coded.extend(line);
        make_code_free(&mut coded[4..]);
        coded.extend(PICTURE_END);
        sink.stretch(Sync::default(), Samples::Bytes(coded))?;
        filler(sink, between_lines(profile))?;
    }
    Ok(())
}

/// The lines between frames: from after the last line's blanking to before the next frame's first code.
pub(super) fn blanking<S: StretchSink>(profile: &Profile, sink: &mut S) -> Result<(), S::Error> {
    let line = u64::from(profile.samples_per_line());
    // What the last line's own blanking leaves of vblank.
    let clocks = u64::from(profile.timing.vblank.saturating_sub(profile.timing.hblank));
    let period = profile.clocks_per_line().max(1);
    for _ in 0..clocks / period {
        sink.stretch(Sync::default(), Samples::Bytes(&BLANK_START))?;
        filler(sink, line as usize)?;
        sink.stretch(Sync::default(), Samples::Bytes(&BLANK_END))?;
        filler(sink, between_lines(profile))?;
    }
    filler(sink, (clocks % period) as usize)
}
