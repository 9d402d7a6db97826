//! Pixel formats as models of the samples: how well does each foretell the next sample from those before it?
//!
//! ```text
//! sample     R   G   B   R   G   B       rgb888: R from the R before, G from the G before and how R moved
//! lag 3      └───────────┘
//! sample     Y   Cb  Y   Cr  Y   Cb      yuyv: Y from lag 2, chroma from lag 4
//! ```
//!
//! All models describe the very same samples, so the bits that they take can be compared (minimum description length):
//! the format whose model takes the fewest is the likeliest. Prediction is along lines only, and for mosaics from
//! diagonal neighbours too, because what does not change down the picture would be foretold by the line above in any
//! format.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::entropy::Histogram;

/// Lines of samples on which formats are judged.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Line after line.
    pub values: &'a [u16],
    /// Samples a line, at least 1.
    pub line: usize,
    /// Wires of the bus.
    pub bits: u32,
}

/// What a format makes of a line: sample `i` of the line, and those before it.
trait Model {
    fn line(&mut self, line: &[i32], above: Option<&[i32]>, y: usize);
    fn bits(&self) -> u64;
}

/// Residuals of one kind. What came before a sample says how likely it is to be foretold rightly: in plain parts of a
/// picture nothing moves, and at an edge all colours move at once. So there is a histogram for each of three cases.
struct Residuals([Histogram; 3]);

impl Residuals {
    fn new(bits: u32) -> Self {
        Self([(); 3].map(|()| Histogram::new(bits)))
    }

    /// Counts a residual after the residual `before`; gives it back for the next one.
    #[inline]
    fn add(&mut self, residual: i32, before: i32) -> i32 {
        let case = match before.unsigned_abs() {
            0 => 0,
            1..=3 => 1,
            _ => 2,
        };
        self.0[case].add(residual);
        residual
    }

    fn bits(&self) -> u64 {
        self.0.iter().map(Histogram::bits).sum()
    }
}

/// Lines that are looked at, in blocks of eight, spread evenly.
const BLOCKS: usize = 32;
const BLOCK: usize = 8;

/// Bits that the samples take under a format, in the fixed point of [`entropy`](super::entropy); and how many samples.
#[must_use]
pub fn cost(samples: Samples<'_>, format: Format, bayer: BayerOrder) -> (u64, u64) {
    // The eight highest bits that are used say enough; those below are mostly noise, and noise is never foretold.
    let used = samples.values.iter().fold(0, |all, value| all | value);
    let shift = (u16::BITS - used.leading_zeros()).saturating_sub(8);
    let bits = samples.bits.min(8);
    let mut model: Box<dyn Model> = match format {
        Format::Gray8 => Box::new(Gray(Residuals::new(bits))),
        Format::Rgb888 => Box::new(Rgb888([(); 3].map(|()| Residuals::new(bits)))),
        Format::Rgb565Be => Box::new(Rgb565::new(true)),
        Format::Rgb565Le => Box::new(Rgb565::new(false)),
        Format::Yuyv => Box::new(Yuv422::new(0)),
        Format::Uyvy => Box::new(Yuv422::new(1)),
        Format::Raw8 | Format::Raw10 | Format::Raw12 => Box::new(Mosaic::new(bits, bayer)),
    };
    let lines = samples.values.len() / samples.line.max(1);
    let blocks = lines.div_ceil(BLOCK);
    let step = blocks.div_ceil(BLOCKS).max(1);
    let mut seen = 0;
    let mut rows = [Vec::new(), Vec::new()];
    for block in (0..blocks).step_by(step) {
        let mut above = false;
        for y in block * BLOCK..lines.min((block + 1) * BLOCK) {
            let values = samples.values.get(y * samples.line..(y + 1) * samples.line).unwrap_or_default();
            let [before, line] = &mut rows;
            line.clear();
            line.extend(values.iter().map(|&value| i32::from(value >> shift)));
            model.line(line, above.then_some(before.as_slice()), y);
            seen += values.len() as u64;
            above = true;
            rows.swap(0, 1);
        }
    }
    (model.bits(), seen)
}

