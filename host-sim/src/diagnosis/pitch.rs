//! The line's period as the picture tells it, whatever sync says.
//!
//! ```text
//! sample k against sample k + lag:   ‾‾‾\__/‾‾‾‾‾‾‾‾‾‾‾   mean distance
//!                                       312     480       lag: lines have 312 clocks, not 480
//! ```
//!
//! A line of a picture looks like the one above it. Where clocks are missed evenly, marks of sync are missed with them,
//! but the picture still repeats.

use super::finding::{Evidence, Finding};
use super::recording::Recording;
use super::remedy;
use super::shape::Shape;
use super::structure::{At, found, median};
use crate::fault::FaultKind;
use crate::profile::{Profile, SyncMode};

/// Samples that are compared at each lag.
const COMPARED: usize = 4_096;

/// The lag at which the samples repeat best, if one stands out and it is not the claimed one.
fn pitch(samples: &[u16], claimed: usize) -> Option<usize> {
    let (least, most) = ((claimed / 10).max(8), claimed + claimed / 50 + 1);
    let room = samples.len().checked_sub(most + 1).filter(|room| *room > 4 * claimed)?;
    let stride = (room / COMPARED).max(1);
    let distance = |lag: usize| {
        (0..room).step_by(stride).map(|at| u64::from(samples[at].abs_diff(samples[at + lag]))).sum::<u64>()
    };
    let distances: Vec<u64> = (least..=most).map(distance).collect();
    let at = |lag: usize| distances[lag - least];
    let (best, lowest) = distances.iter().enumerate().min_by_key(|(_, distance)| **distance)?;
    let best = best + least;
    let mut sorted = distances.clone();
    sorted.sort_unstable();
    let usual = sorted[sorted.len() / 2];
    // Every second line is alike as well.
    let lag = (2..=best / least)
        .rev()
        .flat_map(|lines| [best / lines, best / lines + 1])
        .find(|lag| *lag >= least && at(*lag) * 10 <= lowest * 11)
        .unwrap_or(best);
    (4 * at(lag) < 3 * usual && 20 * at(lag) < 17 * at(claimed)).then_some(lag)
}

/// Clocks that are missed evenly, where the marks of sync were missed with them.
pub(super) fn missed_clocks(recording: &Recording, profile: &Profile, shape: &Shape) -> Option<Finding> {
    // A level is not missed, and lines that sync cuts alike speak for themselves.
    let cut = |length: usize| shape.lines().filter(|line| line.length.abs_diff(length) <= 1).count();
    let usual = median(shape.lines().map(|line| line.length).collect()).unwrap_or(0);
    let alike = cut(usual) * 4 > shape.lines().count() * 3;
    let regular = alike && usual <= profile.samples_per_line() as usize;
    if profile.bus.sync == SyncMode::Gated || shape.fit(profile) > 0.5 || regular {
        return None;
    }
    let claimed = profile.clocks_per_line() as usize;
    let lag = pitch(&recording.samples, claimed)?;
    let percent = 100.0 * lag as f64 / claimed as f64;
    if percent > 99.5 {
        return None;
    }
    let text = format!(
        "the picture repeats every {lag} clocks, not every {claimed}, and marks of sync are missing: {percent:.0} % of the \
         clocks are seen"
    );
    let evidence = Evidence::new(text)
        .with("period_clocks", lag as f64)
        .with("period_expected_clocks", claimed as f64)
        .with("samples_between_marks", usual as f64);
    let kind = FaultKind::Undersampling;
    Some(found(kind, 0.9, At::default(), evidence, remedy::of(kind, profile)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_tells_its_pitch() {
        let mut random = crate::fault::Random::new(7);
        let line: Vec<u16> = (0..300).map(|_| random.below(200) as u16).collect();
        let picture: Vec<u16> = (0..40).flat_map(|y| line.iter().map(move |value| value + y)).collect();
        assert_eq!(pitch(&picture, 400), Some(300));
        assert_eq!(pitch(&picture, 300), None, "as claimed");
        let noise: Vec<u16> = (0..12_000).map(|_| random.below(256) as u16).collect();
        assert_eq!(pitch(&noise, 400), None);
    }
}
