//! How often findings of a stated confidence were right: the reliability table, and the curve that makes it so.

use std::collections::BTreeMap;
use std::fmt;

use super::case::CaseResult;

/// Lower ends of the table's bins, in thousandths.
const BINS: [u32; 8] = [0, 50, 200, 400, 600, 800, 950, 990];

/// Findings of one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Bin {
    findings: u64,
    /// Thousandths of confidence in all.
    stated: u64,
    right: u64,
}

/// Findings of a campaign by what was stated and what was true. A finding on a clean trace is a wrong one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reliability {
    bins: [Bin; BINS.len()],
    /// Findings and right ones by their score in thousandths.
    scores: BTreeMap<u32, (u64, u64)>,
}

impl Reliability {
    /// Counts results.
    #[must_use]
    pub fn of(results: &[CaseResult]) -> Self {
        let mut reliability = Self::default();
        for result in results {
            for &(found, confidence, score) in &result.found {
                let right = u64::from(result.class == Some(found));
                let bin = BINS.partition_point(|least| *least <= confidence) - 1;
                let bin = &mut reliability.bins[bin];
                bin.findings += 1;
                bin.stated += u64::from(confidence);
                bin.right += right;
                let (all, rights) = reliability.scores.entry(score).or_default();
                (*all, *rights) = (*all + 1, *rights + right);
            }
        }
        reliability
    }

    /// How far stated and observed are apart in the mean over all findings, 0 to 1: the expected calibration error
    /// (Naeini, Cooper and Hauskrecht, AAAI 2015), on the bins of the table.
    #[must_use]
    pub fn error(&self) -> f64 {
        let findings: u64 = self.bins.iter().map(|bin| bin.findings).sum();
        let apart = |bin: &Bin| (bin.stated as f64 / 1000.0 - bin.right as f64).abs();
        self.bins.iter().map(apart).sum::<f64>() / findings.max(1) as f64
    }

    /// Score and share right, never falling: isotonic regression by pooling adjacent violators.
    #[must_use]
    pub fn curve(&self) -> Vec<(f64, f64)> {
        // Lowest and highest score of a block, findings, right ones. A finding and half a right one more keep 0 and 1 away.
        let mut blocks: Vec<(u32, u32, u64, u64)> = Vec::new();
        for (&score, &(findings, right)) in &self.scores {
            blocks.push((score, score, findings, right));
            while let [.., (from, _, all, rights), (_, to, more, more_right)] = blocks[..]
                && rights * more >= more_right * all
            {
                blocks.truncate(blocks.len() - 2);
                blocks.push((from, to, all + more, rights + more_right));
            }
        }
        let mut curve = Vec::new();
        for (from, to, findings, right) in blocks {
            let share = (right as f64 + 0.5) / (findings as f64 + 1.0);
            let share = (share * 1000.0).round() / 1000.0;
            curve.push((f64::from(from) / 1000.0, share));
            if to > from {
                curve.push((f64::from(to) / 1000.0, share));
            }
        }
        // Smoothing may lower a block of few findings below the one before it.
        let mut least = 0.0;
        for (_, share) in &mut curve {
            least = f64::max(least, *share);
            *share = least;
        }
        curve
    }
}

impl fmt::Display for Reliability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "| stated | findings | stated in the mean | right |")?;
        writeln!(f, "|---|---:|---:|---:|")?;
        let ends = BINS[1..].iter().chain([&1000]);
        for ((from, to), bin) in BINS.iter().zip(ends).zip(&self.bins) {
            let percent = |sum: f64| format!("{:.1} %", 100.0 * sum / bin.findings.max(1) as f64);
            let range = format!("{} to {} %", f64::from(*from) / 10.0, f64::from(*to) / 10.0);
            if bin.findings == 0 {
                writeln!(f, "| {range} | 0 | | |")?;
            } else {
                let (stated, right) = (percent(bin.stated as f64 / 1000.0), percent(bin.right as f64));
                writeln!(f, "| {range} | {} | {stated} | {right} |", bin.findings)?;
            }
        }
        write!(f, "\nStated and observed are {:.2} % apart in the mean.", 100.0 * self.error())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::FaultKind;

    #[test]
    fn the_curve_pools_what_falls_and_the_error_is_the_mean_distance() {
        let case = |score: u32, right: bool| CaseResult {
            case: 0,
            profile: String::new(),
            scene: String::new(),
            class: right.then_some(FaultKind::StuckBit),
            fault: String::new(),
            seed: 0,
            intact: false,
            found: vec![(FaultKind::StuckBit, score, score)],
        };
        let results: Vec<CaseResult> = [(300, 1, 4), (500, 3, 4), (600, 1, 4), (960, 4, 4)]
            .into_iter()
            .flat_map(|(score, right, all)| (0..all).map(move |number| case(score, number < right)))
            .collect();
        let reliability = Reliability::of(&results);
        let expected = [(0.3, 0.3), (0.5, 0.5), (0.6, 0.5), (0.96, 0.9)];
        assert_eq!(reliability.curve(), expected, "1 of 4, 4 of 8, 4 of 4; half a one more each");
        let error = (0.2 + 1.0 + 1.4 + 0.16) / 16.0;
        assert!((reliability.error() - error).abs() < 1e-9, "{}", reliability.error());
        let text = reliability.to_string();
        assert!(text.contains("| 95 to 99 % | 4 | 96.0 % | 100.0 % |"), "{text}");
        assert!(text.contains("| 80 to 95 % | 0 | | |"), "{text}");
    }
}
