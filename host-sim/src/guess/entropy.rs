//! How many bits a set of numbers takes, by an ideal code that knows how often each occurs.
//!
//! C. E. Shannon, "A mathematical theory of communication" (1948): a value that makes up p of all takes -log2 p bits. The
//! table of frequencies itself is charged half of log2 n bits an entry (J. Rissanen, "Modeling by shortest data
//! description", Automatica 14, 1978), so that few numbers do not look well described by many frequencies. Fixed point
//! with 8 fractional bits; exact on every machine.

/// Fractional bits.
pub const POINT: u32 = 8;

/// log2 in fixed point, rounded down; 0 for 0. Error below 2⁻⁸.
#[must_use]
pub fn log2(value: u64) -> u64 {
    let Some(whole) = value.checked_ilog2() else { return 0 };
    // The mantissa in [1, 2) with 31 fractional bits, squared for each bit of the result.
    let mut mantissa = if whole > 31 { value >> (whole - 31) } else { value << (31 - whole) };
    let mut result = u64::from(whole);
    for _ in 0..POINT {
        mantissa = (mantissa * mantissa) >> 31;
        result <<= 1;
        if mantissa >= 1 << 32 {
            mantissa >>= 1;
            result |= 1;
        }
    }
    result
}

/// Counts of values.
#[derive(Clone, Debug)]
pub struct Histogram {
    counts: Vec<u32>,
    mask: usize,
}

impl Histogram {
    /// For values of `bits` bits, at most 16; differences wrap, as a code for them may.
    #[must_use]
    pub fn new(bits: u32) -> Self {
        let size = 1 << bits.min(16);
        Self { counts: vec![0; size], mask: size - 1 }
    }

    /// Counts a value.
    #[inline]
    pub fn add(&mut self, value: i32) {
        self.counts[value as usize & self.mask] += 1;
    }

    /// Bits that all values take, in fixed point.
    #[must_use]
    pub fn bits(&self) -> u64 {
        let total: u64 = self.counts.iter().map(|&count| u64::from(count)).sum();
        let used = self.counts.iter().filter(|&&count| count > 0);
        let all = log2(total);
        used.map(|&count| u64::from(count) * (all - log2(u64::from(count))) + all / 2).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_are_those_of_the_definition() {
        assert_eq!([0, 1, 2, 1 << 40].map(log2), [0, 0, 256, 40 << 8]);
        for value in (1..3000).chain([65_537, 1 << 33 | 12_345, u64::MAX]) {
            let exact = (value as f64).log2() * 256.0;
            let error = exact - log2(value) as f64;
            assert!((-0.01..1.01).contains(&error), "{value}: {error}");
        }
    }

    #[test]
    fn even_odds_take_a_bit_and_certainty_none() {
        let mut coin = Histogram::new(8);
        let mut sure = Histogram::new(8);
        for n in 0..1024 {
            coin.add(n % 2 - 1);
            sure.add(-7);
        }
        // A bit each, and half of ten bits for each side of the coin; and for the one sure value.
        assert_eq!((coin.bits() >> POINT, sure.bits() >> POINT), (1024 + 10, 5));
    }
}
