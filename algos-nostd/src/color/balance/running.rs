//! Estimates over frames, such that the picture does not flicker.
//!
//! ```text
//! estimates   ·  · ·· ·   ·            ·· · ·· ·  ·
//! mean        ────────────────╲________────────────
//! applied     ═════════════════════╲___════════════     stands still until the mean has left its band,
//!                                                       then follows until it has caught up
//! ```
//!
//! Noise moves a single estimate, and a moving car moves the mean of the scene for a moment; neither is a new light. So
//! estimates go through an exponential mean, and the white in use changes only when that mean has moved by more
//! than a band (hysteresis). Once it moves, it goes on until it is within an eighth of the band, so that it does not stop
//! at its edge.
//!
//! **Fixed point.** Means are Q16 codes in 32 bits; a step is `difference × rate / 256`, rounded away from zero, so that
//! it arrives. Integers throughout: the same frames give the same whites on every target.

use super::White;
use crate::image::Error;

/// Follows the light over frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunningWhite {
    rate: u16,
    band: u16,
    state: Option<State>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct State {
    mean: [i64; 3],
    applied: [i64; 3],
    moving: bool,
}

impl RunningWhite {
    /// Each frame moves the mean by `rate / 256` of the way; the white in use stands still while each channel of the mean is within
    /// `band / 1024` of it.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the rate is not 1 to 256, or the band not 0 to 512.
    pub const fn new(rate: u16, band: u16) -> Result<Self, Error> {
        if rate == 0 || rate > 256 {
            return Err(Error::Parameter { name: "rate", got: rate as i64, allowed: "1 to 256" });
        }
        if band > 512 {
            return Err(Error::Parameter { name: "band", got: band as i64, allowed: "0 to 512" });
        }
        Ok(Self { rate, band, state: None })
    }

    /// Takes a frame's estimate, and gives the white to use for the next. The first is taken as it is.
    pub fn update(&mut self, estimate: White) -> White {
        let estimate = estimate.channels().map(|channel| i64::from(channel) << 8);
        let (rate, band) = (self.rate, i64::from(self.band));
        let state = self.state.get_or_insert(State { mean: estimate, applied: estimate, moving: false });
        approach(&mut state.mean, estimate, rate);
        // In eighths of the band; a distance counts in parts of the channel's own size.
        let parts = if state.moving { band } else { band * 8 };
        state.moving = state
            .mean
            .iter()
            .zip(&state.applied)
            .any(|(mean, applied)| (mean - applied).abs() * 1024 * 8 > parts * applied);
        if state.moving {
            approach(&mut state.applied, state.mean, rate);
        }
        self.white().unwrap_or(White { r: 0, g: 0, b: 0 })
    }

    /// The white in use, if there has been a frame.
    #[must_use]
    pub fn white(&self) -> Option<White> {
        let [r, g, b] = self.state?.applied.map(|channel| ((channel + 128) >> 8) as u16);
        Some(White { r, g, b })
    }

    /// Forgets the light: the next estimate is taken as it is.
    pub fn reset(&mut self) {
        self.state = None;
    }
}

/// Moves each value by `rate / 256` of the way, and by at least one unless it is there.
fn approach(values: &mut [i64; 3], goals: [i64; 3], rate: u16) {
    for (value, goal) in values.iter_mut().zip(goals) {
        let way = (goal - *value) * i64::from(rate);
        *value += (way.abs() + 255) / 256 * way.signum();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(value: u16) -> White {
        White { r: value, g: value, b: value }
    }

    #[test]
    fn noise_does_not_move_the_white() {
        let mut running = RunningWhite::new(32, 20).unwrap();
        let first = running.update(gray(30_000));
        for frame in 0..200u16 {
            // ± 1 %, within the band of 2 %.
            let estimate = gray(if frame % 3 == 0 { 30_300 } else { 29_700 });
            assert_eq!(running.update(estimate), first, "frame {frame}");
        }
    }

    #[test]
    fn a_new_light_is_reached_without_going_back_or_beyond() {
        for (from, to) in [(30_000, 20_000), (20_000, 30_000), (0, 65_280), (65_280, 0)] {
            let mut running = RunningWhite::new(64, 16).unwrap();
            let mut white = running.update(gray(from));
            let mut frames = 0;
            loop {
                let next = running.update(gray(to));
                assert!(next.r.abs_diff(to) <= white.r.abs_diff(to), "never away from the light");
                assert!((next.r >= to) == (from >= to) || next.r == to, "never beyond it");
                frames += 1;
                white = next;
                // It rests within an eighth of the band of 1/64 from the mean, which itself may still be on its way.
                if white.r.abs_diff(to) <= to / 256 || frames == 100 {
                    break;
                }
            }
            assert!(frames < 60, "{from} to {to} took {frames} frames");
        }
    }

    #[test]
    fn a_rate_of_one_follows_at_once_and_a_reset_forgets() {
        let mut running = RunningWhite::new(256, 0).unwrap();
        for value in [100, 60_000, 1, 0] {
            assert_eq!(running.update(gray(value)), gray(value));
        }
        running.reset();
        assert_eq!(running.white(), None);
        assert!(RunningWhite::new(0, 0).is_err() && RunningWhite::new(257, 0).is_err());
        assert!(RunningWhite::new(1, 513).is_err());
    }
}
