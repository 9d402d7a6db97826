//! Frames and lines as the sync wires, or the codes, cut them.
//!
//! ```text
//! gated     VSYNC  ‾‾‾|___________________________|‾‾‾      pulse ─ frame ─ pulse
//!           HSYNC  ‾‾‾‾‾|____|‾|____|‾|____|‾‾‾‾‾‾‾‾        line, gap, line, gap, line
//! ```

use super::recording::Recording;
use crate::profile::{Profile, SyncMode};

/// A line as it was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// Its first sample's clock.
    pub(super) start: usize,
    /// Its samples.
    pub(super) length: usize,
}

impl Line {
    /// The clock after its last sample.
    pub(super) fn end(&self) -> usize {
        self.start + self.length
    }
}

/// A frame as it was cut.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Frame {
    /// The clock at which data may begin.
    pub(super) start: usize,
    /// The clock at which it ended.
    pub(super) end: usize,
    /// Lines with data.
    pub(super) lines: Vec<Line>,
    /// Clocks of VSYNC at its blanking level, or of lines of blanking, before the frame; nothing if not seen whole.
    pub(super) pulse_before: Option<usize>,
    /// The frame began, or ended, within a line.
    pub(super) torn: (bool, bool),
}

/// All of a recording.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    /// Frames that ended.
    pub(super) frames: Vec<Frame>,
    /// The frame that the recording breaks off in, if it has lines.
    pub(super) open: Option<Frame>,
    /// Clocks of each pulse of VSYNC, or of lines of blanking.
    pub(super) pulses: Vec<usize>,
    /// Codes found, embedded sync only.
    pub(super) codes: usize,
}

/// What stands for a code: prefix of three bytes, then start and end of a line of picture and of blanking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Codes {
    prefix: [u16; 3],
    start: u16,
    end: u16,
    blank: [u16; 2],
    /// Any other code is one of blanking; behind wrong wires it is what data happens to look like.
    others: bool,
}

impl Codes {
    /// The codes of BT.656 as they look behind these wires.
    pub(super) fn behind(wires: impl Fn(u16) -> u16) -> Self {
        Self {
            prefix: [0xFF, 0, 0].map(&wires),
            start: wires(0x80),
            end: wires(0x9D),
            blank: [0xAB, 0xB6].map(&wires),
            others: wires(0xFF) == 0xFF && wires(0x80) == 0x80,
        }
    }

    /// They can be told from one another.
    pub(super) fn are_distinct(&self) -> bool {
        let Self { prefix, start, end, blank, .. } = *self;
        prefix[0] != prefix[1] && start != end && !blank.contains(&start) && !blank.contains(&end)
    }
}

impl Shape {
    /// The frames by this profile.
    pub(super) fn of(recording: &Recording, profile: &Profile) -> Self {
        match profile.bus.sync {
            SyncMode::Gated => gated(recording, profile),
            SyncMode::Marker => marker(recording, profile),
            SyncMode::Embedded => Self::by_codes(recording, &Codes::behind(|byte| byte)),
        }
    }

    /// The frames by sync codes.
    pub(super) fn by_codes(recording: &Recording, codes: &Codes) -> Self {
        let samples = &recording.samples;
        let mut shape = Self::default();
        let (mut frame, mut line) = (Frame::default(), None::<usize>);
        let mut blank_from = None::<usize>;
        let mut at = 0;
        while at + 3 < samples.len() {
            if samples[at..at + 3] != codes.prefix {
                at += 1;
                continue;
            }
            let (code, here) = (samples[at + 3], at);
            if !codes.others && ![codes.start, codes.end, codes.blank[0], codes.blank[1]].contains(&code) {
                at += 1;
                continue;
            }
            at += 4;
            if let Some(start) = line.take() {
                frame.lines.push(Line { start, length: here - start });
            }
            shape.codes += 1;
            if code == codes.start {
                if let Some(from) = blank_from.take() {
                    shape.pulses.push(here - from);
                    frame.pulse_before = Some(here - from);
                    frame.start = here;
                }
                line = Some(at);
            } else if code != codes.end {
                blank_from.get_or_insert(here);
                if !frame.lines.is_empty() {
                    frame.end = here;
                    let last = frame.lines.last().copied();
                    // A frame that ends by the code of a line's end was in its middle of a line.
                    frame.torn.1 = last.is_some_and(|last| last.end() == here);
                    shape.frames.push(std::mem::take(&mut frame));
                }
            }
        }
        shape.open = (!frame.lines.is_empty()).then_some(frame);
        shape
    }

