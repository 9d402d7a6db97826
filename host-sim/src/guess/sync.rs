//! Which reading of the sync wires is right.
//!
//! A reading is judged by what it makes of the trace: lines of one length, frames of one number of lines, data that
//! lives in the lines and rests between them (`gated`) or lives all the time (`marker`), a size that sensors have. Each judgement is in thousandths,
//! and a reading's score is their product.

use std::fmt;

use firmware::camif::pins::Sync;

use super::geometry;
use super::layout::{FrameLines, Line, Reading, frames};
use super::survey::Survey;
use crate::frequency::most_frequent;
use crate::profile::{Choice, SyncMode};

/// Longest marker, as a part of the line that it ends: longer pulses are blanking.
const MARKER_PART: u64 = 8;

/// A reading and what it makes of the trace.
#[derive(Clone, Debug)]
pub struct SyncGuess {
    /// The reading.
    pub reading: Reading,
    /// How much speaks for it, of 1000 in all.
    pub confidence: u32,
    /// How well it fits, of 1000, whatever the others do.
    pub score: u64,
    /// Samples a line.
    pub line_clocks: u64,
    /// Lines a frame.
    pub lines: u64,
    /// Clocks from the end of a line to the start of the next.
    pub hblank: u64,
    /// Clocks from the end of a frame's last line to the start of the next frame's first.
    pub vblank: u64,
    /// `gated`: clocks from the last line to VSYNC.
    pub vfront: u64,
    /// `gated`: clocks from VSYNC to the first line.
    pub vback: u64,
    /// The first whole frame with the usual lines, or else the best there is.
    pub frame: Vec<Line>,
    /// Frames of the usual shape that were seen.
    pub whole_frames: u64,
    /// What speaks for it, in numbers.
    pub evidence: String,
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = |high| if high { "high" } else { "low" };
        let kind = match self.mode {
            SyncMode::Gated => "blank",
            SyncMode::Marker => "active",
            SyncMode::Embedded => return f.write_str("embedded"),
        };
        let (hsync, vsync) = (level(self.hsync_high), level(self.vsync_high));
        write!(f, "{}, HSYNC {kind} {hsync}, VSYNC {kind} {vsync}", self.mode.name())
    }
}

/// The readings that make lines and frames of the trace, the most likely first.
#[must_use]
pub fn guess(survey: &Survey) -> Vec<SyncGuess> {
    let mut scored: Vec<(u64, SyncGuess)> =
        Reading::all().filter_map(|reading| judge(survey, reading)).filter(|(score, _)| *score > 0).collect();
    scored.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
    // The cube of a score: a reading that fits half as well is an eighth as likely.
    let weights: Vec<u64> = scored.iter().map(|(score, _)| score.pow(3) / 1_000_000).collect();
    let sum = weights.iter().sum::<u64>().max(1);
    let guesses = scored.into_iter().zip(weights).map(|((_, mut guess), weight)| {
        guess.confidence = (weight * 1000 / sum) as u32;
        guess
    });
    guesses.collect()
}

