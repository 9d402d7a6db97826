//! What the camera's pins do: stretches of pixel clocks, kept in memory, handed out a few clocks at a time.

use std::convert::Infallible;

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

/// Samples of one stretch.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Held {
    Bytes(Vec<u8>),
    Words(Vec<u16>),
    Repeat { value: u16, clocks: u32 },
}

impl Held {
    fn as_samples(&self) -> Samples<'_> {
        match self {
            Self::Bytes(bytes) => Samples::Bytes(bytes),
            Self::Words(words) => Samples::Words(words),
            &Self::Repeat { value, clocks } => Samples::Repeat { value, clocks },
        }
    }
}

/// Recorded pins, to be played once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Footage {
    stretches: Vec<(Sync, Held)>,
    /// The stretch that is being played, and how many of its clocks are done.
    at: usize,
    done: usize,
    clocks: u64,
}

impl Footage {
    /// Pixel clocks in all.
    #[must_use]
    pub fn clocks(&self) -> u64 {
        self.clocks
    }

    /// Sync levels and samples from here to the end of the stretch; `None` after the last.
    #[must_use]
    pub fn ahead(&self) -> Option<(Sync, Samples<'_>)> {
        let (sync, held) = self.stretches.get(self.at)?;
        Some((*sync, held.as_samples().skip(self.done)))
    }

    /// Clocks from the clock that is `clocks` ahead to the next change of the sync levels, the first clock with the new
    /// ones among them; `None` after the last.
    #[must_use]
    pub fn until_edge(&self, clocks: u64) -> Option<u64> {
        let mut at = self.done as u64 + clocks;
        let mut stretches =
            self.stretches[self.at..].iter().filter(|(_, held)| !held.as_samples().is_empty());
        let length = |held: &Held| held.as_samples().len() as u64;
        let (sync, held) = stretches.by_ref().find(|(_, held)| {
            let here = length(held);
            let is_here = at < here;
            at -= if is_here { 0 } else { here };
            is_here
        })?;
        let mut until = length(held) - at;
        for (next, held) in stretches {
            if next != sync {
                return Some(until + 1);
            }
            until += length(held);
        }
        Some(until)
    }

    /// So many clocks have been played; at most what [`ahead`](Self::ahead) showed.
    pub fn advance(&mut self, clocks: usize) {
        self.done += clocks;
        while let Some((_, held)) = self.stretches.get(self.at) {
            let length = held.as_samples().len();
            if self.done < length {
                break;
            }
            self.done -= length;
            self.at += 1;
        }
    }
}

impl StretchSink for Footage {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        let held = match samples {
            Samples::Bytes(bytes) => Held::Bytes(bytes.to_vec()),
            Samples::Words(words) => Held::Words(words.to_vec()),
            Samples::Repeat { value, clocks } => Held::Repeat { value, clocks },
        };
        self.clocks += samples.len() as u64;
        self.stretches.push((sync, held));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_clock_is_handed_out_once_and_in_order() {
        let blank = Sync { hsync: true, vsync: true };
        let mut footage = Footage::default();
        footage.stretch(blank, Samples::Repeat { value: 9, clocks: 3 }).unwrap();
        footage.stretch(Sync::default(), Samples::Bytes(&[])).unwrap();
        footage.stretch(Sync::default(), Samples::Bytes(&[1, 2, 3, 4, 5])).unwrap();
        assert_eq!(footage.clocks(), 8);
        let edges = [0, 2, 3, 7, 8].map(|clocks| footage.until_edge(clocks));
        assert_eq!(edges, [Some(4), Some(2), Some(5), Some(1), None]);
        let mut seen = Vec::new();
        while let Some((sync, samples)) = footage.ahead() {
            let taken = samples.take(2);
            seen.extend((0..taken.len()).map(|index| (sync.vsync, taken.get(index).unwrap())));
            let count = taken.len();
            footage.advance(count);
        }
        let valid = (1..=5).map(|value| (false, value));
        assert_eq!(seen, [(true, 9); 3].into_iter().chain(valid).collect::<Vec<_>>());
    }
}