    /// Every line of every frame.
    pub(super) fn lines(&self) -> impl Iterator<Item = &Line> {
        self.frames.iter().chain(&self.open).flat_map(|frame| &frame.lines)
    }

    /// The share of frames and lines that are as the profile says, 0 to 1.
    pub(super) fn fit(&self, profile: &Profile) -> f64 {
        let (samples, height) = (profile.samples_per_line() as usize, profile.frame.height as usize);
        let (mut good, mut all) = (0, 0);
        for frame in &self.frames {
            let lines = frame.lines.iter().filter(|line| line.length == samples).count();
            good += lines.min(height);
            all += frame.lines.len().max(height);
        }
        if all == 0 { 0.0 } else { good as f64 / all as f64 }
    }
}

fn gated(recording: &Recording, profile: &Profile) -> Shape {
    let (hsync, vsync) = (profile.bus.hsync_blank.is_high(), profile.bus.vsync_blank.is_high());
    let mut shape = Shape::default();
    let mut frame = None::<Frame>;
    // Runs are cut at every edge of either wire; a pulse is all runs with VSYNC in blanking.
    let mut pulse = None::<(usize, bool)>;
    let (mut data_before, mut valid_before) = (false, false);
    for (index, run) in recording.runs.iter().enumerate() {
        let in_line = run.sync.hsync != hsync;
        if run.sync.vsync == vsync {
            if let Some(mut ended) = frame.take() {
                ended.end = run.start;
                ended.torn.1 = data_before && in_line;
                shape.frames.push(ended);
            }
            let (length, whole) = pulse.unwrap_or((0, index > 0));
            pulse = Some((length + run.length, whole));
            (data_before, valid_before) = (false, in_line);
            continue;
        }
        if let Some((length, whole)) = pulse.take() {
            let pulse_before = whole.then_some(length);
            shape.pulses.extend(pulse_before);
            frame = Some(Frame {
                start: run.start,
                pulse_before,
                torn: (in_line && valid_before, false),
                ..Frame::default()
            });
        }
        data_before = in_line;
        if let (true, Some(frame)) = (in_line, &mut frame) {
            frame.lines.push(Line { start: run.start, length: run.length });
        }
    }
    shape.open = frame.filter(|frame| !frame.lines.is_empty());
    shape
}

fn marker(recording: &Recording, profile: &Profile) -> Shape {
    let (hsync, vsync) = (profile.bus.hsync_blank.is_high(), profile.bus.vsync_blank.is_high());
    let mut shape = Shape::default();
    let mut frame = Frame::default();
    let (mut line, mut before) = (0, (false, false));
    for (index, run) in recording.runs.iter().enumerate() {
        let now = (run.sync.hsync == hsync, run.sync.vsync == vsync);
        let edges = (now.0 && !before.0 && index > 0, now.1 && !before.1 && index > 0);
        before = now;
        if now.1 {
            shape.pulses.push(run.length);
        }
        if edges.0 && run.start > line {
            frame.lines.push(Line { start: line, length: run.start - line });
            line = run.start;
        }
        if edges.1 {
            let torn = !edges.0;
            if torn && run.start > line {
                frame.lines.push(Line { start: line, length: run.start - line });
                line = run.start;
            }
            frame.end = run.start;
            frame.torn.1 = torn;
            shape.frames.push(std::mem::take(&mut frame));
            (frame.start, frame.torn.0) = (run.start, torn);
        }
    }
    let end = recording.samples.len();
    if end > line + 1 {
        frame.lines.push(Line { start: line, length: end - line });
    }
    shape.open = (!frame.lines.is_empty()).then_some(frame);
    shape
}
