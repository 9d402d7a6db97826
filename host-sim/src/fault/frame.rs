//! Another format, another mosaic: the picture stays, and what the wires carry of it changes.
//!
//! A frame is held back until it is whole, so memory is a frame's clocks.

use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Pins;

use super::inject::Fault;
use super::kind::FaultKind;
use super::place::{Part, Place};
use super::spec::FaultSpec;
use crate::picture;
use crate::profile::{Choice, Profile, SyncMode};
use crate::sensor::make_code_free;

pub(super) fn make(spec: &FaultSpec, profile: &Profile) -> Box<dyn Fault> {
    let change = match spec.kind {
        FaultKind::FormatMismatch => {
            let mut sent = profile.clone();
            sent.frame.format =
                <Format as Choice>::from_name(spec.word("sent")).unwrap_or(profile.frame.format);
            Change::Format(sent)
        }
        FaultKind::BayerPhase => match spec.word("by") {
            "column" => Change::Phase(1, 0),
            "row" => Change::Phase(0, 1),
            _ => Change::Phase(1, 1),
        },
        _ => Change::RedBlue,
    };
    Box::new(Whole { profile: profile.clone(), change, frame: 0, held: Vec::new(), lines: Vec::new() })
}

enum Change {
    Format(Profile),
    Phase(usize, usize),
    RedBlue,
}

struct Whole {
    profile: Profile,
    change: Change,
    frame: u64,
    held: Vec<(Place, Pins)>,
    /// The samples of the frame's lines.
    lines: Vec<Vec<u16>>,
}

impl Fault for Whole {
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>) {
        if place.frame != self.frame {
            self.frame = place.frame;
            self.release(out);
        }
        if place.part == Part::Data && place.line < self.profile.frame.height {
            let line = place.line as usize;
            if self.lines.len() <= line {
                self.lines.resize(line + 1, Vec::new());
            }
            self.lines[line].push(pins.data);
        }
        self.held.push((*place, pins));
    }

    fn finish(&mut self, out: &mut Vec<Pins>) {
        self.release(out);
    }
}

impl Whole {
    /// Gives out the held frame, changed if it is whole.
    fn release(&mut self, out: &mut Vec<Pins>) {
        let lines = std::mem::take(&mut self.lines);
        let held = std::mem::take(&mut self.held);
        let samples = self.profile.samples_per_line() as usize;
        let whole = lines.len() == self.profile.frame.height as usize
            && lines.iter().all(|line| line.len() >= samples);
        if !whole {
            return out.extend(held.into_iter().map(|(_, pins)| pins));
        }
        let made = self.change(lines);
        let length = made.first().map_or(0, Vec::len);
        let mut next = held.iter().skip(1);
        for (place, pins) in &held {
            let sync_after = next.next().map_or(pins.sync, |(_, pins)| pins.sync);
            let line = made.get(place.line as usize).filter(|_| place.part == Part::Data);
            match line {
                Some(line) if length == samples => {
                    out.push(Pins { data: line.get(place.column as usize).copied().unwrap_or(0), ..*pins });
                }
                // A line of another length comes whole at its first clock; a marker stands there alone.
                Some(line) if place.column == 0 => {
                    out.push(Pins { data: line[0], ..*pins });
                    out.extend(line[1..].iter().map(|&data| Pins { sync: sync_after, data }));
                }
                Some(_) => {}
                None => out.push(*pins),
            }
        }
    }

    fn change(&self, mut lines: Vec<Vec<u16>>) -> Vec<Vec<u16>> {
        let (width, height) = (lines[0].len(), lines.len());
        match &self.change {
            Change::Phase(across, down) => {
                // The edge takes the sample two back, which has its colour.
                let within = |at: usize, end: usize| if at < end { at } else { end.saturating_sub(2) };
                let source = lines.clone();
                for (y, line) in lines.iter_mut().enumerate() {
                    for (x, sample) in line.iter_mut().enumerate() {
                        *sample = source[within(y + down, height)][within(x + across, width)];
                    }
                }
                lines
            }
            Change::RedBlue => {
                let mut picture = picture::decode(&bytes_of(&lines, &self.profile), &self.profile).picture;
                picture.pixels_mut().for_each(|pixel| pixel.0.swap(0, 2));
                self.encoded(&picture, &self.profile).unwrap_or(lines)
            }
            Change::Format(sent) => {
                let picture = picture::decode(&bytes_of(&lines, &self.profile), &self.profile).picture;
                self.encoded(&picture, sent).unwrap_or(lines)
            }
        }
    }

    fn encoded(&self, picture: &image::RgbImage, profile: &Profile) -> Option<Vec<Vec<u16>>> {
        let mut bytes = picture::encode(picture, profile).ok()?;
        if self.profile.bus.sync == SyncMode::Embedded {
            make_code_free(&mut bytes);
        }
        let line = (profile.bytes_per_line() as usize).max(1);
        Some(bytes.chunks(line).map(|line| samples_of(line, profile)).collect())
    }
}

/// The samples of a line as DMA wrote it.
pub(crate) fn samples_of(bytes: &[u8], profile: &Profile) -> Vec<u16> {
    if profile.bus.bits == 8 {
        return bytes.iter().map(|&byte| u16::from(byte)).collect();
    }
    bytes.as_chunks::<2>().0.iter().map(|pair| u16::from_le_bytes(*pair)).collect()
}

/// Lines of samples as DMA writes them, each cut or padded to the profile's length.
pub(crate) fn bytes_of(lines: &[Vec<u16>], profile: &Profile) -> Vec<u8> {
    let samples = profile.samples_per_line() as usize;
    let mut bytes = Vec::with_capacity(profile.bytes_per_frame() as usize);
    for line in lines {
        let padded = line.iter().copied().chain(std::iter::repeat(0)).take(samples);
        if profile.bus.bits == 8 {
            bytes.extend(padded.map(|sample| sample as u8));
        } else {
            bytes.extend(padded.flat_map(u16::to_le_bytes));
        }
    }
    bytes
}
