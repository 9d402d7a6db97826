//! Orders of wires and bytes, and formats, which make the picture cost less once they are undone.

use std::collections::BTreeSet;

use algos_nostd::pixel::format::Format;

use super::data::{Data, VALUES};
use super::finding::{Evidence, Finding, Remedy};
use super::planes::{cost, fine_cost};
use super::structure::found;
use crate::fault::{FaultKind, reverse_bits, swap_bits};

/// A wrong order is undone if that saves at least this share of the cost, and so many bits a sample.
const SAVES: (f64, f64) = (0.003, 0.008);
/// The same for another format or byte order, whose planes are other samples.
const FORMAT_SAVES: (f64, f64) = (0.08, 0.15);
const TWIN_SAVES: (f64, f64) = (0.01, 0.015);

impl Data<'_> {
    /// Orders of bits and bytes which, undone, make the picture cost less.
    pub(super) fn orders(&self) -> Vec<Finding> {
        let format = self.profile.frame.format;
        let bits = self.matrix.bits;
        if self.statistics.values < VALUES || self.cost < 0.05 {
            return Vec::new();
        }
        let fine = fine_cost(self.matrix, format);
        // What undoing it saves in bits a sample, and what the picture costs then.
        let mut tried: Vec<(f64, f64, FaultKind, String, Remedy)> = Vec::new();
        let mut wires = std::collections::BTreeMap::new();
        for a in 0..bits {
            for b in a + 1..bits {
                if !self.restores_repeats(a, b) {
                    continue;
                }
                let undone = fine_cost(&self.matrix.map(|sample| swap_bits(sample, a, b)), format);
                let how = format!("with D{a} and D{b} exchanged");
                wires.insert(how.clone(), (a, b));
                let remedy = format!("exchange D{a} and D{b}, on the board or with --map D{a}=…,D{b}=…");
                tried.push((fine - undone, undone, FaultKind::SwappedBits, how, Remedy::new(remedy)));
            }
        }
        if self.profile.frame.is_bayer() {
            // Colours alternate either way, so only distances tell: 1 0 3 2 has neighbours that are three apart.
            let (within, across) = self.pairs();
            if across > 1.1 * within && across > 1.0 {
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
        let undone = fine_cost(&self.matrix.map(|sample| reverse_bits(sample, bits)), format);
        let how = "with the bus reversed".to_owned();
        let kind = FaultKind::ReversedBus;
        tried.push((fine - undone, undone, kind, how, self.remedy(kind)));
        let twin = twin(format);
        if twin.is_none() && !self.profile.frame.is_bayer() {
            let undone = fine_cost(&self.matrix.swapped(), format);
            let how = "with neighbouring samples exchanged".to_owned();
            let kind = FaultKind::ByteSwap;
            tried.push((fine - undone, undone, kind, how, self.remedy(kind)));
        }
        let most = tried.iter().map(|tried| tried.0).fold(0.0, f64::max);
        for &other in others(format) {
            let is_twin = Some(other) == twin;
            let kind = if is_twin { FaultKind::ByteSwap } else { FaultKind::FormatMismatch };
            let undone = cost(self.matrix, other);
            let saved = self.cost - undone;
            // Planes of other formats are of other widths, so a little less says nothing; a twin's are not.
            let (share, least) = if is_twin { TWIN_SAVES } else { FORMAT_SAVES };
            if saved > least.max(share * self.cost) && saved > most {
                let remedy = self.remedy(kind).profile(format!("frame.format = \"{}\"", other.name()));
                tried.push((saved, undone, kind, format!("read as {}", other.name()), remedy));
            }
        }
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        let Some((most, best)) = tried.first().map(|tried| (tried.0, tried.1)) else { return Vec::new() };
        // What is undone must look like a picture, not like noise.
        let least = if self.repeats_moved() { f64::NEG_INFINITY } else { SAVES.1.max(SAVES.0 * fine) };
        if best > 0.9 * f64::from(bits.min(8)) || most < least {
            return self.no_colour_differences().into_iter().collect();
        }
        let mut kinds = BTreeSet::new();
        let mut findings = Vec::new();
        for (saved, undone, kind, how, remedy) in tried {
            if saved < 0.5 * most || saved <= 0.0 && saved < most || !kinds.insert(kind) {
                continue;
            }
            let mut evidence = Evidence::new(format!(
                "{how} the picture takes {undone:.3} bits a sample, as it is {:.3}",
                undone + saved
            ))
            .with("bits_a_sample", undone + saved)
            .with("bits_a_sample_undone", undone);
            if let Some((a, b)) = wires.get(&how) {
                evidence = evidence.with("a", f64::from(*a)).with("b", f64::from(*b));
            }
            findings.push(found(kind, confidence(saved, most), self.at, evidence, remedy));
        }
        findings
    }

    /// What should be colour differences is not about the middle, which is no colour.
    fn no_colour_differences(&self) -> Option<Finding> {
        let mean = self.chroma().filter(|mean| !(64.0..192.0).contains(mean))?;
        let costs = others(self.profile.frame.format).iter().map(|&other| (cost(self.matrix, other), other));
        let (_, other) = costs.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let text = format!(
            "what {} has for colour differences is {mean:.0} in the mean, where no colour is 128",
            self.profile.frame.format.name()
        );
        let kind = FaultKind::FormatMismatch;
        let remedy = self.remedy(kind).profile(format!("frame.format = \"{}\"", other.name()));
        Some(found(kind, 0.7, self.at, Evidence::new(text).with("mean_colour_difference", mean), remedy))
    }

    /// A wide bus repeats the upper bits below, and they are not where they should be: wires have changed places.
    fn repeats_moved(&self) -> bool {
        !self.restores_repeats(0, 0)
    }

    /// Whether exchanging two wires leaves, or puts, the bits where a wide bus repeats the upper ones; true if nothing
    /// is repeated.
    fn restores_repeats(&self, a: u32, b: u32) -> bool {
        let bits = self.matrix.bits;
        let repeats: BTreeSet<(u32, u32)> = (8..bits).map(|wire| (wire - 8, wire)).collect();
        let equal = &self.statistics.equal;
        if repeats.is_empty() || equal.len() != repeats.len() {
            return true;
        }
        let other = |wire: u32| {
            if wire == a {
                b
            } else if wire == b {
                a
            } else {
                wire
            }
        };
        let ordered = |(c, d): (u32, u32)| (c.min(d), c.max(d));
        equal.iter().map(|&(c, d)| ordered((other(c), other(d)))).collect::<BTreeSet<_>>() == repeats
    }

    /// How far the detail of neighbours is apart, within pairs of samples and across.
    pub(super) fn pairs(&self) -> (f64, f64) {
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
}

/// By the share of the best saving.
fn confidence(saved: f64, most: f64) -> f64 {
    if saved >= most { 0.95 } else { 0.05 + 0.9 * saved / most }
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
