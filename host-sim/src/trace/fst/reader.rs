//! An FST file as levels: a section at a time, the chains of the wanted signals merged in time.
//!
//! ```text
//! index of the time   0   1   2   3   4   5        a window of the section's table of times
//! chain of PCLK       1   0   1   0   1   0        each chain is followed through the window alone,
//! chain of D0         0           1                and leaves what it sets and clears at its times;
//! edits               ↓   ↓   ↓   ↓   ↓   ↓        then the window is played
//! ```

use std::io::{Read, Seek};

use super::super::PlayError;
use super::super::capture::About;
use super::super::levels::{LevelSink, LevelsPlayed};
use super::super::wiring::Tap;
use super::bytes::Bytes;
use super::error::{FstError, FstProblem};
use super::header::{self, Contents, block};
use super::section;

/// An FST file whose geometry and hierarchy are read.
#[derive(Debug)]
pub struct FstFile<R> {
    file: R,
    contents: Contents,
}

/// A wanted handle: the bits of its value, lowest first, and the bits of the state that they set.
struct Wanted {
    handle: usize,
    width: u32,
    taps: Vec<(u32, u64)>,
    /// Characters of the frame before it.
    frame_at: usize,
}

/// A chain on its way.
struct Lane<'a> {
    wanted: &'a Wanted,
    bytes: Bytes<'a>,
    /// The next change: the index of its time, and the number that begins it.
    next: Option<(usize, u64)>,
}

/// What changes at a time: bits of the state that are cleared, then bits that are set.
#[derive(Clone, Copy, Default)]
struct Edit {
    clear: u64,
    set: u64,
}

/// Times that are merged at once; their edits stay in a core's cache.
const WINDOW: usize = 1 << 13;

impl<R: Read + Seek> FstFile<R> {
    /// Reads geometry and hierarchy.
    ///
    /// # Errors
    /// If the file cannot be read, is malformed, or has not been finished.
    pub fn new(mut file: R) -> Result<Self, FstError> {
        let contents = header::read(&mut file)?;
        Ok(Self { file, contents })
    }

    pub(in super::super) fn about(&self) -> About {
        About {
            signals: self.contents.signals.clone(),
            ticks_per_second: Some(10_f64.powi(-i32::from(self.contents.exponent))),
            sample_rate: None,
            sampled: false,
        }
    }

