//! What the samples say: the picture is not known, but pictures of the world are smooth.
//!
//! | what | how it shows |
//! |---|---|
//! | stuck, shorted, shifted wires | bits that never change, pairs that never differ, values that wrap |
//! | swapped wires, reversed bus, swapped bytes, another format | undoing it makes the picture cost less (`planes`) |
//! | samples taken while data changes | bits of the sample before, and not of the one after |
//! | bytes that slip | the end of each line is idle bus, or belongs to the next line |
//! | another mosaic | the sites that should be green differ more among themselves than the others |

use std::collections::BTreeSet;

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::finding::{Evidence, Finding, Remedy};
use super::planes::{Matrix, cost, period, rows};
use super::remedy;
use super::structure::{At, found};
use crate::fault::{FaultKind, reverse_bits, swap_bits};
use crate::profile::{Choice, Profile, SyncMode};

/// Lines that are looked at, at most: two frames of VGA.
pub(super) const MOST_LINES: usize = 1_000;
/// Fewest samples from which anything is concluded.
const FEWEST: usize = 2_000;
/// Fewest different values of a picture from which its bits are judged.
const VALUES: usize = 24;
/// A wrong order is undone if that saves at least this share of the cost, and so many bits a sample.
const SAVES: (f64, f64) = (0.02, 0.025);

/// Wire statistics of a matrix.
pub(super) struct Statistics {
    /// Bits that are always 0, and always 1.
    low: u16,
    high: u16,
    /// Pairs of wires that never differ, though both change.
    equal: Vec<(u32, u32)>,
    values: usize,
    max: u16,
    pub(super) toggling: Vec<f64>,
    pub(super) agreement: Vec<f64>,
}

/// Jumps of half of `range` and of three quarters of it, among neighbours of one colour.
fn wraps(matrix: &Matrix, step: usize, range: f64, value: impl Fn(u16) -> u16) -> (f64, f64) {
    let (mut far, mut half, mut all) = (0u64, 0u64, 0u64);
    for y in 0..matrix.height() {
        let line = matrix.line(y);
        for (a, b) in line.iter().zip(line.iter().skip(step)) {
            let distance = f64::from(value(*a).abs_diff(value(*b)));
            all += 1;
            far += u64::from(distance >= 0.75 * range);
            half += u64::from(distance >= 0.4 * range && distance < 0.75 * range);
        }
    }
    let all = all.max(1) as f64;
    (far as f64 / all, half as f64 / all)
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
            max,
            toggling: share(toggles),
            agreement: share(agrees),
        }
    }
}

/// The samples of a trace, judged by a profile.
pub(super) struct Data<'a> {
    pub(super) profile: &'a Profile,
    pub(super) matrix: &'a Matrix,
    pub(super) statistics: Statistics,
    /// Bits that a sample costs as the profile reads it.
    pub(super) cost: f64,
    at: At,
}

impl<'a> Data<'a> {
    pub(super) fn new(profile: &'a Profile, matrix: &'a Matrix) -> Self {
        let format = profile.frame.format;
        let at = At { clock: matrix.starts.first().copied().unwrap_or(0) as u64, line: None };
        let statistics = Statistics::of(matrix, format);
        Self { profile, matrix, statistics, cost: cost(matrix, format), at }
    }

    fn enough(&self) -> bool {
        self.matrix.samples.len() >= FEWEST && self.matrix.height() >= 8
    }

    /// Findings, the most likely first; none for a picture that looks like one.
    pub(super) fn findings(&self) -> Vec<Finding> {
        if !self.enough() {
            return Vec::new();
        }
        let mut findings = Vec::new();
        findings.extend(self.constant());
        findings.extend(self.shorted());
        if findings.is_empty() {
            findings.extend(self.orders());
            findings.extend(self.slip());
            if findings.is_empty() {
                findings.extend(self.mosaic());
            }
        }
        findings.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        findings
    }

    fn remedy(&self, kind: FaultKind) -> Remedy {
        remedy::of(kind, self.profile)
    }

