use super::recording::Recording;
use super::shape::{Frame, Shape};
use crate::profile::Profile;

/// A line of a trace as sync cuts it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutLine {
    /// The pixel clock of its first sample.
    pub start: u64,
    /// Its samples.
    pub samples: u64,
}

/// A frame of a trace as sync cuts it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CutFrame {
    /// The pixel clock after its last one; nothing for the frame that the trace breaks off in.
    pub end: Option<u64>,
    /// Its lines with data, in order.
    pub lines: Vec<CutLine>,
}

/// The frames of a recording by a profile, in order, the one that it breaks off in included.
#[must_use]
pub fn cut(recording: &Recording, profile: &Profile) -> Vec<CutFrame> {
    let Shape { frames, open, .. } = Shape::of(recording, profile);
    let lines = |frame: &Frame| {
        frame
            .lines
            .iter()
            .map(|line| CutLine { start: line.start as u64, samples: line.length as u64 })
            .collect()
    };
    let whole = frames.iter().map(|frame| CutFrame { end: Some(frame.end as u64), lines: lines(frame) });
    whole.chain(open.iter().map(|frame| CutFrame { end: None, lines: lines(frame) })).collect()
}
