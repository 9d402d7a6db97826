//! The time stamps of a clock.
//!
//! The unit of time is the coarsest in which half a period is a whole number, 1 us to 1 ps. A clock such as 27.648 MHz
//! (36,168.98… ps) has none: then it is 1 ps and every stamp is the exact time rounded, so that errors do not add up.

/// Units of time in femtoseconds, coarsest first.
const UNITS: [(&str, u64); 7] = [
    ("1 us", 1_000_000_000),
    ("100 ns", 100_000_000),
    ("10 ns", 10_000_000),
    ("1 ns", 1_000_000),
    ("100 ps", 100_000),
    ("10 ps", 10_000),
    ("1 ps", 1_000),
];
const SECOND: u64 = 1_000_000_000_000_000;
/// The times of half periods: whole units, and the rest carried on.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Ticks {
    pub(in super::super) now: u64,
    rest: u64,
    step: u64,
    step_rest: u64,
    whole: u64,
}

impl Ticks {
    /// The times for a clock, and the name of their unit.
    pub(super) fn new(hertz: u32) -> (Self, &'static str) {
        let halves = 2 * u64::from(hertz);
        let fits = |&&(_, unit): &&(&str, u64)| (SECOND / unit).is_multiple_of(halves);
        let (name, unit) = UNITS.iter().find(fits).copied().unwrap_or(("1 ps", 1_000));
        (Self::of(SECOND / unit, halves), name)
    }

    /// The times for a clock in picoseconds.
    pub(in super::super) fn in_picoseconds(hertz: u32) -> Self {
        Self::of(SECOND / 1_000, 2 * u64::from(hertz))
    }

    fn of(second: u64, halves: u64) -> Self {
        // Beginning with half a unit turns cutting off into rounding.
        Self { now: 0, rest: halves / 2, step: second / halves, step_rest: second % halves, whole: halves }
    }

    pub(in super::super) fn advance(&mut self) {
        self.now += self.step;
        self.rest += self.step_rest;
        if self.rest >= self.whole {
            self.rest -= self.whole;
            self.now += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact_or_rounded_without_drift() {
        for (hertz, unit) in [
            (1, "1 us"),
            (10_000_000, "10 ns"),
            (20_000_000, "1 ns"),
            (25_000_000, "10 ns"),
            (24_000_000, "1 ps"),
        ] {
            assert_eq!(Ticks::new(hertz).1, unit, "{hertz}");
        }
        let (mut ticks, _) = Ticks::new(27_648_000);
        for half in 0..100_000_u128 {
            let exact = half * 1_000_000_000_000;
            let rounded = (exact + 27_648_000) / (2 * 27_648_000);
            assert_eq!(u128::from(ticks.now), rounded, "{half}");
            ticks.advance();
        }
    }
}