    /// Bits that never change.
    fn constant(&self) -> Vec<Finding> {
        let Statistics { low, high, values, .. } = self.statistics;
        let bits = self.matrix.bits;
        let (fixed, top) = (low | high, bits - 1);
        if fixed == 0 || values < 6 {
            return Vec::new();
        }
        let places_low = low.trailing_ones();
        let places_high = (low << (16 - bits)).leading_ones();
        let count = fixed.count_ones();
        let one = fixed.trailing_zeros();
        let numbers = |text: String| {
            Evidence::new(text)
                .with("bits_always_low", f64::from(low))
                .with("bits_always_high", f64::from(high))
                .with("different_values", values as f64)
        };
        let step = period(self.profile.frame.format);
        let range = f64::from(1u16 << bits);
        let shifted = |to: &str, places: u32, confidence: f64| {
            let text = format!(
                "the {} {places} of {bits} data wires never change, and the rest looks like a picture moved {}",
                if to == "up" { "lowest" } else { "highest" },
                to
            );
            found(
                FaultKind::ShiftedBits,
                confidence,
                self.at,
                numbers(text).with("places", f64::from(places)),
                self.remedy(FaultKind::ShiftedBits),
            )
        };
        let stuck = |bit: u32, confidence: f64| {
            let level = if high >> bit & 1 == 1 { "high" } else { "low" };
            let text = format!(
                "D{bit} is {level} in all {} samples; the wires beside it change",
                self.matrix.samples.len()
            );
            found(
                FaultKind::StuckBit,
                confidence,
                self.at,
                numbers(text).with("bit", f64::from(bit)),
                self.remedy(FaultKind::StuckBit),
            )
        };
        let mut findings = Vec::new();
        if places_low > 0 && count == places_low {
            let (far, half) = wraps(self.matrix, step, range, |value| value);
            let wrapped = far > 0.0005 && far > 0.3 * half;
            if places_low >= 2 {
                findings.push(shifted("up", places_low, 0.95));
            } else {
                findings.push(stuck(0, if wrapped { 0.35 } else { 0.9 }));
                findings.push(shifted("up", 1, if wrapped { 0.9 } else { 0.35 }));
            }
        } else if places_high > 0 && count == places_high {
            // A dark picture has such wires as well. One whose top wire is stuck falls over its edge, and one that is
            // shifted goes up to the edge.
            let limit = 1u16 << (bits - places_high);
            let (far, half) = wraps(self.matrix, step, f64::from(limit), |value| value);
            let wrapped = far > 0.0005 && far > 0.6 * half;
            let full = f64::from(self.statistics.max) >= 0.85 * f64::from(limit);
            let chroma = self
                .chroma()
                .is_some_and(|mean| (mean - f64::from(limit) / 2.0).abs() < f64::from(limit) / 8.0);
            if places_high == 1 && wrapped {
                findings.push(stuck(top, 0.9));
                findings.push(shifted("down", 1, 0.3));
            } else if full || chroma {
                findings.push(shifted("down", places_high, if chroma { 0.95 } else { 0.75 }));
                if places_high == 1 {
                    findings.push(stuck(top, 0.3));
                }
            }
        } else if count == 1 && one == top {
            let (far, half) = wraps(self.matrix, step, range / 2.0, |value| value & !(1 << top));
            if far > 0.0005 && far > 0.6 * half {
                findings.push(stuck(top, 0.9));
            }
        } else {
            // A bit below one that changes, and alone.
            for bit in (0..bits).filter(|bit| fixed >> bit & 1 == 1) {
                let above = (bit + 1..bits).any(|other| fixed >> other & 1 == 0);
                if above && (count == 1 || high >> bit & 1 == 1 || places_high + 1 >= count) {
                    findings.push(stuck(bit, if count == 1 { 0.95 } else { 0.6 }));
                }
            }
        }
        findings
    }

    /// The mean of the colour differences, where the format has them.
    fn chroma(&self) -> Option<f64> {
        let first = match self.profile.frame.format {
            Format::Yuyv => 1,
            Format::Uyvy => 0,
            _ => return None,
        };
        let values = self.matrix.samples.iter().skip(first).step_by(2);
        Some(values.clone().map(|&value| f64::from(value)).sum::<f64>() / values.count().max(1) as f64)
    }