/// The sample before, or nothing at the start of a line.
fn back(line: &[i32], i: usize, lag: usize) -> i32 {
    i.checked_sub(lag).and_then(|i| line.get(i)).copied().unwrap_or(0)
}

/// Every sample from its neighbour.
struct Gray(Residuals);

impl Model for Gray {
    fn line(&mut self, line: &[i32], _: Option<&[i32]>, _: usize) {
        let mut before = 0;
        for (i, value) in line.iter().enumerate() {
            before = self.0.add(value - back(line, i, 1), before);
        }
    }

    fn bits(&self) -> u64 {
        self.0.bits()
    }
}

/// Green and blue move as the colour before them did.
struct Rgb888([Residuals; 3]);

impl Model for Rgb888 {
    fn line(&mut self, line: &[i32], _: Option<&[i32]>, _: usize) {
        let mut before = 0;
        for (pixel, values) in line.chunks_exact(3).enumerate() {
            let mut moved = 0;
            for (channel, (residuals, value)) in self.0.iter_mut().zip(values).enumerate() {
                let difference = value - back(line, 3 * pixel + channel, 3);
                before = residuals.add(difference - moved, before);
                moved = difference;
            }
        }
    }

    fn bits(&self) -> u64 {
        self.0.iter().map(Residuals::bits).sum()
    }
}

/// Five bits of red, six of green, five of blue; the first byte holds red. Foretold in eight bits.
struct Rgb565 {
    high_first: bool,
    fields: [Residuals; 3],
}

/// Bits of the fields.
const FIELDS: [u32; 3] = [5, 6, 5];

impl Rgb565 {
    fn new(high_first: bool) -> Self {
        Self { high_first, fields: FIELDS.map(Residuals::new) }
    }

    fn split(&self, pair: &[i32]) -> [i32; 3] {
        let [first, second] = *pair else { return [0; 3] };
        let word = if self.high_first { first << 8 | second } else { second << 8 | first };
        [word >> 11 & 31, word >> 5 & 63, word & 31]
    }
}

impl Model for Rgb565 {
    fn line(&mut self, line: &[i32], _: Option<&[i32]>, _: usize) {
        let (mut last, mut before) = ([0; 3], 0);
        for pair in line.chunks_exact(2) {
            let mut moved = 0;
            for (channel, field) in self.split(pair).into_iter().enumerate() {
                let bits = FIELDS[channel];
                let wide = field << (8 - bits) | field >> (2 * bits - 8);
                let plain = last[channel];
                let narrow = (plain + moved).clamp(0, 255) >> (8 - bits);
                before = self.fields[channel].add(field - narrow, before);
                moved = wide - plain;
                last[channel] = wide;
            }
        }
    }

    fn bits(&self) -> u64 {
        self.fields.iter().map(Residuals::bits).sum()
    }
}

/// Luma at even or odd places, and two kinds of chroma in turn between.
struct Yuv422 {
    luma_at: usize,
    luma: Residuals,
    chroma: [Residuals; 2],
}

impl Yuv422 {
    fn new(luma_at: usize) -> Self {
        Self { luma_at, luma: Residuals::new(8), chroma: [Residuals::new(8), Residuals::new(8)] }
    }
}

impl Model for Yuv422 {
    fn line(&mut self, line: &[i32], _: Option<&[i32]>, _: usize) {
        let mut before = 0;
        for (i, value) in line.iter().enumerate() {
            before = if i % 2 == self.luma_at {
                self.luma.add(value - back(line, i, 2), before)
            } else {
                let last = if i < 4 { 128 } else { back(line, i, 4) };
                self.chroma[i / 2 % 2].add(value - last, before)
            };
        }
    }

    fn bits(&self) -> u64 {
        self.luma.bits() + self.chroma.iter().map(Residuals::bits).sum::<u64>()
    }
}

/// The same colour two places before, moved by half of what the other colour moved; green also from its diagonal
/// neighbours above.
struct Mosaic {
    /// Green stands where column and line add up to an odd (1) or even (0) number.
    greens: usize,
    green: Residuals,
    others: [Residuals; 2],
    first: Residuals,
}

