//! Colour planes out of lines of samples, and how well each pixel is foretold by its neighbours.
//!
//! ```text
//!   c b        foretold = a + b - c, kept between a and b     (MED: Weinberger, Seroussi and Sapiro,
//!   a x        cost = entropy of x - foretold, modulo          "The LOCO-I Lossless Image Compression
//!              the plane's range, in bits                      Algorithm", IEEE Trans. IP 9(8), 2000)
//! ```
//!
//! A picture of the world is smooth; whatever disturbs the order of its bits or bytes makes it less so. A wrong
//! order that is undone makes it cost less, and that is how the order is found without the true picture.

use algos_nostd::pixel::format::Format;

/// A matrix of samples: whole lines of one length, one after the other, maybe with gaps between frames.
#[derive(Clone, Debug, Default)]
pub(super) struct Matrix {
    pub(super) width: usize,
    pub(super) samples: Vec<u16>,
    /// The clock of each line's first sample.
    pub(super) starts: Vec<usize>,
    /// Bits of the bus.
    pub(super) bits: u32,
}

impl Matrix {
    pub(super) fn height(&self) -> usize {
        self.starts.len()
    }

    pub(super) fn line(&self, y: usize) -> &[u16] {
        &self.samples[y * self.width..][..self.width]
    }

    /// With another value for every sample.
    pub(super) fn map(&self, change: impl Fn(u16) -> u16) -> Self {
        let mut changed = self.clone();
        changed.samples.iter_mut().for_each(|sample| *sample = change(*sample));
        changed
    }

    /// With neighbouring samples exchanged.
    pub(super) fn swapped(&self) -> Self {
        let mut changed = self.clone();
        for line in changed.samples.chunks_mut(self.width) {
            line.as_chunks_mut::<2>().0.iter_mut().for_each(|pair| pair.swap(0, 1));
        }
        changed
    }
}

/// Samples after which a colour comes again in a line.
pub(super) fn period(format: Format) -> usize {
    match format {
        Format::Rgb888 => 3,
        Format::Yuyv | Format::Uyvy => 4,
        Format::Gray8 => 1,
        Format::Rgb565Be | Format::Rgb565Le | Format::Raw8 | Format::Raw10 | Format::Raw12 => 2,
    }
}

/// Lines after which a colour comes again.
pub(super) fn rows(format: Format) -> usize {
    if matches!(format, Format::Raw8 | Format::Raw10 | Format::Raw12) { 2 } else { 1 }
}

/// Where a plane's values are in a line: first sample, step, and which bits of one or two samples.
#[derive(Clone, Copy)]
struct Plane {
    first: usize,
    step: usize,
    take: fn(&[u16]) -> u16,
    bits: u32,
    row: usize,
    rows: usize,
}

fn one(samples: &[u16]) -> u16 {
    samples.first().copied().unwrap_or(0)
}

fn word(samples: &[u16], high_first: bool) -> u16 {
    let (a, b) = (one(samples), samples.get(1).copied().unwrap_or(0));
    if high_first { a << 8 | b & 0xFF } else { b << 8 | a & 0xFF }
}

/// Red and blue of RGB565 against green.
fn red(word: u16) -> u16 {
    (word >> 11).wrapping_sub(word >> 6 & 0x1F) & 0x1F
}

fn blue(word: u16) -> u16 {
    word.wrapping_sub(word >> 6) & 0x1F
}