    /// Pairs of wires that never differ.
    fn shorted(&self) -> Vec<Finding> {
        let bits = self.matrix.bits;
        let Statistics { equal, values, toggling, .. } = &self.statistics;
        // Samples of 8 bits spread over a wider bus repeat their upper bits below.
        let spread = bits - 8;
        let repeats = |&(a, b): &(u32, u32)| spread > 0 && b - a == 8 && b + spread >= bits;
        let pairs: Vec<_> = equal.iter().filter(|pair| !repeats(pair)).collect();
        // As many pairs as there are repeated bits, but elsewhere: wires have changed places.
        if spread > 0 && equal.len() == spread as usize {
            return Vec::new();
        }
        if *values < VALUES || pairs.is_empty() || pairs.len() > 3 {
            return Vec::new();
        }
        let (a, b) = *pairs[0];
        let text = format!(
            "D{a} and D{b} are the same in all {} samples, though both change",
            self.matrix.samples.len()
        );
        let evidence = Evidence::new(text)
            .with("a", f64::from(a))
            .with("b", f64::from(b))
            .with("toggling_a", toggling[a as usize])
            .with("toggling_b", toggling[b as usize]);
        vec![found(FaultKind::ShortedBits, 0.95, self.at, evidence, self.remedy(FaultKind::ShortedBits))]
    }

    /// Orders of bits and bytes which, undone, make the picture cost less.
    fn orders(&self) -> Vec<Finding> {
        let format = self.profile.frame.format;
        let bits = self.matrix.bits;
        if self.statistics.values < VALUES || self.cost < 0.05 {
            return Vec::new();
        }
        let mut tried: Vec<(f64, FaultKind, String, Remedy)> = Vec::new();
        // The two wires of each exchange, by what is said of it.
        let mut wires = std::collections::BTreeMap::new();
        for a in 0..bits {
            for b in a + 1..bits {
                let undone = cost(&self.matrix.map(|sample| swap_bits(sample, a, b)), format);
                let how = format!("with D{a} and D{b} exchanged");
                wires.insert(how.clone(), (a, b));
                tried.push((
                    undone,
                    FaultKind::SwappedBits,
                    how,
                    Remedy::new(format!("exchange D{a} and D{b}, on the board or with --map D{a}=…,D{b}=…")),
                ));
            }
        }
        if self.profile.frame.is_bayer() {
            // Colours alternate either way, so only distances tell: 1 0 3 2 has neighbours that are three apart.
            let (within, across) = self.pairs();
            if across > 1.2 * within && across > 1.0 {
                let text =
                    format!("samples 2k and 2k+1 differ by {within:.1} levels, 2k+1 and 2k+2 by {across:.1}");
                let evidence =
                    Evidence::new(text).with("levels_within", within).with("levels_across", across);
                return vec![found(
                    FaultKind::ByteSwap,
                    0.95,
                    self.at,
                    evidence,
                    self.remedy(FaultKind::ByteSwap),
                )];
            }
        }
        let reversed = self.matrix.map(|sample| reverse_bits(sample, bits));
        tried.push((
            cost(&reversed, format),
            FaultKind::ReversedBus,
            "with the bus reversed".to_owned(),
            self.remedy(FaultKind::ReversedBus),
        ));
        let twin = twin(format);
        if twin.is_none() && !self.profile.frame.is_bayer() {
            tried.push((
                cost(&self.matrix.swapped(), format),
                FaultKind::ByteSwap,
                "with neighbouring samples exchanged".to_owned(),
                self.remedy(FaultKind::ByteSwap),
            ));
        }
        let best_order = tried.iter().map(|tried| tried.0).fold(f64::INFINITY, f64::min);
        for &other in others(format) {
            let kind = if Some(other) == twin { FaultKind::ByteSwap } else { FaultKind::FormatMismatch };
            let remedy = self.remedy(kind).profile(format!("frame.format = \"{}\"", other.name()));
            let read = cost(self.matrix, other);
            // Planes of other formats are of other widths, so a little less says nothing.
            if read > self.cost - 0.15_f64.max(0.08 * self.cost) || read > best_order {
                continue;
            }
            tried.push((read, kind, format!("read as {}", other.name()), remedy));
        }
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(best) = tried.first().map(|tried| tried.0) else { return Vec::new() };
        // What is undone must look like a picture, not like noise.
        if best > 0.9 * f64::from(bits.min(8)) || self.cost - best < SAVES.1.max(SAVES.0 * self.cost) {
            return Vec::new();
        }
        let mut kinds = BTreeSet::new();
        let mut findings = Vec::new();
        for (cost, kind, how, remedy) in tried {
            let saved = self.cost - cost;
            if saved < 0.5 * (self.cost - best) || !kinds.insert(kind) {
                continue;
            }
            let mut evidence = Evidence::new(format!(
                "{how} the picture takes {cost:.2} bits a sample, as it is {:.2}",
                self.cost
            ))
            .with("bits_a_sample", self.cost)
            .with("bits_a_sample_undone", cost);
            if let Some((a, b)) = wires.get(&how) {
                evidence = evidence.with("a", f64::from(*a)).with("b", f64::from(*b));
            }
            let share = saved / (self.cost - best);
            findings.push(found(kind, 0.5 + 0.45 * (share * 2.0 - 1.0), self.at, evidence, remedy));
        }
        findings
    }

