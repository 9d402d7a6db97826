//! What the samples say: the picture is not known, but pictures of the world are smooth.
//!
//! | what | how it shows | file |
//! |---|---|---|
//! | stuck, shorted, shifted wires | bits that never change, pairs that never differ, values that wrap | `wires` |
//! | swapped wires, reversed bus, swapped bytes, another format | undoing it makes the picture cost less (`planes`) | `orders` |
//! | bytes that slip | the end of each line is idle bus, or belongs to the next line | `slip` |
//! | another mosaic | the sites that should be green differ more among themselves than the others | `mosaic` |

use super::finding::{Finding, Remedy};
use super::planes::{Matrix, cost};
use super::remedy;
use super::statistics::Statistics;
use super::structure::At;
use crate::fault::FaultKind;
use crate::profile::Profile;

/// Lines that are looked at, at most: two frames of VGA.
pub(super) const MOST_LINES: usize = 1_000;
/// Fewest samples from which anything is concluded.
const FEWEST: usize = 2_000;
/// Fewest different values of a picture from which its bits are judged.
pub(super) const VALUES: usize = 24;

/// The samples of a trace, judged by a profile.
pub(super) struct Data<'a> {
    pub(super) profile: &'a Profile,
    pub(super) matrix: &'a Matrix,
    pub(super) statistics: Statistics,
    /// Bits that a sample costs as the profile reads it.
    pub(super) cost: f64,
    pub(super) at: At,
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

    pub(super) fn remedy(&self, kind: FaultKind) -> Remedy {
        remedy::of(kind, self.profile)
    }
}