fn judge(survey: &Survey, reading: Reading) -> Option<(u64, SyncGuess)> {
    let frames = frames(survey, reading);
    let inner = |frame: &FrameLines| match frame.whole {
        true => frame.lines.clone(),
        // The outermost lines of a frame that was cut may be cut themselves.
        false => frame.lines.get(1..frame.lines.len().saturating_sub(1)).unwrap_or_default().to_vec(),
    };
    let lines: Vec<Line> = frames.iter().flat_map(inner).collect();
    let (line_clocks, regular) = most_frequent(lines.iter().map(|line| line.clocks))?;
    let whole: Vec<&FrameLines> = frames.iter().filter(|frame| frame.whole).collect();
    let counts: Vec<u64> = whole.iter().map(|frame| frame.lines.len() as u64).collect();
    let (height, even) = most_frequent(counts.iter().copied())?;
    if height < 2 || line_clocks < 2 {
        return None;
    }
    let regular = regular * 1000 / lines.len() as u64;
    let even_frames = even * 1000 / counts.len() as u64;
    let (data, data_words) = match reading.mode {
        SyncMode::Gated => gated_life(survey, reading),
        SyncMode::Marker => marker_life(survey, reading, line_clocks)?,
        SyncMode::Embedded => embedded_share(survey, &lines),
    };
    let quiet = match reading.mode {
        SyncMode::Gated => quiet_hsync(survey, reading),
        SyncMode::Marker | SyncMode::Embedded => 1000,
    };
    // A broken trace is irregular under every reading, so regularity counts, but nothing falls to 0 by it.
    let eased = |per_mille: u64| 200 + per_mille * 4 / 5;
    let score =
        [eased(regular), eased(even_frames), data, quiet, 300 + usual_size(line_clocks, height) * 7 / 10]
            .into_iter()
            .fold(1000, |score, factor| score * factor / 1000);
    let is_usual = |frame: &&&FrameLines| {
        frame.lines.len() as u64 == height && frame.lines.iter().all(|line| line.clocks == line_clocks)
    };
    let best = whole.iter().find(is_usual).or_else(|| whole.iter().max_by_key(|frame| frame.lines.len()))?;
    let vblanks = frames.windows(2).filter(|pair| pair.iter().all(|frame| frame.whole)).filter_map(|pair| {
        let [before, after] = pair else { return None };
        let (last, first) = (before.lines.last()?, after.lines.first()?);
        Some(first.start - (last.start + last.clocks))
    });
    let mut guess = SyncGuess {
        reading,
        confidence: 0,
        score,
        line_clocks,
        lines: height,
        hblank: most_frequent(best.lines.windows(2).map(gap)).map_or(0, |(gap, _)| gap),
        vblank: most_frequent(vblanks).map_or(0, |(gap, _)| gap),
        vfront: 0,
        vback: 0,
        frame: best.lines.clone(),
        whole_frames: even,
        evidence: format!(
            "{} of {} lines have {line_clocks} clocks, {even} of {} whole frames have {height} lines; {data_words}",
            regular * lines.len() as u64 / 1000,
            lines.len(),
            counts.len()
        ),
    };
    if reading.mode == SyncMode::Gated {
        let (first, last) = (best.lines.first()?, best.lines.last()?);
        guess.vback = first.start - best.opened;
        guess.vfront = best.closed - (last.start + last.clocks);
        if guess.vblank == 0 {
            // One frame only: what stands before it is as much as there is of VSYNC.
            let pulse = survey.runs.iter().filter(|run| run.sync.vsync == reading.vsync_high);
            guess.vblank = guess.vfront + guess.vback + pulse.map(|run| run.clocks).max().unwrap_or(1);
        }
    }
    if reading.mode == SyncMode::Embedded
        && guess.vblank == 0
        && let Some(first) = best.lines.first()
    {
        // One frame only: the blanking before it, its last code counted twice.
        guess.vblank = (first.start + guess.hblank).saturating_sub(4);
    }
    Some((score, guess))
}

fn gap(pair: &[Line]) -> u64 {
    match pair {
        [before, after] => after.start - (before.start + before.clocks),
        _ => 0,
    }
}

/// How usual the frame's size is, of 1000, at the number of samples a pixel that suits it best.
fn usual_size(line_clocks: u64, lines: u64) -> u64 {
    let side = |value: u64| u32::try_from(value).unwrap_or(u32::MAX);
    let widths = (1..=3).filter(|per_pixel| line_clocks.is_multiple_of(*per_pixel));
    widths.map(|per_pixel| geometry::usual(side(line_clocks / per_pixel), side(lines))).max().unwrap_or(0)
}

/// The pairs of levels under which the reading sees data, and the others.
fn split(survey: &Survey, is_data: impl Fn(Sync) -> bool) -> [(u64, u64); 2] {
    let mut parts = [(0, 0); 2];
    for (hsync, vsync) in [(false, false), (false, true), (true, false), (true, true)] {
        let sync = Sync { hsync, vsync };
        let life = survey.life(sync);
        let part = &mut parts[usize::from(is_data(sync))];
        *part = (part.0 + life.changes, part.1 + life.clocks);
    }
    parts
}

fn rate((changes, clocks): (u64, u64)) -> u64 {
    (changes * 1000).checked_div(clocks).unwrap_or(0)
}

/// Data lives where it is valid and rests where it is not.
fn gated_life(survey: &Survey, reading: Reading) -> (u64, String) {
    let [resting, living] =
        split(survey, |sync| sync.hsync != reading.hsync_high && sync.vsync != reading.vsync_high).map(rate);
    // Nothing moves at all: as good as it can be told.
    let share = (living * 1000).checked_div(living + resting).unwrap_or(500);
    (share, format!("data changes at {living} ‰ of the clocks in lines and {resting} ‰ outside"))
}

