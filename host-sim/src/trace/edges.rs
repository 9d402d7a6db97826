//! The wires of a camera bus in one word, samples of them at the edges of the clock gathered into stretches, and the
//! pixel clock measured.
//!
//! ```text
//! state   │ 18 PCLK │ 17 VSYNC │ 16 HSYNC │ 13 … 0 data │
//! ```

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::wiring::{Tap, Wiring};

/// Bits of the state.
pub(super) const DATA: u64 = 0x3FFF;
pub(super) const HSYNC: u64 = 1 << 16;
pub(super) const VSYNC: u64 = 1 << 17;
pub(super) const PCLK: u64 = 1 << 18;
pub(super) const WIRES: u64 = DATA | HSYNC | VSYNC | PCLK;

/// The bit of the state for each wire.
pub(super) fn wires(wiring: &Wiring) -> Vec<(Tap, u64)> {
    let mut wires = vec![(wiring.pclk, PCLK)];
    wires.extend(wiring.hsync.map(|tap| (tap, HSYNC)));
    wires.extend(wiring.vsync.map(|tap| (tap, VSYNC)));
    wires.extend(wiring.data.iter().enumerate().map(|(line, &tap)| (tap, 1 << line & DATA)));
    wires
}

/// Takes the state of the wires at every active edge of the clock.
pub(super) trait EdgeSink {
    /// Wants the state at every time stamp, not only where the clock has its edge.
    const EVERY: bool = false;
    type Error;
    fn edge(&mut self, state: u64, time: u64) -> Result<(), Self::Error>;
}

/// Samples a stretch has at most.
const STRETCH: usize = 1 << 16;

/// Collects samples with the same sync levels and hands them on.
#[derive(Debug)]
pub(super) struct Sampler<'s, S> {
    sink: &'s mut S,
    words: Box<[u16; STRETCH]>,
    bytes: Box<[u8]>,
    count: usize,
    /// The sync bits of the state for all samples held.
    sync: u64,
    byte_bus: bool,
    pub(super) edges: u64,
    pub(super) first_time: u64,
    pub(super) last_time: u64,
}

impl<'s, S: StretchSink> Sampler<'s, S> {
    pub(super) fn new(sink: &'s mut S, byte_bus: bool) -> Self {
        Self {
            sink,
            words: Box::new([0; STRETCH]),
            bytes: vec![0; if byte_bus { STRETCH } else { 0 }].into(),
            count: 0,
            sync: u64::MAX, // no sample has it, so the first one begins a stretch
            byte_bus,
            edges: 0,
            first_time: 0,
            last_time: 0,
        }
    }

    /// Hands on what is held.
    #[inline(never)]
    pub(super) fn flush(&mut self) -> Result<(), S::Error> {
        let sync = Sync { hsync: self.sync & HSYNC != 0, vsync: self.sync & VSYNC != 0 };
        let words = self.words.get(..self.count).unwrap_or_default();
        self.edges += words.len() as u64;
        self.count = 0;
        if words.is_empty() {
            return Ok(());
        }
        if !self.byte_bus {
            return self.sink.stretch(sync, Samples::Words(words));
        }
        for (byte, word) in self.bytes.iter_mut().zip(words) {
            *byte = *word as u8;
        }
        self.sink.stretch(sync, Samples::Bytes(self.bytes.get(..words.len()).unwrap_or_default()))
    }
}

impl<S: StretchSink> EdgeSink for Sampler<'_, S> {
    type Error = S::Error;

    #[inline(always)]
    fn edge(&mut self, state: u64, time: u64) -> Result<(), S::Error> {
        let sync = state & (HSYNC | VSYNC);
        if sync != self.sync || self.count == STRETCH {
            if self.edges == 0 && self.count == 0 {
                self.first_time = time;
            }
            self.flush()?;
            self.sync = sync;
        }
        self.words[self.count % STRETCH] = (state & DATA) as u16;
        self.count += 1;
        self.last_time = time;
        Ok(())
    }
}

/// Edges from which the clock is measured.
const PROBED: usize = 4096;

/// Collects the times of the first edges.
#[derive(Debug, Default)]
pub(super) struct Probe {
    times: Vec<u64>,
}

impl EdgeSink for Probe {
    /// Enough.
    type Error = ();

    fn edge(&mut self, _: u64, time: u64) -> Result<(), ()> {
        self.times.push(time);
        if self.times.len() > PROBED { Err(()) } else { Ok(()) }
    }
}

impl Probe {
    pub(super) fn edges(&self) -> usize {
        self.times.len()
    }

    /// The clock in hertz: from the mean period of those near the median, so that a clock that pauses between lines is not
    /// taken for a slow one, and rounded time stamps average out.
    pub(super) fn hertz(&self, timescale_fs: u64) -> Option<u32> {
        let mut periods: Vec<u64> = self.times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        periods.sort_unstable();
        let median = *periods.get(periods.len() / 2)?;
        let usual =
            periods.iter().filter(|&&period| period >= median.div_ceil(2) && period <= median + median / 2);
        let (sum, count) = usual.fold((0_u128, 0_u128), |(sum, count), &p| (sum + u128::from(p), count + 1));
        let femtoseconds = sum * u128::from(timescale_fs);
        let hertz = (1_000_000_000_000_000 * count + femtoseconds / 2).checked_div(femtoseconds)?;
        u32::try_from(hertz).ok().filter(|&hertz| hertz > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_pauses_is_measured_by_its_periods() {
        let mut probe = Probe::default();
        let mut time = 0;
        for clock in 0..2000_u64 {
            // 27.648 MHz in picoseconds, rounded, with a pause after every 100 clocks.
            time = clock * 1_000_000_000 / 27_648 + clock / 100 * 1_000_000;
            probe.edge(0, time).unwrap();
        }
        assert!(time > 0);
        let hertz = probe.hertz(1000).unwrap();
        assert!(hertz.abs_diff(27_648_000) < 30, "{hertz}");
        assert_eq!(Probe::default().hertz(1000), None);
    }
}
