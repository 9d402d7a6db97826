use serde::Serialize;

/// FIFO and DMA over time, in a bounded number of buckets however long the trace is.
///
/// ```text
/// level     1 2 3 0 │ 1 2 3 0 │ …      buckets of 4 clocks, and when there are too many of them …
/// buckets   0…3     │ 0…3     │ …
/// buckets   0…3               │ …      … pairs are joined: twice the clocks, least and most kept
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Activity {
    /// Pixel clocks a bucket; the last one may have fewer.
    pub bucket_clocks: u64,
    /// In the order of time.
    pub buckets: Vec<Bucket>,
    #[serde(skip)]
    most: usize,
}

/// What happened in a stretch of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Bucket {
    /// Pixel clocks.
    pub clocks: u64,
    /// Least words seen in the FIFO.
    pub least: u8,
    /// Most words seen in the FIFO.
    pub most: u8,
    /// Bursts that the DMA asked the bus for.
    pub requests: u64,
    /// Frames that overran.
    pub overruns: u32,
}

impl Bucket {
    fn join(self, later: Self) -> Self {
        if self.clocks == 0 {
            return later;
        }
        Self {
            clocks: self.clocks + later.clocks,
            least: self.least.min(later.least),
            most: self.most.max(later.most),
            requests: self.requests + later.requests,
            overruns: self.overruns + later.overruns,
        }
    }
}

impl Activity {
    /// Pixel clocks from one look to the next: those of a word on a bus of 8 bits.
    pub const LOOK: usize = 4;

    /// Nothing seen yet; never more than `most` buckets, and at least two.
    #[must_use]
    pub fn new(most: usize) -> Self {
        Self { bucket_clocks: Self::LOOK as u64, buckets: Vec::new(), most: most.max(2) }
    }

    /// Clocks have passed, at whose end the FIFO has so many words.
    pub fn add(&mut self, seen: Bucket) {
        match self.buckets.last_mut() {
            Some(last) if last.clocks + seen.clocks <= self.bucket_clocks => *last = last.join(seen),
            _ => {
                self.buckets.push(seen);
                if self.buckets.len() > self.most {
                    self.bucket_clocks *= 2;
                    self.buckets = self.buckets.chunks(2).map(joined).collect();
                }
            }
        }
    }

    /// Pixel clocks seen.
    #[must_use]
    pub fn clocks(&self) -> u64 {
        self.buckets.iter().map(|bucket| bucket.clocks).sum()
    }
}

fn joined(buckets: &[Bucket]) -> Bucket {
    buckets.iter().fold(Bucket::default(), |sum, bucket| sum.join(*bucket))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Joining forgets times, and neither extremes nor sums.
        #[test]
        fn nothing_is_lost_but_time(levels in prop::collection::vec((0u8..5, 0u64..3, 1u64..5), 1..400), most in 2usize..40) {
            let mut activity = Activity::new(most);
            for &(level, requests, clocks) in &levels {
                activity.add(Bucket { clocks, least: level, most: level, requests, overruns: u32::from(level == 4) });
            }
            let all = joined(&activity.buckets);
            prop_assert!(activity.buckets.len() <= most);
            prop_assert!(activity.buckets.iter().all(|bucket| bucket.clocks <= activity.bucket_clocks));
            prop_assert_eq!(all.least, levels.iter().map(|seen| seen.0).min().unwrap());
            prop_assert_eq!(all.most, levels.iter().map(|seen| seen.0).max().unwrap());
            prop_assert_eq!(all.requests, levels.iter().map(|seen| seen.1).sum::<u64>());
            prop_assert_eq!(activity.clocks(), levels.iter().map(|seen| seen.2).sum::<u64>());
            prop_assert_eq!(all.overruns as usize, levels.iter().filter(|seen| seen.0 == 4).count());
        }
    }
}