/// Data lives under the pulses of a marker as it does elsewhere; and a marker is short.
fn marker_life(survey: &Survey, reading: Reading, line_clocks: u64) -> Option<(u64, String)> {
    let [elsewhere, pulses] = split(survey, |sync| sync.hsync == reading.hsync_high);
    let longest = survey.runs.iter().filter(|run| run.sync.hsync == reading.hsync_high).map(|run| run.clocks);
    let usual_pulse = most_frequent(longest).map_or(0, |(clocks, _)| clocks);
    let [_, frame_pulses] = split(survey, |sync| sync.vsync == reading.vsync_high);
    if usual_pulse * MARKER_PART > line_clocks || frame_pulses.1 * 2 > survey.clocks {
        return None;
    }
    let (inside, outside) = (rate(pulses), rate(elsewhere));
    let alike = (inside * 2000).checked_div(inside + outside).unwrap_or(500).min(1000);
    // The first column of a picture may well be plain.
    let share = 700 + alike * 3 / 10;
    let words = format!("data changes at {inside} ‰ of the clocks under HSYNC and {outside} ‰ elsewhere");
    Some((share, words))
}

/// Codes bound the lines, and the sync wires rest.
fn embedded_share(survey: &Survey, lines: &[Line]) -> (u64, String) {
    let rests = survey.runs.len() <= 1;
    let covered: u64 = lines.iter().map(|line| line.clocks).sum();
    let share = (covered * 1000).checked_div(survey.clocks).unwrap_or(0);
    let codes = survey.codes.len();
    // By accident FF 00 00 XY comes once in 500 million samples; data full of pure red has many FF 00 00.
    let score = if rests { 1000 } else { share.min(900) };
    (score, format!("{codes} codes, and the sync wires {}", if rests { "rest" } else { "move" }))
}

/// HSYNC rests at its blanking level while VSYNC blanks, or runs on; the other way about speaks against the reading.
fn quiet_hsync(survey: &Survey, reading: Reading) -> u64 {
    let clocks = |hsync| survey.life(Sync { hsync, vsync: reading.vsync_high }).clocks;
    let (blank, valid) = (clocks(reading.hsync_high), clocks(!reading.hsync_high));
    let share = (blank * 1000).checked_div(blank + valid).unwrap_or(500);
    500 + share / 2
}

#[cfg(test)]
mod tests {
    use firmware::camif::pins::Samples;
    use firmware::trace::StretchSink as _;

    use super::*;

    /// `H` and `V` are high; each letter of the data is its own value, `-` is the bus at rest.
    fn survey(rows: [&str; 3], times: usize) -> Survey {
        let mut survey = Survey::default();
        let [hsync, vsync, data] = rows.map(|row| row.repeat(times).into_bytes());
        for ((h, v), data) in hsync.iter().zip(&vsync).zip(&data) {
            let sync = Sync { hsync: *h == b'H', vsync: *v == b'V' };
            let value = if *data == b'-' { 0 } else { u16::from(*data) };
            survey.stretch(sync, Samples::Repeat { value, clocks: 1 }).unwrap();
        }
        survey
    }

    fn first(rows: [&str; 3]) -> (String, u64, u64, u32) {
        let best = guess(&survey(rows, 4)).swap_remove(0);
        (best.reading.to_string(), best.line_clocks, best.lines, best.confidence)
    }

    #[test]
    fn polarity_is_where_data_lives() {
        let (reading, clocks, lines, confidence) = first([
            "....HHHHHHH..HHHHHHH..HHHHHHH....", //
            "VV...............................",
            "----abcdefg--hijklmn--opqrstu----",
        ]);
        assert_eq!(reading, "gated, HSYNC blank low, VSYNC blank high");
        assert_eq!((clocks, lines), (7, 3));
        assert!(confidence > 800, "{confidence}");
        let (reading, clocks, lines, _) = first([
            "HHHH.......HH.......HH.......HHHH", //
            "..VVVVVVVVVVVVVVVVVVVVVVVVVVVVVVV",
            "----abcdefg--hijklmn--opqrstu----",
        ]);
        assert_eq!((reading.as_str(), clocks, lines), ("gated, HSYNC blank high, VSYNC blank low", 7, 3));
    }

    #[test]
    fn data_that_never_rests_means_markers() {
        let (reading, clocks, lines, confidence) = first([
            "H........H........H........", //
            "V..........................",
            "abcdefghijklmnopqrstuvwxyz!",
        ]);
        assert_eq!((reading.as_str(), clocks, lines), ("marker, HSYNC active high, VSYNC active high", 9, 3));
        assert!(confidence > 350, "{confidence}");
    }

    #[test]
    fn porches_and_blanking_are_measured() {
        let rows = [
            "......HHHHHHH...HHHHHHH....", //
            "..VV.......................",
            "------abcdefg---hijklmn----",
        ];
        let best = guess(&survey(rows, 4)).swap_remove(0);
        assert_eq!((best.hblank, best.vblank, best.vfront, best.vback), (3, 10, 6, 2));
    }

    #[test]
    fn wires_that_never_move_give_nothing() {
        assert!(guess(&survey(["....", "....", "abcd"], 9)).is_empty());
    }
}
