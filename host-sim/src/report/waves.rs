use std::ops::Range;

use serde::Serialize;

use crate::diagnosis::Recording;

/// Pieces that are nearer than this are joined.
const NEAR: u64 = 32;
/// Pixel clocks that a report shows at most.
const MOST_CLOCKS: u64 = 1 << 20;

/// A piece of the trace, clock by clock.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Wave {
    /// Its first pixel clock.
    pub start: u64,
    /// Its samples in hexadecimal, without a gap, so many digits each as the bus needs.
    pub samples: String,
    /// Levels of the sync wires as runs: clocks, and HSYNC + 2 × VSYNC.
    pub runs: Vec<(u64, u8)>,
}

/// The pieces of these ranges, in the order of time, joined where they touch. When there are too many of them the last ones asked for
/// are left out.
pub(super) fn waves(recording: &Recording, bits: u32, wanted: &[Range<u64>]) -> Vec<Wave> {
    let end = recording.samples.len() as u64;
    let mut left = MOST_CLOCKS;
    let mut ranges: Vec<Range<u64>> = Vec::new();
    for range in wanted {
        let range = range.start.min(end)..range.end.min(end);
        let clocks = range.end.saturating_sub(range.start);
        if clocks > 0 && clocks <= left {
            left -= clocks;
            ranges.push(range);
        }
    }
    ranges.sort_by_key(|range| range.start);
    let mut joined: Vec<Range<u64>> = Vec::new();
    for range in ranges {
        match joined.last_mut() {
            Some(last) if range.start <= last.end + NEAR => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    joined.into_iter().map(|range| wave(recording, bits, &range)).collect()
}

fn wave(recording: &Recording, bits: u32, range: &Range<u64>) -> Wave {
    let (start, end) = (range.start as usize, range.end as usize);
    let digits = bits.div_ceil(4) as usize;
    let samples = recording.samples.get(start..end).unwrap_or_default();
    let samples = samples.iter().map(|sample| format!("{sample:0digits$x}")).collect();
    let first = recording.runs.partition_point(|run| run.start + run.length <= start);
    let runs = recording.runs.iter().skip(first).take_while(|run| run.start < end).map(|run| {
        let clocks = (run.start + run.length).min(end) - run.start.max(start);
        (clocks as u64, u8::from(run.sync.hsync) + 2 * u8::from(run.sync.vsync))
    });
    Wave { start: range.start, samples, runs: runs.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware::camif::pins::{Samples, Sync};
    use firmware::trace::StretchSink;

    #[test]
    fn pieces_hold_what_was_recorded_there() {
        let mut recording = Recording::default();
        for (hsync, clocks) in [(true, 50), (false, 100), (true, 50)] {
            let bytes: Vec<u8> = (0..clocks).map(|at| at as u8 + if hsync { 0 } else { 0x80 }).collect();
            recording.stretch(Sync { hsync, vsync: true }, Samples::Bytes(&bytes)).unwrap();
        }
        let found = waves(&recording, 8, &[148..152, 48..52, 51..53, 190..900, 300..400]);
        // 48..52 and 51..53 touch.
        assert_eq!((found[0].start, &found[0].samples[..]), (48, "3031808182"));
        assert_eq!(found[0].runs, [(2, 3), (3, 2)]);
        assert_eq!((found[1].start, &found[1].samples[..]), (148, "e2e30001"));
        assert_eq!(found[1].runs, [(2, 2), (2, 3)]);
        assert_eq!((found[2].start, found[2].samples.len()), (190, 20), "the recording ends at 200");
        assert_eq!(found.len(), 3);
        assert_eq!(&waves(&recording, 10, &[0..2, 0..1])[0].samples, "000001");
    }
}