    /// Plays the levels of the taps.
    ///
    /// # Errors
    /// If a section is malformed, or the sink's.
    pub fn play<S: LevelSink>(
        &mut self,
        wires: &[(Tap, u64)],
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<LevelsPlayed, PlayError<FstError, S::Error>> {
        let wanted = self.wanted(wires);
        let handles: Vec<usize> = wanted.iter().map(|wanted| wanted.handle).collect();
        let watched = sink.watched();
        let (mut played, mut state, mut told) = (LevelsPlayed::default(), 0, None);
        let mut edits = vec![Edit::default(); WINDOW];
        for place in self.contents.sections.clone() {
            let wrong = |problem| PlayError::Trace(block(place.offset, problem));
            let section = section::read(&mut self.file, place, self.contents.widths.len(), &handles);
            let section = section.map_err(PlayError::Trace)?;
            if told.is_none() {
                for wanted in &wanted {
                    let bits = section.frame.get(wanted.frame_at..wanted.frame_at + wanted.width as usize);
                    let bits = bits.ok_or_else(|| wrong(FstProblem::Wrong("frame")))?;
                    let mut begun = Edit::default();
                    begun.value(
                        wanted,
                        |bit| level(bits[bits.len() - 1 - bit as usize]),
                        &mut played.unknown,
                    );
                    state = state & !begun.clear | begun.set;
                }
                // Changes at the very beginning belong to how the signals stand.
                if section.times.first().is_none_or(|&first| first > section.begin) {
                    sink.levels(section.begin, state).map_err(PlayError::Sink)?;
                    told = Some(state);
                }
                played.end = section.begin;
            }
            let mut lanes = Vec::with_capacity(wanted.len());
            for (wanted, chain) in wanted.iter().zip(&section.chains) {
                let mut lane = Lane { wanted, bytes: Bytes(chain), next: None };
                lane.advance(0).map_err(wrong)?;
                lanes.push(lane);
            }
            for (number, times) in section.times.chunks(WINDOW).enumerate() {
                let edits = edits.get_mut(..times.len()).unwrap_or_default();
                edits.fill(Edit::default());
                for lane in &mut lanes {
                    lane.follow(number * WINDOW, edits, &mut played.unknown).map_err(wrong)?;
                }
                for (&time, edit) in times.iter().zip(&*edits) {
                    if edit.clear | edit.set == 0 {
                        continue;
                    }
                    if time < played.end {
                        return Err(wrong(FstProblem::Backwards { from: played.end, to: time }));
                    }
                    state = state & !edit.clear | edit.set;
                    played.end = time;
                    if told.is_none_or(|told: u64| (told ^ state) & watched != 0) {
                        sink.levels(time, state).map_err(PlayError::Sink)?;
                        told = Some(state);
                    }
                }
            }
            if lanes.iter().any(|lane| lane.next.is_some()) {
                return Err(wrong(FstProblem::Wrong("chain")));
            }
            progress(place.offset + place.length);
        }
        Ok(played)
    }

    fn wanted(&self, wires: &[(Tap, u64)]) -> Vec<Wanted> {
        let mut all: Vec<Wanted> = Vec::new();
        for (tap, state) in wires {
            let Some(&handle) = self.contents.handles.get(tap.signal) else { continue };
            let Some(&Some(width)) = self.contents.widths.get(handle) else { continue };
            if tap.bit >= width {
                continue;
            }
            match all.iter_mut().find(|wanted| wanted.handle == handle) {
                Some(wanted) => wanted.taps.push((tap.bit, *state)),
                None => {
                    // A real number takes eight bytes of a frame.
                    let before = self.contents.widths.iter().take(handle);
                    let frame_at = before.map(|width| width.map_or(8, |width| width as usize)).sum();
                    all.push(Wanted { handle, width, taps: vec![(tap.bit, *state)], frame_at });
                }
            }
        }
        all
    }
}

/// What a character says of a bit: known and what, or unknown.
fn level(character: u8) -> Option<bool> {
    match character {
        b'0' | b'l' | b'L' => Some(false),
        b'1' | b'h' | b'H' => Some(true),
        _ => None,
    }
}

impl Edit {
    /// A signal has these bits; of several values at one time the last one counts.
    #[inline]
    fn value(&mut self, wanted: &Wanted, bit: impl Fn(u32) -> Option<bool>, unknown: &mut u64) {
        for &(place, bits) in &wanted.taps {
            let found = bit(place);
            *unknown += u64::from(found.is_none());
            if found.unwrap_or(false) {
                self.set |= bits;
            } else {
                self.set &= !bits;
                self.clear |= bits;
            }
        }
    }
}

impl Lane<'_> {
    /// Takes the changes at the times of a window, which begins at this index.
    fn follow(&mut self, first: usize, window: &mut [Edit], unknown: &mut u64) -> Result<(), FstProblem> {
        while let Some((next, number)) = self.next {
            let Some(edit) = window.get_mut(next - first) else { break };
            self.take(number, edit, unknown)?;
            self.advance(next)?;
        }
        Ok(())
    }

    /// Reads how far ahead of the time with index `now` the next change is.
    #[inline]
    fn advance(&mut self, now: usize) -> Result<(), FstProblem> {
        if self.bytes.is_empty() {
            self.next = None;
            return Ok(());
        }
        let number = self.bytes.number()?;
        let ahead = match (self.wanted.width, number & 1) {
            (1, 0) => number >> 2,
            (1, _) => number >> 4,
            _ => number >> 1,
        };
        let next = usize::try_from(ahead).ok().and_then(|ahead| now.checked_add(ahead));
        self.next = Some((next.ok_or(FstProblem::Wrong("chain"))?, number));
        Ok(())
    }

    /// Takes the change that begins with `number`.
    #[inline]
    fn take(&mut self, number: u64, edit: &mut Edit, unknown: &mut u64) -> Result<(), FstProblem> {
        let wanted = self.wanted;
        if wanted.width == 1 {
            let character = match number & 1 {
                0 => b'0' + (number >> 1 & 1) as u8,
                _ => b"xzhuwl-?"[(number >> 1 & 7) as usize],
            };
            edit.value(wanted, |_| level(character), unknown);
            return Ok(());
        }
        let width = wanted.width as usize;
        if number & 1 == 0 {
            // Packed, the highest bit first.
            let bytes = self.bytes.take(width.div_ceil(8))?;
            let bit = |bit: u32| {
                let at = width - 1 - bit as usize;
                Some(bytes[at / 8] >> (7 - at % 8) & 1 == 1)
            };
            edit.value(wanted, bit, unknown);
        } else {
            let bits = self.bytes.take(width)?;
            edit.value(wanted, |bit| level(bits[width - 1 - bit as usize]), unknown);
        }
        Ok(())
    }
}
