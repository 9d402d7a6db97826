//! The memory bus between FIFO and RAM: how long a burst waits for its grant.
//!
//! Times are pixel clocks, because that is what fills the FIFO meanwhile. The delay of the n-th request is a function of
//! the seed and n alone, so that a stretch of requests can be worked out without playing each of them, and a failure
//! repeats exactly.

/// When bursts are granted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bus {
    /// Least pixel clocks from request to grant, beyond the one that a grant takes.
    pub latency_min: u32,
    /// Most of them. Delays are spread evenly between the two.
    pub latency_max: u32,
    /// Longer waits, now and then.
    pub stall: Option<Stall>,
    /// The n-th request (from 0) waits this many clocks more: a fault put in on purpose.
    pub hold: Option<Hold>,
    /// The n-th request (from 0) is answered by a bus error, on which the DMA stops: a fault put in on purpose.
    pub error: Option<u64>,
    /// Seed of delays and stalls.
    pub seed: u64,
}

/// Waits that happen at random.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stall {
    /// One request in this many stalls, on average; 0 and 1 mean all.
    pub one_in: u32,
    /// Pixel clocks added.
    pub clocks: u32,
}

/// A wait put in on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hold {
    /// Which request, counted from 0 since the block was made.
    pub request: u64,
    /// Pixel clocks added.
    pub clocks: u32,
}

impl Bus {
    /// Grants at the next clock, always.
    pub const IDEAL: Self =
        Self { latency_min: 0, latency_max: 0, stall: None, hold: None, error: None, seed: 0 };

    /// Pixel clocks that request `number` waits beyond the one that a grant takes.
    #[must_use]
    pub fn delay(&self, number: u64) -> u32 {
        let mut delay = self.latency_min;
        if self.latency_max > self.latency_min || self.stall.is_some() {
            let random = mix(self.seed.wrapping_add(number.wrapping_mul(0x9E37_79B9_7F4A_7C15)));
            let span = u64::from(self.latency_max.saturating_sub(self.latency_min)) + 1;
            // Multiply-high spreads the low half evenly over the span.
            delay += (((random & 0xFFFF_FFFF) * span) >> 32) as u32;
            if let Some(stall) = self.stall
                && ((random >> 32) * u64::from(stall.one_in.max(1))) >> 32 == 0
            {
                delay = delay.saturating_add(stall.clocks);
            }
        }
        match self.hold {
            Some(hold) if hold.request == number => delay.saturating_add(hold.clocks),
            _ => delay,
        }
    }

    /// A bound on [`Bus::delay`] for the requests `from` to `to - 1`.
    #[must_use]
    pub fn delay_bound(&self, from: u64, to: u64) -> u32 {
        let held = match self.hold {
            Some(hold) if (from..to).contains(&hold.request) => hold.clocks,
            _ => 0,
        };
        let stall = self.stall.map_or(0, |stall| stall.clocks);
        self.latency_max.max(self.latency_min).saturating_add(stall).saturating_add(held)
    }
}

impl Default for Bus {
    fn default() -> Self {
        Self::IDEAL
    }
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): spreads the bits of a counter.
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_keep_to_their_bounds_and_use_them() {
        let stall = Some(Stall { one_in: 10, clocks: 100 });
        let bus = Bus { latency_min: 2, latency_max: 5, stall, seed: 7, ..Bus::IDEAL };
        let delays: Vec<u32> = (0..10_000).map(|n| bus.delay(n)).collect();
        let stalled = delays.iter().filter(|&&delay| delay >= 100).count();
        assert!((800..1200).contains(&stalled), "{stalled} of 10,000 stalled");
        assert!(delays.iter().all(|&delay| delay <= bus.delay_bound(0, 10_000)));
        for latency in 2..=5 {
            let count = delays.iter().filter(|&&delay| delay % 100 == latency).count();
            assert!((2200..2800).contains(&count), "latency {latency} came {count} times");
        }
    }

    #[test]
    fn a_hold_meets_one_request() {
        let bus = Bus { hold: Some(Hold { request: 3, clocks: 9 }), ..Bus::IDEAL };
        assert_eq!([0, 1, 2, 3, 4].map(|n| bus.delay(n)), [0, 0, 0, 9, 0]);
        assert_eq!(bus.delay_bound(0, 3), 0);
        assert_eq!(bus.delay_bound(3, 4), 9);
    }
}
