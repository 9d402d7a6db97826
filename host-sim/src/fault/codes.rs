//! HSYNC and VSYNC missing or spurious, where they stand in codes.
//!
//! A code is known only when its last byte has come, so clocks are held back until four more have followed.

use std::collections::VecDeque;

use firmware::camif::pins::Pins;

use super::clock::Hits;
use super::inject::Fault;
use super::kind::FaultKind;
use super::place::{Part, Place};
use super::random::Random;
use super::spec::FaultSpec;
use super::sync::MARGIN;
use crate::profile::Profile;

/// What stands where a code was: black.
const FILLER: [u16; 4] = [0x80, 0x10, 0x80, 0x10];
/// End of a line of picture, start of one.
const END: u16 = 0x9D;
const START: u16 = 0x80;
/// The same for a line of blanking.
const BLANK_END: u16 = 0xB6;
const BLANK_START: u16 = 0xAB;

pub(super) fn make(spec: &FaultSpec, profile: &Profile, random: Random) -> Box<dyn Fault> {
    let blank_lines = (profile.timing.vblank.saturating_sub(profile.timing.hblank))
        / profile.clocks_per_line().max(1) as u32;
    let (change, hits) = match spec.kind {
        FaultKind::MissingHsync => (Change::MergeLines, Some(Hits::new(spec, profile, random).but_last(1))),
        FaultKind::SpuriousHsync => {
            (Change::Write(&[END, START]), Some(Hits::new(spec, profile, random).within(MARGIN, MARGIN + 8)))
        }
        FaultKind::SpuriousVsync => {
            (Change::Write(&[BLANK_END]), Some(Hits::new(spec, profile, random).within(MARGIN, MARGIN + 8)))
        }
        FaultKind::MissingVsync => (Change::MergeFrames { every: spec.value("every") as u64 }, None),
        _ => {
            let line = (i64::from(profile.frame.height) * spec.value("percent") / 100).max(1) as u32;
            (Change::BlankLines { from: line, to: line + blank_lines.max(1) }, None)
        }
    };
    Box::new(Codes { change, hits, held: VecDeque::new(), merge: false, frame: 0 })
}

enum Change {
    /// Codes within a line.
    Write(&'static [u16]),
    MergeLines,
    MergeFrames {
        every: u64,
    },
    BlankLines {
        from: u32,
        to: u32,
    },
}

struct Codes {
    change: Change,
    hits: Option<Hits>,
    /// The last four clocks.
    held: VecDeque<Pins>,
    /// The code of the line's end was taken away, so the next line's start goes as well.
    merge: bool,
    frame: u64,
}

impl Codes {
    /// The code's last byte has come as the last of the held clocks: what is to stand there.
    fn code(&mut self, place: &Place, code: u16) -> Option<[u16; 4]> {
        match &self.change {
            Change::Write(_) => None,
            Change::MergeLines => {
                let hits = self.hits.as_mut()?;
                if code == END {
                    self.merge = hits.hits_line(place);
                    return self.merge.then_some(FILLER);
                }
                (std::mem::take(&mut self.merge) && code == START).then_some(FILLER)
            }
            Change::MergeFrames { every } => {
                let lost = place.frame > 0 && place.frame % every == 1 % every;
                (lost && matches!(code, BLANK_START | BLANK_END)).then_some(FILLER)
            }
            Change::BlankLines { from, to } => {
                if !(*from..*to).contains(&place.line) {
                    return None;
                }
                match code {
                    START => Some([0xFF, 0, 0, BLANK_START]),
                    END => Some([0xFF, 0, 0, BLANK_END]),
                    _ => None,
                }
            }
        }
    }
}

impl Fault for Codes {
    fn clock(&mut self, place: &Place, mut pins: Pins, out: &mut Vec<Pins>) {
        if let (Change::Write(codes), Some(hits), Part::Data) = (&self.change, &mut self.hits, place.part) {
            let length = 4 * codes.len() as u32;
            let inside = hits.of_line(place).find(|hit| (*hit..hit + length).contains(&place.column));
            if let Some(at) = inside.map(|hit| (place.column - hit) as usize) {
                pins.data = [0xFF, 0, 0, codes[at / 4]][at % 4];
            }
        }
        self.frame = place.frame;
        self.held.push_back(pins);
        if self.held.len() > 4
            && let Some(first) = self.held.pop_front()
        {
            out.push(first);
        }
        if !matches!(self.change, Change::Write(_))
            && self.held.iter().map(|pins| pins.data).take(3).eq([0xFF, 0, 0])
            && let Some(made) = self.code(place, pins.data)
        {
            for (pins, data) in self.held.iter_mut().zip(made) {
                pins.data = data;
            }
        }
    }

    fn finish(&mut self, out: &mut Vec<Pins>) {
        out.extend(self.held.drain(..));
    }
}
