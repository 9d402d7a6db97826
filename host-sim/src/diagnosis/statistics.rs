//! What each data wire does over all samples: whether it moves, with which other it goes, how often it changes.

use algos_nostd::pixel::format::Format;

use super::planes::{Matrix, period};

/// Wire statistics of a matrix.
pub(super) struct Statistics {
    /// Bits that are always 0, and always 1.
    pub(super) low: u16,
    pub(super) high: u16,
    /// Pairs of wires that never differ, though both change.
    pub(super) equal: Vec<(u32, u32)>,
    pub(super) values: usize,
    pub(super) min: u16,
    pub(super) max: u16,
    pub(super) toggling: Vec<f64>,
    pub(super) agreement: Vec<f64>,
}

impl Statistics {
    pub(super) fn of(matrix: &Matrix, format: Format) -> Self {
        let bits = matrix.bits;
        let mask = (1u16 << bits) - 1;
        let (mut ones, mut zeros, mut max) = (0u16, 0u16, 0u16);
        let mut differ = vec![0u64; (bits * bits) as usize];
        let mut seen = vec![false; 1 << bits];
        for &sample in &matrix.samples {
            let sample = sample & mask;
            ones |= sample;
            zeros |= !sample & mask;
            max = max.max(sample);
            seen[usize::from(sample)] = true;
        }
        for (value, _) in seen.iter().enumerate().filter(|(_, seen)| **seen) {
            for a in 0..bits {
                for b in 0..a {
                    differ[(a * bits + b) as usize] += (value >> a ^ value >> b) as u64 & 1;
                }
            }
        }
        let moves = ones & zeros;
        let both = |a: u32, b: u32| moves >> a & 1 == 1 && moves >> b & 1 == 1;
        let mut equal = Vec::new();
        for a in 0..bits {
            for b in 0..a {
                if both(a, b) && differ[(a * bits + b) as usize] == 0 {
                    equal.push((b, a));
                }
            }
        }
        let step = period(format);
        let mut toggles = vec![0u64; bits as usize];
        let mut agrees = vec![0u64; bits as usize - 1];
        let mut pairs = 0u64;
        for y in 0..matrix.height() {
            let line = matrix.line(y);
            for (a, b) in line.iter().zip(line.iter().skip(step)) {
                pairs += 1;
                let (changed, alike) = (a ^ b, !(a ^ a >> 1));
                toggles
                    .iter_mut()
                    .enumerate()
                    .for_each(|(bit, count)| *count += u64::from(changed >> bit & 1));
                agrees.iter_mut().enumerate().for_each(|(bit, count)| *count += u64::from(alike >> bit & 1));
            }
        }
        let share =
            |counts: Vec<u64>| counts.iter().map(|&count| count as f64 / pairs.max(1) as f64).collect();
        Self {
            low: !ones & mask,
            high: !zeros & mask,
            equal,
            values: seen.iter().filter(|seen| **seen).count(),
            min: seen.iter().position(|seen| *seen).unwrap_or(0) as u16,
            max,
            toggling: share(toggles),
            agreement: share(agrees),
        }
    }
}