    /// How far the detail of neighbours is apart, within pairs of samples and across.
    fn pairs(&self) -> (f64, f64) {
        let (mut within, mut across) = (0u64, 0u64);
        for y in 2..self.matrix.height() {
            // Against the same colour above, so that colours do not count, only what is seen.
            let detail = |x: usize| i64::from(self.matrix.line(y)[x]) - i64::from(self.matrix.line(y - 2)[x]);
            for x in 1..self.matrix.width {
                let distance = detail(x).abs_diff(detail(x - 1));
                if x % 2 == 1 { within += distance } else { across += distance }
            }
        }
        let count = (self.matrix.samples.len() / 2).max(1) as f64;
        (within as f64 / count, across as f64 / count)
    }

    /// Lines whose end is not theirs.
    fn slip(&self) -> Option<Finding> {
        let step = period(self.profile.frame.format);
        let (width, height) = (self.matrix.width, self.matrix.height());
        let found_slip = |samples: usize, text: String, numbers: Evidence| {
            let evidence = Evidence { text, ..numbers }.with("samples", samples as f64);
            found(FaultKind::ByteSlip, 0.97, self.at, evidence, self.remedy(FaultKind::ByteSlip))
        };
        if width < 4 * step + 32 {
            return None;
        }
        if self.profile.bus.sync != SyncMode::Marker {
            // The bus is idle there: each column holds one value in all lines.
            let embedded = self.profile.bus.sync == SyncMode::Embedded;
            let last = self.matrix.line(0)[width - 1];
            let idle = |back: usize| {
                // Filler alternates; a wire without data keeps its level.
                let value = if embedded {
                    [0x80, 0x10][usize::from(back.is_multiple_of(2) != (last == 0x80))]
                } else {
                    last
                };
                (0..height).all(|y| self.matrix.line(y)[width - 1 - back] == value)
            };
            let slipped = (0..32).take_while(|back| idle(*back)).count();
            if slipped == 0 || slipped >= 32 {
                return None;
            }
            let column = |column: usize| (0..height).map(move |y| f64::from(self.matrix.line(y)[column]));
            let end = f64::from(self.matrix.line(0)[width - slipped]);
            let near = width - slipped - step;
            let apart = column(near).map(|value| (value - end).abs()).sum::<f64>() / height as f64;
            let range = f64::from(1u16 << self.matrix.bits);
            // Filler between codes has the value of no colour: a picture without any ends like that as well.
            let least = if embedded { 2.0 } else { 0.04 * range };
            if apart < least {
                return None;
            }
            let text = format!("the last {slipped} samples of every line are {end:.0}, as the idle bus is");
            return Some(found_slip(slipped, text, Evidence::default().with("distance", apart)));
        }
        // Every clock carries data: the end of a line goes on in the next one.
        let distance = |a: u16, b: u16| f64::from(a.abs_diff(b));
        let mut best = (0.0, 0, 0.0, 0.0);
        for samples in 1..=16usize {
            let (mut within, mut across, mut count) = (0.0, 0.0, 0.0);
            for y in 0..height - 1 {
                let (line, next) = (self.matrix.line(y), self.matrix.line(y + 1));
                for lane in 0..step.min(samples) {
                    let at = width - samples + lane;
                    let Some(following) = (at + step).checked_sub(width) else { continue };
                    within += distance(line[at], line[at - step]);
                    across += distance(line[at], next[following]);
                    count += 1.0;
                }
            }
            let ratio = within / f64::max(across, count);
            if count > 0.0 && ratio > best.0 {
                best = (ratio, samples, within / count, across / count);
            }
        }
        let (ratio, samples, within, across) = best;
        let range = f64::from(1u16 << self.matrix.bits);
        (ratio > 1.6 && within > 0.03 * range).then(|| {
            let text = format!(
                "the last {samples} samples of a line go on in the next line: {across:.1} levels apart there, {within:.1} from their neighbours"
            );
            found_slip(samples, text, Evidence::default().with("levels_within", within).with("levels_across", across))
        })
    }

