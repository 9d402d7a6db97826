//! What is wrong with every line alike: all of another length.

use super::finding::{Evidence, Finding, Remedy};
use super::remedy;
use super::structure::{At, Structure, found, median};
use crate::fault::FaultKind;
use crate::profile::SyncMode;

impl Structure<'_> {
    /// What is wrong with every line alike.
    pub(super) fn common(&self) -> Vec<Finding> {
        let lengths: Vec<usize> = self.shape.lines().map(|line| line.length).collect();
        let Some(usual) = median(lengths.clone()) else { return Vec::new() };
        let near = |length: usize| lengths.iter().filter(|l| l.abs_diff(length) <= 1).count() as f64;
        let share = near(usual) / lengths.len() as f64;
        if usual == self.samples || share < 0.75 {
            return Vec::new();
        }
        let first =
            self.shape.lines().find(|line| line.length.abs_diff(usual) <= 1).map_or(0, |line| line.start);
        let at = At { clock: first as u64, line: None };
        let exact = lengths.iter().filter(|length| **length == usual).count() as f64 / lengths.len() as f64;
        let (samples, line) = (self.samples as f64, self.profile.clocks_per_line() as f64);
        let ratio = usual as f64 / samples;
        let numbers = |text: String| {
            Evidence::new(text)
                .with("samples_a_line", usual as f64)
                .with("samples_expected", samples)
                .with("period_clocks", self.period as f64)
                .with("period_expected_clocks", line)
                .with("share_of_lines", share)
        };
        let mut findings = Vec::new();
        let scaled = (self.period as f64 - ratio * line).abs() <= 2.0 + line / samples * 1.0;
        let late = self.samples > usual && self.period as f64 == line;
        let other = self.other_format(usual).filter(|_| exact > 0.95);
        let gated = self.profile.bus.sync == SyncMode::Gated;
        // Sync without blanking is scaled in any case: then every line as long as another says that clocks are not missed.
        let missed = ratio < 0.995
            && (!gated || (self.period as f64) < line - 0.5)
            && scaled
            && (gated || exact < 0.98 || other.is_none() && self.samples - usual > 16);
        if missed {
            let evidence = numbers(format!(
                "lines have {usual} samples of {} and gaps shrink alike: {:.0} % of the clocks are seen",
                self.samples,
                100.0 * ratio
            ));
            findings.push(found(
                FaultKind::Undersampling,
                0.9,
                at,
                evidence,
                remedy::of(FaultKind::Undersampling, self.profile),
            ));
        }
        if let Some(name) = other {
            let evidence = numbers(format!(
                "every line has {usual} samples, not {}: as many as {name} has",
                self.samples
            ));
            let remedy = Remedy::new(format!(
                "set the sensor to {}, or tell the profile what it sends",
                self.profile.frame.format.name()
            ))
            .profile(format!("frame.format = \"{name}\""));
            findings.push(found(
                FaultKind::FormatMismatch,
                if missed { 0.3 } else { 0.9 },
                at,
                evidence,
                remedy,
            ));
        }
        if usual < self.samples && (late || !gated) {
            let lost = self.samples - usual;
            let evidence =
                numbers(format!("every line lacks {lost} samples, and HSYNC's period is as it should be"));
            let confidence = if late {
                0.9
            } else if missed || other.is_some() {
                0.2
            } else {
                0.8
            };
            findings.push(found(
                FaultKind::LineStartLoss,
                confidence,
                at,
                evidence,
                remedy::of(FaultKind::LineStartLoss, self.profile),
            ));
        }
        if findings.is_empty() {
            let fault = if usual < self.samples { FaultKind::ShortLine } else { FaultKind::LongLine };
            let evidence = numbers(format!("every line has {usual} samples, not {}", self.samples));
            let remedy = Remedy::new("compare the sensor's window registers with the profile").profile(
                format!("frame.width = {}", usual as u32 / self.profile.frame.samples_per_pixel().max(1)),
            );
            findings.push(found(fault, 0.6, at, evidence, remedy));
        }
        findings.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        findings
    }

    /// The format of which a line has so many samples.
    fn other_format(&self, samples: usize) -> Option<&'static str> {
        use algos_nostd::pixel::format::Format;
        let width = self.profile.frame.width as usize;
        let format = match samples.checked_div(width)? {
            _ if !samples.is_multiple_of(width) || self.profile.bus.bits != 8 => return None,
            1 => Format::Gray8,
            2 => Format::Yuyv,
            3 => Format::Rgb888,
            _ => return None,
        };
        Some(format.name())
    }
}