impl Mosaic {
    fn new(bits: u32, order: BayerOrder) -> Self {
        let greens = match order {
            BayerOrder::Rggb | BayerOrder::Bggr => 1,
            BayerOrder::Grbg | BayerOrder::Gbrg => 0,
        };
        let new = || Residuals::new(bits);
        Self { greens, green: new(), others: [new(), new()], first: new() }
    }
}

impl Model for Mosaic {
    fn line(&mut self, line: &[i32], above: Option<&[i32]>, y: usize) {
        let mut before = 0;
        for (i, value) in line.iter().enumerate() {
            let other = if i > 2 { back(line, i, 1) - back(line, i, 3) } else { 0 };
            let along = back(line, i, 2) + other / 2;
            before = match above {
                None => self.first.add(value - along, before),
                Some(above) if (i + y) % 2 == self.greens => {
                    let (left, right) = (back(above, i, 1), above.get(i + 1).copied().unwrap_or(0));
                    self.green.add(value - (2 * along + left + right) / 4, before)
                }
                Some(_) => self.others[y % 2].add(value - along, before),
            };
        }
    }

    fn bits(&self) -> u64 {
        let others: u64 = self.others.iter().map(Residuals::bits).sum();
        self.green.bits() + self.first.bits() + others
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples a line of a soft slope with a grain, as each format carries it.
    fn cost_of(values: &[u16], line: usize, format: Format) -> u64 {
        cost(Samples { values, line, bits: 8 }, format, BayerOrder::Rggb).0
    }

    fn grain(n: usize) -> u16 {
        ((n * 2_654_435_761) >> 13 & 3) as u16
    }

    #[test]
    fn a_slope_of_gray_is_gray() {
        let values: Vec<u16> = (0..8 * 96).map(|n| (n % 96) as u16 * 2 + grain(n)).collect();
        let gray = cost_of(&values, 96, Format::Gray8);
        for format in [Format::Rgb888, Format::Rgb565Be, Format::Yuyv, Format::Uyvy] {
            assert!(cost_of(&values, 96, format) > gray, "{format:?}");
        }
    }

    #[test]
    fn three_colours_and_luma_with_chroma_are_told_apart() {
        let rgb: Vec<u16> =
            (0..8 * 96).map(|n| [200, 90, 20][n % 3] - (n % 96 / 3) as u16 / 2 + grain(n / 3)).collect();
        let yuyv: Vec<u16> = (0..8 * 96)
            .map(|n| {
                if n % 2 == 0 { (n % 96) as u16 + 5 * grain(n) } else { [100, 160][n / 2 % 2] + grain(n / 4) }
            })
            .collect();
        for (values, right) in [(rgb, Format::Rgb888), (yuyv, Format::Yuyv)] {
            let costs = [Format::Rgb888, Format::Gray8, Format::Yuyv, Format::Uyvy, Format::Rgb565Le]
                .map(|format| (cost_of(&values, 96, format), format));
            let best = costs.iter().min_by_key(|(cost, _)| *cost).unwrap();
            assert_eq!(best.1, right, "{costs:?}");
        }
    }

    #[test]
    fn green_is_the_colour_that_stands_twice() {
        let colours = [[180, 90], [90, 30]];
        let values: Vec<u16> = (0..16 * 64)
            .map(|n| colours[n / 64 % 2][n % 2] + ((n % 64) + (n / 64)) as u16 / 2 + grain(n))
            .collect();
        let samples = Samples { values: &values, line: 64, bits: 8 };
        let of = |order| cost(samples, Format::Raw8, order).0;
        assert!(of(BayerOrder::Rggb) < of(BayerOrder::Grbg));
        assert_eq!(of(BayerOrder::Rggb), of(BayerOrder::Bggr), "nothing tells red from blue");
    }

    #[test]
    fn an_empty_frame_costs_nothing() {
        for format in Format::ALL {
            assert_eq!(cost(Samples { values: &[], line: 1, bits: 8 }, format, BayerOrder::Rggb), (0, 0));
        }
    }
}