    /// A mosaic that starts with another colour: what should be green is not.
    fn mosaic(&self) -> Option<Finding> {
        if !self.profile.frame.is_bayer() || self.statistics.values < VALUES {
            return None;
        }
        let order = self.profile.frame.bayer;
        let (width, height) = (self.matrix.width, self.matrix.height());
        let (mut green, mut other, mut greens, mut others) = (0.0, 0.0, 0.0, 0.0);
        for y in 1..height - 1 {
            // Lines of another frame are no neighbours.
            let stride = self.matrix.starts[y + 1] - self.matrix.starts[y];
            if stride != self.matrix.starts[y] - self.matrix.starts[y - 1] {
                continue;
            }
            for x in 1..width - 1 {
                let at = |dx: usize, dy: usize| f64::from(self.matrix.line(y + dy - 1)[x + dx - 1]);
                let around = (at(0, 0) + at(2, 0) + at(0, 2) + at(2, 2)) / 4.0;
                let differs = (at(1, 1) - around).abs();
                let row = self.row_of(y);
                if is_green(order, x, row) {
                    (green, greens) = (green + differs, greens + 1.0);
                } else {
                    (other, others) = (other + differs, others + 1.0);
                }
            }
        }
        let (green, other) = (green / f64::max(greens, 1.0), other / f64::max(others, 1.0));
        (green > 1.12 * other && green > 1.5).then(|| {
            let candidates: Vec<&str> = BayerOrder::ALL
                .into_iter()
                .filter(|candidate| is_green(*candidate, 0, 0) != is_green(order, 0, 0))
                .map(Choice::name)
                .collect();
            let text = format!(
                "where {} has green, a sample differs from its diagonal neighbours by {green:.1} levels, elsewhere by {other:.1}",
                Choice::name(order)
            );
            let evidence = Evidence::new(text).with("levels_green", green).with("levels_other", other);
            let remedy = self.remedy(FaultKind::BayerPhase).profile(format!("frame.bayer = \"{}\" (or \"{}\": red and blue say which)", candidates[0], candidates[1]));
            let confidence = 0.6 + 0.35 * ((green / other - 1.12) * 3.0).min(1.0);
            found(FaultKind::BayerPhase, confidence, self.at, evidence, remedy)
        })
    }

    /// The frame's row of a line of the matrix: frames follow one another whole.
    fn row_of(&self, y: usize) -> usize {
        y % self.profile.frame.height.max(1) as usize
    }
}

fn is_green(order: BayerOrder, x: usize, y: usize) -> bool {
    order.channel(x, y) as usize == 1
}

/// The format that differs by the order of its bytes only.
fn twin(format: Format) -> Option<Format> {
    Some(match format {
        Format::Rgb565Be => Format::Rgb565Le,
        Format::Rgb565Le => Format::Rgb565Be,
        Format::Yuyv => Format::Uyvy,
        Format::Uyvy => Format::Yuyv,
        _ => return None,
    })
}

