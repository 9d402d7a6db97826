use std::convert::Infallible;

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

/// Most pixel clocks that are looked at: 18 frames of VGA RGB888, in 32 MiB.
pub const MOST_CLOCKS: usize = 1 << 24;

/// Clocks with constant sync levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The levels.
    pub sync: Sync,
    /// The first clock.
    pub start: usize,
    /// Clocks.
    pub length: usize,
}

/// The beginning of a trace in memory.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Runs of constant sync levels, in order and without gaps.
    pub runs: Vec<Run>,
    /// A sample a clock.
    pub samples: Vec<u16>,
    /// Clocks of the trace, recorded or not.
    pub clocks: u64,
}

impl Recording {
    /// Edges of HSYNC and VSYNC.
    #[must_use]
    pub fn edges(&self) -> (u64, u64) {
        self.runs.windows(2).fold((0, 0), |(hsync, vsync), pair| {
            let differs = |level: fn(&Sync) -> bool| u64::from(level(&pair[0].sync) != level(&pair[1].sync));
            (hsync + differs(|sync| sync.hsync), vsync + differs(|sync| sync.vsync))
        })
    }
}

impl StretchSink for Recording {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        self.clocks += samples.len() as u64;
        let start = self.samples.len();
        let samples = samples.take(MOST_CLOCKS - start);
        match samples {
            Samples::Bytes(bytes) => self.samples.extend(bytes.iter().map(|&byte| u16::from(byte))),
            Samples::Words(words) => self.samples.extend_from_slice(words),
            Samples::Repeat { value, clocks } => {
                self.samples.extend(std::iter::repeat_n(value, clocks as usize));
            }
        }
        let length = self.samples.len() - start;
        match self.runs.last_mut() {
            _ if length == 0 => {}
            Some(run) if run.sync == sync => run.length += length,
            _ => self.runs.push(Run { sync, start, length }),
        }
        Ok(())
    }
}
