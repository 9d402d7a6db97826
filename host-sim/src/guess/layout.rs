//! Where lines and frames lie in a trace, under a reading of its sync wires.
//!
//! ```text
//! reading: gated, blank high           HSYNC  ‾‾____‾‾____‾‾      lines at 2 and 8, 4 clocks each
//! reading: marker, active high         HSYNC  ___‾_____‾____      a line ends before each rise
//! reading: embedded                    data   FF 00 00 80 …line… FF 00 00 9D
//! ```

use super::survey::{Run, Survey};
use crate::profile::SyncMode;

/// One way to read the sync wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// How lines and frames are told apart.
    pub mode: SyncMode,
    /// `gated`: HSYNC's blanking level is high; `marker`: its active level is.
    pub hsync_high: bool,
    /// The same for VSYNC.
    pub vsync_high: bool,
}

impl Reading {
    /// All nine; the levels mean nothing to `embedded`.
    pub fn all() -> impl Iterator<Item = Self> {
        let levels = [(true, true), (false, true), (true, false), (false, false)];
        let wires = [SyncMode::Gated, SyncMode::Marker].into_iter().flat_map(move |mode| {
            levels.map(|(hsync_high, vsync_high)| Self { mode, hsync_high, vsync_high })
        });
        wires.chain([Self { mode: SyncMode::Embedded, hsync_high: true, vsync_high: true }])
    }
}

/// Clocks that carry data of one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Number of its first clock.
    pub start: u64,
    /// Its length in pixel clocks.
    pub clocks: u64,
}

/// The lines between two frame borders.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameLines {
    /// In the order of time.
    pub lines: Vec<Line>,
    /// Both borders were seen, so no line is missing.
    pub whole: bool,
    /// Number of the clock at which VSYNC left its blanking level before the first line (`gated`).
    pub opened: u64,
    /// Number of the clock at which VSYNC took its blanking level after the last line (`gated`).
    pub closed: u64,
}

/// The frames of a trace, those without a line left out.
#[must_use]
pub fn frames(survey: &Survey, reading: Reading) -> Vec<FrameLines> {
    let mut frames = match reading.mode {
        SyncMode::Gated => gated(&survey.runs, reading),
        SyncMode::Marker => marker(&survey.runs, reading, survey.clocks),
        SyncMode::Embedded => embedded(survey),
    };
    frames.retain(|frame| !frame.lines.is_empty());
    frames
}

fn gated(runs: &[Run], reading: Reading) -> Vec<FrameLines> {
    let mut frames = Vec::new();
    let mut frame = FrameLines::default();
    let mut seen_blank = false;
    for run in runs {
        if run.sync.vsync == reading.vsync_high {
            if !frame.lines.is_empty() {
                frame.closed = run.start;
                frame.whole = seen_blank;
                frames.push(std::mem::take(&mut frame));
            }
            seen_blank = true;
            frame.opened = run.start + run.clocks;
        } else if run.sync.hsync != reading.hsync_high {
            frame.lines.push(Line { start: run.start, clocks: run.clocks });
        }
    }
    frames.push(frame);
    frames
}

/// A line ends before each clock at which HSYNC becomes active, a frame where VSYNC does.
fn marker(runs: &[Run], reading: Reading, clocks: u64) -> Vec<FrameLines> {
    let mut frames = Vec::new();
    // Nothing ended before the first clock of a stream, so it may well be a frame's first.
    let mut frame = FrameLines { whole: true, ..FrameLines::default() };
    let (mut start, mut before) = (0, None);
    for run in runs {
        let active = (run.sync.hsync == reading.hsync_high, run.sync.vsync == reading.vsync_high);
        let (was_h, was_v) = before.unwrap_or((true, true));
        if active.0 && !was_h {
            frame.lines.push(Line { start, clocks: run.start - start });
            start = run.start;
        }
        if active.1 && !was_v {
            frames.push(std::mem::replace(&mut frame, FrameLines { whole: true, ..FrameLines::default() }));
        }
        before = Some(active);
    }
    // The idle clock that closes the stream is no line.
    if clocks > start + 1 {
        frame.lines.push(Line { start, clocks: clocks - start });
    }
    frame.whole = false;
    frames.push(frame);
    frames
}

/// From the code that starts a line of picture to the next code that ends one.
fn embedded(survey: &Survey) -> Vec<FrameLines> {
    let mut frames = Vec::new();
    let mut frame = FrameLines::default();
    let (mut open, mut seen_blank) = (None, false);
    for code in &survey.codes {
        if code.blank {
            if !frame.lines.is_empty() {
                frame.whole = seen_blank;
                frames.push(std::mem::take(&mut frame));
            }
            (open, seen_blank) = (None, true);
        } else if !code.ends {
            open = Some(code.start + 4);
        } else if let Some(start) = open.take() {
            frame.lines.push(Line { start, clocks: code.start - start });
        }
    }
    frames.push(frame);
    frames
}

#[cfg(test)]
mod tests {
    use firmware::camif::pins::{Samples, Sync};
    use firmware::trace::StretchSink as _;

    use super::*;

    /// `H` and `V` are high, `.` low; a character a clock.
    fn survey(hsync: &str, vsync: &str) -> Survey {
        let mut survey = Survey::default();
        for (h, v) in hsync.bytes().zip(vsync.bytes()) {
            let sync = Sync { hsync: h == b'H', vsync: v == b'V' };
            survey.stretch(sync, Samples::Repeat { value: 0, clocks: 1 }).unwrap();
        }
        survey
    }

    fn shape(frames: &[FrameLines]) -> Vec<(bool, Vec<(u64, u64)>)> {
        let lines = |frame: &FrameLines| frame.lines.iter().map(|line| (line.start, line.clocks)).collect();
        frames.iter().map(|frame| (frame.whole, lines(frame))).collect()
    }

    #[test]
    fn gated_lines_lie_between_blanking() {
        let survey = survey(
            "..HHHH....HH....HHHHHH....H", //
            ".VVV.............VV........",
        );
        let reading = Reading { mode: SyncMode::Gated, hsync_high: true, vsync_high: true };
        let frames = frames(&survey, reading);
        let expected = [(false, vec![(0, 1)]), (true, vec![(6, 4), (12, 4)]), (false, vec![(22, 4)])];
        assert_eq!(shape(&frames), expected);
        assert_eq!((frames[1].opened, frames[1].closed), (4, 17));
    }

    #[test]
    fn markers_end_lines() {
        let survey = survey(
            "....H...H...H...H", //
            "........V.......V",
        );
        let reading = Reading { mode: SyncMode::Marker, hsync_high: true, vsync_high: true };
        let expected = [(true, vec![(0, 4), (4, 4)]), (true, vec![(8, 4), (12, 4)])];
        assert_eq!(shape(&frames(&survey, reading)), expected);
    }

    #[test]
    fn codes_bound_lines() {
        let mut survey = Survey::default();
        let blank = [0xFF, 0, 0, 0xAB, 1, 1, 0xFF, 0, 0, 0xB6];
        let line = [0xFF, 0, 0, 0x80, 7, 8, 9, 0xFF, 0, 0, 0x9D];
        for part in [&blank[..], &line, &line, &blank, &line] {
            survey.stretch(Sync::default(), Samples::Bytes(part)).unwrap();
        }
        let reading = Reading { mode: SyncMode::Embedded, hsync_high: true, vsync_high: true };
        let expected = [(true, vec![(14, 3), (25, 3)]), (false, vec![(46, 3)])];
        assert_eq!(shape(&frames(&survey, reading)), expected);
    }
}