/// Formats with lines of as many samples.
fn others(format: Format) -> &'static [Format] {
    match format {
        Format::Rgb565Be => &[Format::Rgb565Le, Format::Yuyv, Format::Uyvy],
        Format::Rgb565Le => &[Format::Rgb565Be, Format::Yuyv, Format::Uyvy],
        Format::Yuyv => &[Format::Uyvy, Format::Rgb565Be, Format::Rgb565Le],
        Format::Uyvy => &[Format::Yuyv, Format::Rgb565Be, Format::Rgb565Le],
        Format::Gray8 => &[Format::Raw8],
        // A gray scene behind a mosaic is what a gray sensor sends: nothing tells them apart.
        Format::Raw8 | Format::Raw10 | Format::Raw12 | Format::Rgb888 => &[],
    }
}

/// Samples that show bits of the sample before them: how many, how many show those of the one after, of all.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mixing {
    pub(super) before: u64,
    pub(super) after: u64,
    pub(super) all: u64,
    /// The clock of the first line with such samples.
    pub(super) first: u64,
}

impl Mixing {
    /// Compares each sample with those above and below, and those to either side on the wires.
    ///
    /// `all` counts those that could show it. A picture has no side from which its edges come more often; a sample that is taken too early does.
    pub(super) fn of(matrix: &Matrix, format: Format) -> Self {
        let mut mixing = Self::default();
        let (rows, step) = (rows(format), period(format));
        for y in rows..matrix.height().saturating_sub(rows) {
            let (up, line, down) = (matrix.line(y - rows), matrix.line(y), matrix.line(y + rows));
            for x in step..matrix.width.saturating_sub(step) {
                // What neighbours of the sample's colour agree on; the one to the side is no witness where it is on trial.
                let sides = if step > 1 { line[x - step] ^ up[x] | line[x + step] ^ up[x] } else { 0 };
                let agree = !(up[x] ^ down[x] | sides);
                let differs = (line[x] ^ up[x]) & agree;
                mixing.all += u64::from((line[x - 1] ^ up[x]) & agree != 0);
                if differs == 0 {
                    continue;
                }
                let shows = |other: u16| (line[x] ^ other) & differs == 0;
                match (shows(line[x - 1]), shows(line[x + 1])) {
                    (true, false) => {
                        if mixing.before == 0 {
                            mixing.first = matrix.starts[y] as u64;
                        }
                        mixing.before += 1;
                    }
                    (false, true) => mixing.after += 1,
                    _ => {}
                }
            }
        }
        mixing
    }

    /// How many standard deviations one side is ahead, and the share of samples that it is ahead by.
    pub(super) fn ahead(&self) -> (f64, f64) {
        let (before, after) = (self.before as f64, self.after as f64);
        let ahead = before - after;
        (ahead / (before + after).sqrt().max(1.0), ahead / self.all.max(1) as f64)
    }

    /// What it means.
    pub(super) fn finding(&self, profile: &Profile) -> Option<Finding> {
        let (deviations, share) = self.ahead();
        if deviations.abs() < 7.0
            || self.before.max(self.after) < 40
            || share.abs() < 0.001
            || self.before.max(self.after) * 2 < self.before.min(self.after) * 3
        {
            return None;
        }
        let kind = if share.abs() > 0.08 { FaultKind::WrongEdge } else { FaultKind::ClockJitter };
        let text = format!(
            "{:.2} % of the samples that can tell show bits of the sample {} them ({} against {} the other way)",
            100.0 * share.abs(),
            if share > 0.0 { "before" } else { "after" },
            self.before.max(self.after),
            self.before.min(self.after)
        );
        let evidence =
            Evidence::new(text).with("share_of_samples", share).with("standard_deviations", deviations);
        let confidence = if kind == FaultKind::WrongEdge { 0.97 } else { 0.96 };
        Some(found(
            kind,
            confidence,
            At { clock: self.first, line: None },
            evidence,
            remedy::of(kind, profile),
        ))
    }
}
