use std::time::Instant;

/// Bits of a byte on a UART with 8N1.
const BITS: f64 = 10.0;

/// How fast bytes may leave: a UART's rate, or as fast as they are taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    bytes_per_second: Option<f64>,
    /// Bytes that the line has had time for.
    credit: f64,
    /// Since when the line has been busy; `None` while it is idle.
    since: Option<Instant>,
}

impl Pace {
    pub(super) fn new(baud: Option<u32>) -> Self {
        Self { bytes_per_second: baud.map(|baud| f64::from(baud) / BITS), credit: 0.0, since: None }
    }

    pub(super) fn bytes_per_second(&self) -> Option<f64> {
        self.bytes_per_second
    }

    /// How many of the bytes that wait may leave by now. An idle line saves nothing up.
    pub(super) fn allow(&mut self, now: Instant, waiting: usize) -> usize {
        let Some(rate) = self.bytes_per_second else { return waiting };
        if waiting == 0 {
            (self.credit, self.since) = (0.0, None);
            return 0;
        }
        if let Some(since) = self.since {
            self.credit += now.saturating_duration_since(since).as_secs_f64() * rate;
        }
        self.since = Some(now);
        self.credit = self.credit.min(waiting as f64);
        self.credit as usize
    }

    /// So many bytes left.
    pub(super) fn spend(&mut self, bytes: usize) {
        self.credit = (self.credit - bytes as f64).max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_line_carries_what_it_has_time_for() {
        let mut pace = Pace::new(Some(921_600));
        let start = Instant::now();
        let at = |milliseconds| start + Duration::from_millis(milliseconds);
        assert_eq!(pace.allow(at(0), 10_000), 0);
        assert_eq!(pace.allow(at(10), 10_000), 921);
        pace.spend(921);
        assert_eq!(pace.allow(at(20), 10_000 - 921), 922);
        pace.spend(922);
        // Whatever the processor did meanwhile, the line was busy.
        assert_eq!(pace.allow(at(1000), 8157), 8157);
        pace.spend(8157);
        assert_eq!(pace.allow(at(2000), 0), 0);
        assert_eq!(pace.allow(at(3000), 50), 0);
        assert_eq!(Pace::new(None).allow(start, 7), 7);
    }
}
