//! Which of many samples differ from the one before, in the bits that are watched.
//!
//! ```text
//! samples   7 7 7 7 3 3 3 3 7 7 …     64 at a time: exclusive or, mask, compare with 0: a byte each
//! bytes     0 0 0 0 1 0 0 0 1 0 …     eight of them times a constant: a byte of 64 bits
//! bits      0x…110                    count zeros: the next change
//! ```
//!
//! An oversampled capture is runs of equal samples; looking at each run once instead of at each sample is what makes it
//! fast. The first loop has no branch and is of a kind that the compiler turns into wide instructions.

use std::ops::{BitAnd, BitXor};

/// Samples looked at together.
const BLOCK: usize = 64;

/// A sample as a number that a lane of a wide register holds.
pub(super) trait Lane<const N: usize>:
    Copy + PartialEq + Default + BitXor<Output = Self> + BitAnd<Output = Self>
{
    fn load(bytes: [u8; N]) -> Self;
}

impl Lane<1> for u8 {
    #[inline(always)]
    fn load(bytes: [u8; 1]) -> Self {
        Self::from_le_bytes(bytes)
    }
}

impl Lane<2> for u16 {
    #[inline(always)]
    fn load(bytes: [u8; 2]) -> Self {
        Self::from_le_bytes(bytes)
    }
}

impl Lane<4> for u32 {
    #[inline(always)]
    fn load(bytes: [u8; 4]) -> Self {
        Self::from_le_bytes(bytes)
    }
}

impl Lane<8> for u64 {
    #[inline(always)]
    fn load(bytes: [u8; 8]) -> Self {
        Self::from_le_bytes(bytes)
    }
}

/// Calls `found` with the index of every sample but the first that differs from the one before it.
#[inline(always)]
pub(super) fn changes<const N: usize, L: Lane<N>, E>(
    samples: &[[u8; N]],
    mask: [u8; N],
    mut found: impl FnMut(usize, &[u8; N]) -> Result<(), E>,
) -> Result<(), E> {
    let mask = L::load(mask);
    let differ = |a: &[u8; N], b: &[u8; N]| (L::load(*a) ^ L::load(*b)) & mask != L::default();
    let now = samples.get(1..).unwrap_or_default();
    let (blocks, rest) = now.as_chunks::<BLOCK>();
    let (before_blocks, before_rest) = samples.get(..now.len()).unwrap_or_default().as_chunks::<BLOCK>();
    for (number, (block, before)) in blocks.iter().zip(before_blocks).enumerate() {
        let mut marks = [0_u8; BLOCK];
        for ((mark, a), b) in marks.iter_mut().zip(before).zip(block) {
            *mark = u8::from(differ(a, b));
        }
        let mut bits = packed(&marks);
        while bits != 0 {
            let at = bits.trailing_zeros() as usize % BLOCK;
            found(1 + number * BLOCK + at, &block[at])?;
            bits &= bits - 1;
        }
    }
    for (at, (a, b)) in before_rest.iter().zip(rest).enumerate() {
        if differ(a, b) {
            found(1 + blocks.len() * BLOCK + at, b)?;
        }
    }
    Ok(())
}

/// Sixty-four bytes that are 0 or 1 as bits, the first one lowest.
#[inline(always)]
fn packed(marks: &[u8; BLOCK]) -> u64 {
    let (eights, _) = marks.as_chunks::<8>();
    eights.iter().rev().fold(0, |bits, &eight| {
        // Byte i moves to bit 56 + i of the product; no other partial product reaches those bits.
        bits << 8 | u64::from_le_bytes(eight).wrapping_mul(0x0102_0408_1020_4080) >> 56
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::convert::Infallible;

    fn fast<const N: usize, L: Lane<N>>(bytes: &[u8], mask: [u8; N]) -> Vec<usize> {
        let mut found = Vec::new();
        let (samples, _) = bytes.as_chunks::<N>();
        let end = changes::<N, L, Infallible>(samples, mask, |at, sample| {
            assert_eq!(sample, &samples[at]);
            found.push(at);
            Ok(())
        });
        end.unwrap();
        found
    }

    fn naive<const N: usize>(bytes: &[u8], mask: [u8; N]) -> Vec<usize> {
        let samples: Vec<Vec<u8>> = bytes
            .chunks_exact(N)
            .map(|sample| sample.iter().zip(mask).map(|(byte, mask)| byte & mask).collect())
            .collect();
        (1..samples.len()).filter(|&at| samples[at] != samples[at - 1]).collect()
    }

    proptest! {
        #[test]
        fn changes_are_those_of_a_loop(
            runs in proptest::collection::vec((any::<[u8; 8]>(), 1..40_usize), 0..60), mask in any::<[u8; 8]>(),
        ) {
            let bytes: Vec<u8> = runs.iter().flat_map(|(bytes, count)| bytes.repeat(*count)).collect();
            let [a, b, c, d, ..] = mask;
            prop_assert_eq!(fast::<1, u8>(&bytes, [a]), naive(&bytes, [a]));
            prop_assert_eq!(fast::<2, u16>(&bytes, [a, b]), naive(&bytes, [a, b]));
            prop_assert_eq!(fast::<4, u32>(&bytes, [a, b, c, d]), naive(&bytes, [a, b, c, d]));
            prop_assert_eq!(fast::<8, u64>(&bytes, mask), naive(&bytes, mask));
        }
    }
}
