//! From the score of a rule to a probability.
//!
//! ```text
//! right, of 1
//!    1 |              ___/   of all findings with such a score in campaigns, the share whose class
//!      |         ____/       was the one put in
//!    0 |________/
//!      0       score       1
//! ```
//!
//! Isotonic regression by pooling adjacent violators (Ayer and others, "An empirical distribution function for sampling with
//! incomplete information", Annals of Mathematical Statistics 26(4), 1955), on seeds that the documented table is
//! not made of. `host-sim campaign --seeds 100 --seed-base 1000000 --clean 300 --pictures tests/data/photographs --fit`
//! prints the curve again.

/// Score, share right: from scores of which the share was measured. Between them the line is straight.
const CURVE: &[(f64, f64)] = &[
    (0.05, 0.003),
    (0.285, 0.003),
    (0.3, 0.128),
    (0.666, 0.128),
    (0.7, 0.5),
    (0.735, 0.5),
    (0.75, 0.943),
    (0.764, 0.943),
    (0.792, 0.984),
    (0.9, 0.984),
    (0.95, 0.987),
    (0.97, 0.999),
];

/// How likely a finding of this score names the right class, 0 to 1, if all classes are equally likely.
#[must_use]
pub(super) fn confidence(score: f64) -> f64 {
    let upper = CURVE.partition_point(|(at, _)| *at < score);
    match (upper.checked_sub(1).and_then(|lower| CURVE.get(lower)), CURVE.get(upper)) {
        (Some((from, low)), Some((to, high))) => low + (high - low) * (score - from) / (to - from),
        (Some((_, value)), None) | (None, Some((_, value))) => *value,
        (None, None) => score,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_higher_score_is_never_less_likely_right() {
        assert!(CURVE.is_sorted_by(|a, b| a.0 < b.0 && a.1 <= b.1), "no step, no fall");
        let steps = (0..=1_000).map(|score| confidence(f64::from(score) / 1_000.0));
        assert!(steps.clone().is_sorted());
        assert!(steps.into_iter().all(|confidence| (0.0..=1.0).contains(&confidence)));
        assert_eq!(confidence(CURVE[0].0), CURVE[0].1);
    }
}
