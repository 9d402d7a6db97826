//! Samples of chosen clocks out of a trace.

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::layout::Line;
use crate::trace::polarity::Enough;

/// Collects the samples of lines that stand in the order of time and do not overlap.
#[derive(Clone, Debug)]
pub(super) struct Windows<'a> {
    lines: &'a [Line],
    /// Number of the next clock.
    clock: u64,
    /// The samples so far, line after line.
    pub(super) samples: Vec<u16>,
}

impl<'a> Windows<'a> {
    /// Nothing collected yet.
    #[must_use]
    pub(super) fn new(lines: &'a [Line]) -> Self {
        Self { lines, clock: 0, samples: Vec::new() }
    }
}

impl StretchSink for Windows<'_> {
    type Error = Enough;

    fn stretch(&mut self, _: Sync, samples: Samples<'_>) -> Result<(), Enough> {
        let end = self.clock + samples.len() as u64;
        while let Some((line, later)) = self.lines.split_first() {
            let (from, to) = (line.start.max(self.clock), (line.start + line.clocks).min(end));
            if from < to {
                let part = samples.skip((from - self.clock) as usize).take((to - from) as usize);
                match part {
                    Samples::Words(words) => self.samples.extend(words),
                    Samples::Bytes(bytes) => self.samples.extend(bytes.iter().map(|&byte| u16::from(byte))),
                    Samples::Repeat { value, clocks } => {
                        self.samples.extend(std::iter::repeat_n(value, clocks as usize));
                    }
                }
            }
            if line.start + line.clocks > end {
                break;
            }
            self.lines = later;
        }
        self.clock = end;
        if self.lines.is_empty() { Err(Enough) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_out_of_whatever_stretches_there_are() {
        let data: Vec<u8> = (0..40).collect();
        let lines =
            [Line { start: 3, clocks: 4 }, Line { start: 7, clocks: 2 }, Line { start: 20, clocks: 10 }];
        for size in [1, 3, 7, 40] {
            let mut windows = Windows::new(&lines);
            let ended = data.chunks(size).map(|part| windows.stretch(Sync::default(), Samples::Bytes(part)));
            assert!(ended.into_iter().any(|result| result == Err(Enough)));
            assert_eq!(windows.samples, [3, 4, 5, 6, 7, 8, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29]);
        }
        let mut windows = Windows::new(&lines[..1]);
        let ended = windows.stretch(Sync::default(), Samples::Repeat { value: 9, clocks: 5 });
        assert_eq!((ended, windows.samples), (Ok(()), vec![9, 9]));
    }
}
