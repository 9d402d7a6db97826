//! A histogram of 8-bit values, counted line by line.
//!
//! ```text
//! push(line)… ─► bins[0] … bins[255]        quantile(1, 2) is the median
//! ```
//!
//! **Cost and memory.** An increment a pixel; 1 KiB. Counts saturate at 2³² − 1.

/// How often each value was seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Histogram {
    bins: [u32; 256],
}

impl Default for Histogram {
    fn default() -> Self {
        Self::new()
    }
}

impl Histogram {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { bins: [0; 256] }
    }

    /// Counts one value.
    #[inline]
    pub fn count(&mut self, value: u8) {
        let bin = &mut self.bins[usize::from(value)];
        *bin = bin.saturating_add(1);
    }

    /// Counts a line of values.
    pub fn push(&mut self, line: &[u8]) {
        line.iter().for_each(|&value| self.count(value));
    }

    /// The counts of the values 0 to 255.
    #[must_use]
    pub const fn bins(&self) -> &[u32; 256] {
        &self.bins
    }

    /// Values counted.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.bins.iter().map(|&count| u64::from(count)).sum()
    }

    /// The least value that `numerator / denominator` of the values do not exceed; `None` if nothing was counted or the
    /// fraction is not 0 to 1. The fraction 0 gives the minimum, 1 the maximum.
    #[must_use]
    pub fn quantile(&self, numerator: u32, denominator: u32) -> Option<u8> {
        let total = self.total();
        if total == 0 || denominator == 0 || numerator > denominator {
            return None;
        }
        let wanted = (total * u64::from(numerator)).div_ceil(denominator.into()).max(1);
        let mut seen = 0;
        let value = self.bins.iter().position(|&count| {
            seen += u64::from(count);
            seen >= wanted
        })?;
        Some(value as u8)
    }

    /// The mean in 1/256 of a value, to the nearest; `None` if nothing was counted.
    #[must_use]
    pub fn mean_q8(&self) -> Option<u16> {
        let total = self.total();
        let sum: u64 = self.bins.iter().zip(0u64..).map(|(&count, value)| value * u64::from(count)).sum();
        Some((sum.checked_mul(256)?.checked_add(total / 2)?).checked_div(total)? as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_stand_where_sorting_puts_them() {
        let values = [9, 3, 3, 200, 7];
        let mut histogram = Histogram::new();
        assert_eq!((histogram.quantile(1, 2), histogram.mean_q8()), (None, None));
        histogram.push(&values);
        let mut sorted = values;
        sorted.sort_unstable();
        for rank in 1..=5 {
            assert_eq!(histogram.quantile(rank, 5), Some(sorted[rank as usize - 1]));
        }
        assert_eq!(histogram.quantile(0, 1), Some(3));
        assert_eq!(histogram.quantile(2, 1), None);
        assert_eq!(histogram.mean_q8(), Some((222 * 256 + 2) / 5));
        assert_eq!((histogram.total(), histogram.bins()[3]), (5, 2));
    }
}