fn planes(format: Format, bits: u32) -> Vec<Plane> {
    let plain = |first, step| Plane { first, step, take: one, bits, row: 0, rows: 1 };
    let field = |take, bits| Plane { first: 0, step: 2, take, bits, row: 0, rows: 1 };
    match format {
        Format::Gray8 => vec![plain(0, 1)],
        // Green, and how red and blue differ from it: colours go together.
        Format::Rgb888 => [
            |s: &[u16]| s.get(1).copied().unwrap_or(0),
            |s: &[u16]| one(s).wrapping_sub(s.get(1).copied().unwrap_or(0)) & 0xFF,
            |s: &[u16]| s.get(2).copied().unwrap_or(0).wrapping_sub(s.get(1).copied().unwrap_or(0)) & 0xFF,
        ]
        .map(|take| Plane { first: 0, step: 3, take, bits, row: 0, rows: 1 })
        .to_vec(),
        Format::Yuyv => vec![plain(0, 2), plain(1, 4), plain(3, 4)],
        Format::Uyvy => vec![plain(1, 2), plain(0, 4), plain(2, 4)],
        Format::Rgb565Be => vec![
            field(|s| red(word(s, true)), 5),
            field(|s| word(s, true) >> 5 & 0x3F, 6),
            field(|s| blue(word(s, true)), 5),
        ],
        Format::Rgb565Le => vec![
            field(|s| red(word(s, false)), 5),
            field(|s| word(s, false) >> 5 & 0x3F, 6),
            field(|s| blue(word(s, false)), 5),
        ],
        Format::Raw8 | Format::Raw10 | Format::Raw12 => (0..4)
            .map(|site| Plane { first: site % 2, step: 2, take: one, bits, row: site / 2, rows: 2 })
            .collect(),
    }
}

/// Differences of neighbours, in levels of 8 bits, that tell calm places from busy ones.
const BUSY: [u32; 3] = [4, 12, 32];

/// Bits that a sample costs if the lines are of this format.
pub(super) fn cost(matrix: &Matrix, format: Format) -> f64 {
    cost_in(matrix, format, &[])
}

/// The same, calm and busy places apart: what the lowest wires do shows in calm places only.
pub(super) fn fine_cost(matrix: &Matrix, format: Format) -> f64 {
    cost_in(matrix, format, &BUSY)
}

/// Errors are counted by how many of these differences the sample's neighbours exceed.
fn cost_in(matrix: &Matrix, format: Format, contexts: &[u32]) -> f64 {
    let (mut bits, mut samples) = (0.0, 0usize);
    let (mut above, mut here) = (Vec::new(), Vec::new());
    for plane in planes(format, matrix.bits) {
        let mut histograms = vec![0u32; (contexts.len() + 1) << plane.bits];
        let calm = plane.bits.saturating_sub(8);
        let mask = (1u16 << plane.bits) - 1;
        above.clear();
        for y in (plane.row..matrix.height()).step_by(plane.rows) {
            here.clear();
            let line = matrix.line(y);
            let mut at = plane.first;
            while at < line.len() {
                here.push((plane.take)(&line[at..]));
                at += plane.step;
            }
            if above.len() == here.len() {
                for x in 1..here.len() {
                    let (a, b, c) = (here[x - 1], above[x], above[x - 1]);
                    let foretold = if c >= a.max(b) {
                        a.min(b)
                    } else if c <= a.min(b) {
                        a.max(b)
                    } else {
                        a + b - c
                    };
                    let busy = (u32::from(a.abs_diff(c)) + u32::from(b.abs_diff(c))) >> calm;
                    let context = contexts.iter().take_while(|&&least| busy >= least).count();
                    let error = usize::from(here[x].wrapping_sub(foretold) & mask);
                    histograms[context << plane.bits | error] += 1;
                }
            }
            std::mem::swap(&mut above, &mut here);
        }
        bits += histograms.chunks(1 << plane.bits).map(entropy).sum::<f64>();
    }
    samples += (matrix.height().saturating_sub(rows(format))) * matrix.width;
    if samples == 0 { 0.0 } else { bits / samples as f64 }
}

/// The bits that all of a histogram's symbols take.
fn entropy(histogram: &[u32]) -> f64 {
    let total: f64 = histogram.iter().map(|&count| f64::from(count)).sum();
    let cost = |count: &u32| -f64::from(*count) * (f64::from(*count) / total).log2();
    histogram.iter().filter(|count| **count > 0).map(cost).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_costs_nothing_and_its_bits_reversed_cost_much() {
        let mut ramp = Matrix { width: 64, bits: 8, ..Matrix::default() };
        for y in 0..16u16 {
            ramp.samples.extend((0..64).map(|x| 3 * x + y));
            ramp.starts.push(64 * usize::from(y));
        }
        assert_eq!(cost(&ramp, Format::Gray8), 0.0);
        assert!(cost(&ramp.map(|value| u16::from((value as u8).reverse_bits())), Format::Gray8) > 1.0);
        assert!(cost(&ramp.swapped(), Format::Gray8) > 0.5);
    }
}
