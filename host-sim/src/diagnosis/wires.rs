//! Data wires that never move, and pairs that never differ: stuck, shifted, shorted.

use algos_nostd::pixel::format::Format;

use super::data::{Data, VALUES};
use super::finding::{Evidence, Finding};
use super::planes::{Matrix, period};
use super::statistics::Statistics;
use super::structure::found;
use crate::fault::FaultKind;

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

impl Data<'_> {
    /// Bits that never change.
    pub(super) fn constant(&self) -> Vec<Finding> {
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
            } else if values >= 16 {
                // Nothing tells these wires from those of an underexposed picture.
                findings.push(shifted("down (or it is that dark)", places_high, 0.4));
            }
        } else if count == 1 && one == top {
            let (far, half) = wraps(self.matrix, step, range / 2.0, |value| value & !(1 << top));
            // In the second byte of RGB565 that wire is green's third lowest bit.
            let middle = matches!(self.profile.frame.format, Format::Rgb565Be | Format::Rgb565Le);
            // A bright picture has no reason to use all of the upper half and nothing below.
            let room = (1u16 << top) / 16;
            let full =
                self.statistics.min < (1 << top) + room && self.statistics.max >= (range as u16 - room);
            if middle || full || far > 0.0005 && far > 0.6 * half {
                findings.push(stuck(top, if middle { 0.95 } else { 0.9 }));
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
    pub(super) fn chroma(&self) -> Option<f64> {
        let first = match self.profile.frame.format {
            Format::Yuyv => 1,
            Format::Uyvy => 0,
            _ => return None,
        };
        let values = self.matrix.samples.iter().skip(first).step_by(2);
        Some(values.clone().map(|&value| f64::from(value)).sum::<f64>() / values.count().max(1) as f64)
    }

    /// Pairs of wires that never differ.
    pub(super) fn shorted(&self) -> Vec<Finding> {
        let bits = self.matrix.bits;
        let Statistics { equal, values, toggling, .. } = &self.statistics;
        // Samples of 8 bits spread over a wider bus repeat their upper bits below.
        let spread = bits - 8;
        let repeats = |&(a, b): &(u32, u32)| spread > 0 && b - a == 8 && b + spread >= bits;
        let mut pairs: Vec<_> = equal.iter().filter(|pair| !repeats(pair)).collect();
        // As many pairs as there are repeated bits, but elsewhere: wires have changed places, or one that is repeated is
        // connected to another. Then both follow the repeated one wherever the stronger level is.
        if spread > 0 && equal.len() == spread as usize {
            pairs.retain(|&&(a, b)| [a, b].into_iter().any(|wire| self.is_overruled(wire)));
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

    /// Whether a wire's twin among the repeated bits never has one of the levels that the wire has without it.
    fn is_overruled(&self, wire: u32) -> bool {
        let twin = if wire >= 8 { wire - 8 } else { wire + 8 };
        if twin >= self.matrix.bits {
            return false;
        }
        let (mut alone, mut left) = (false, false);
        for sample in &self.matrix.samples {
            let (here, there) = (sample >> wire & 1 == 1, sample >> twin & 1 == 1);
            (alone, left) = (alone || here && !there, left || there && !here);
        }
        alone != left
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::swap_bits;
    use crate::profile::Profile;

    /// What is found of ten-bit samples of a noisy ramp, its upper bits repeated below, behind these wires.
    fn looked(wires: impl Fn(u16) -> u16) -> Vec<(FaultKind, Option<f64>)> {
        let profile = Profile::find("vga-raw10").unwrap();
        let mut random = crate::fault::Random::new(3);
        let mut matrix = Matrix { width: 64, bits: 10, ..Matrix::default() };
        for y in 0..64u16 {
            matrix.starts.push(64 * usize::from(y));
            matrix.samples.extend((0..64).map(|x| {
                let byte = 2 * x + y + random.below(8) as u16;
                wires(byte << 2 | byte >> 6)
            }));
        }
        let data = Data::new(&profile, &matrix);
        let findings = data.findings().into_iter();
        findings.map(|found| (found.fault, found.evidence.numbers.get("a").copied())).collect()
    }

    #[test]
    fn a_short_to_a_repeated_bit_is_told_from_an_exchange() {
        let short = |a: u32, b: u32| {
            move |sample: u16| {
                let both = 1 << a | 1 << b;
                if sample & both == both { sample } else { sample & !both }
            }
        };
        assert_eq!(looked(|sample| sample), []);
        assert_eq!(looked(short(6, 8)), [(FaultKind::ShortedBits, Some(6.0))]);
        assert_eq!(looked(short(1, 4)), [(FaultKind::ShortedBits, Some(1.0))]);
        assert_eq!(looked(|sample| swap_bits(sample, 0, 6)), [(FaultKind::SwappedBits, Some(0.0))]);
    }
}
