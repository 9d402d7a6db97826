//! Non-maximum suppression: of an edge's slope only the crest stays, one pixel wide.
//!
//! ```text
//! magnitude   1 3 7 9 6 2          kept   . . . # . .         compared along the gradient, in one of
//!             1 2 6 9 7 3                 . . . # . .         four directions:  ─  ╲  │  ╱
//! ```
//!
//! Reference: J. Canny, IEEE PAMI 8(6), 1986, in the form of the textbooks: the gradient's direction is rounded to one of
//! four, and the pixel must be higher than its two neighbours that way.
//!
//! The direction is exact. With `a = |gx|` and `b = |gy|` the gradient is nearer to the horizontal than to a diagonal if
//! `b < a · tan 22.5° = a (√2 − 1)`, that is `a + b < √2 a`, and as both sides are not negative, `(a + b)² < 2 a²`: integers
//! only. Equality would need a rational √2, so there are no ties, save where `a = b = 0` and nothing is an edge. In the
//! same way `(a + b)² < 2 b²` is vertical, and what is neither is diagonal. As `a + b ≤ 40,544` (see [`super::smooth`]),
//! everything fits 32 bits.
//!
//! Ties in magnitude: a pixel is kept if it is higher than the neighbour that comes first in reading order and *not
//! lower* than the one that comes after. So a crest of two equal pixels keeps its first, never none or both. Outside the
//! picture the magnitude is 0.
//!
//! Memory: three rows of magnitudes, one of gradients. Cost: a comparison a pixel; where the host has vector units, every
//! pixel of a word with a magnitude above the lower threshold is then tested without a branch, and where it has not, only
//! the pixels above the threshold are, one by one.

use super::bits::PIXELS_A_WORD;

/// What the line part of Canny knows of 32 pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Marks {
    /// Crests above the lower threshold, pixel 0 in bit 0.
    pub candidates: u32,
    /// Those of them above the upper threshold.
    pub strong: u32,
}

/// Rows of a gradient, each of a whole number of words of pixels; magnitudes have one more at either end, and zeros
/// past the width.
pub(super) struct Crest<'a> {
    pub(super) above: &'a [u32],
    pub(super) here: &'a [u32],
    pub(super) below: &'a [u32],
    pub(super) x: &'a [i16],
    pub(super) y: &'a [i16],
    /// What a candidate must exceed, on the magnitudes' scale.
    pub(super) low: u32,
    /// What a strong pixel must exceed.
    pub(super) high: u32,
}

/// A word of pixels and the one before and after.
const WINDOW: usize = PIXELS_A_WORD + 2;
/// Magnitudes of the line above, this one and the one below.
type Rows<'a> = [&'a [u32; WINDOW]; 3];

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
pub(super) fn suppress(crest: &Crest<'_>, marks: &mut [Marks]) {
    for (word, marks) in marks.iter_mut().enumerate() {
        *marks = Marks::default();
        let start = word * PIXELS_A_WORD;
        let (Some(above), Some(here), Some(below), Some(x), Some(y)) = (
            chunk::<_, WINDOW>(crest.above, start),
            chunk::<_, WINDOW>(crest.here, start),
            chunk::<_, WINDOW>(crest.below, start),
            chunk::<_, PIXELS_A_WORD>(crest.x, start),
            chunk::<_, PIXELS_A_WORD>(crest.y, start),
        ) else {
            return; // rows are whole numbers of words
        };
        let rows = [above, here, below];
        *marks = if cfg!(feature = "std") {
            every_pixel(rows, x, y, crest.low, crest.high)
        } else {
            pixels_above(rows, x, y, crest.low, crest.high)
        };
    }
}

/// So many elements from `start` on.
#[inline(always)]
fn chunk<T, const N: usize>(row: &[T], start: usize) -> Option<&[T; N]> {
    row.get(start..)?.first_chunk()
}

/// All pixels alike, without a branch: for vector units.
#[inline(always)]
fn every_pixel(
    rows: Rows<'_>,
    x: &[i16; PIXELS_A_WORD],
    y: &[i16; PIXELS_A_WORD],
    low: u32,
    high: u32,
) -> Marks {
    // Loops, not closures: the compiler doesn't inline a closure of a function with more vector units than its callee.
    let mut peak = 0;
    for &magnitude in &rows[1][1..=PIXELS_A_WORD] {
        peak = magnitude.max(peak);
    }
    if peak <= low {
        return Marks::default();
    }
    // 1 for a candidate, 3 for a strong one.
    let mut levels = [0; PIXELS_A_WORD];
    for i in 0..PIXELS_A_WORD {
        let magnitude = rows[1][i + 1];
        let level = (mask(magnitude > low) & 1) | (mask(magnitude > high) & 2);
        levels[i] = (level & crest(rows, i, x[i], y[i])) as u8;
    }
    Marks { candidates: gather(&levels, 0), strong: gather(&levels, 1) }
}

/// Only pixels above the lower threshold, found as bits first: for a processor that takes one at a time.
#[inline(always)]
fn pixels_above(
    rows: Rows<'_>,
    x: &[i16; PIXELS_A_WORD],
    y: &[i16; PIXELS_A_WORD],
    low: u32,
    high: u32,
) -> Marks {
    // Magnitudes are below 2³¹, so that a difference has the sign of the comparison.
    let limit = low.min(i32::MAX as u32);
    let mut above = 0;
    for &magnitude in &rows[1][1..=PIXELS_A_WORD] {
        above = above << 1 | limit.wrapping_sub(magnitude) >> 31;
    }
    let mut marks = Marks::default();
    while above != 0 {
        // Pixel 0 is in the highest bit.
        let i = above.leading_zeros();
        let bit = 1 << (31 - i);
        above ^= bit;
        if is_crest(rows, i as usize % PIXELS_A_WORD, x, y) {
            marks.candidates |= bit;
            marks.strong |= if rows[1][i as usize % PIXELS_A_WORD + 1] > high { bit } else { 0 };
        }
    }
    Marks { candidates: marks.candidates.reverse_bits(), strong: marks.strong.reverse_bits() }
}

/// [`crest`] by branches, which a processor that does not guess takes for little.
#[inline(always)]
fn is_crest(
    [above, here, below]: Rows<'_>,
    i: usize,
    x: &[i16; PIXELS_A_WORD],
    y: &[i16; PIXELS_A_WORD],
) -> bool {
    let (a, b) = (u32::from(x[i].unsigned_abs()), u32::from(y[i].unsigned_abs()));
    let diagonal = (a + b) * (a + b);
    let (before, after) = if diagonal < 2 * a * a {
        (here[i], here[i + 2])
    } else if diagonal < 2 * b * b {
        (above[i + 1], below[i + 1])
    } else if x[i] ^ y[i] >= 0 {
        (above[i], below[i + 2])
    } else {
        (above[i + 2], below[i])
    };
    here[i + 1] > before && here[i + 1] >= after
}

/// Whether pixel `i` of the middle row (whose element `i + 1` it is) is higher than its neighbours along the
/// gradient `x`, `y`: all ones or none.
#[inline(always)]
fn crest([above, here, below]: Rows<'_>, i: usize, x: i16, y: i16) -> u32 {
    let (a, b) = (u32::from(x.unsigned_abs()), u32::from(y.unsigned_abs()));
    let diagonal = (a + b) * (a + b);
    let horizontal = mask(diagonal < 2 * a * a);
    let vertical = mask(diagonal < 2 * b * b);
    let falling = mask((x ^ y) >= 0);
    let before = choose(falling, above[i], above[i + 2]);
    let after = choose(falling, below[i + 2], below[i]);
    let before = choose(vertical, above[i + 1], before);
    let after = choose(vertical, below[i + 1], after);
    let before = choose(horizontal, here[i], before);
    let after = choose(horizontal, here[i + 2], after);
    let magnitude = here[i + 1];
    mask(magnitude > before) & mask(magnitude >= after)
}

/// All ones or none.
#[inline(always)]
fn mask(condition: bool) -> u32 {
    u32::from(condition).wrapping_neg()
}

/// One or the other, by mask: values, so that no load hangs on a condition.
#[inline(always)]
fn choose(mask: u32, yes: u32, no: u32) -> u32 {
    (yes & mask) | (no & !mask)
}

/// Bit `bit` of each byte, as a word.
///
/// Eight at a time: of bytes of 0 and 1 a multiplication gathers the bits in the top byte (byte `k` is shifted by
/// `56 - 7 k`, so that it lands on bit `56 + k`, and no two sums meet).
#[inline(always)]
fn gather(bytes: &[u8; PIXELS_A_WORD], bit: u32) -> u32 {
    const ONES: u64 = 0x0101_0101_0101_0101;
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let mut word = 0;
    for (place, bytes) in bytes.as_chunks::<8>().0.iter().enumerate() {
        let flags = (u64::from_le_bytes(*bytes) >> bit) & ONES;
        word |= ((flags.wrapping_mul(GATHER) >> 56) as u32) << (8 * place);
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The marks of a picture of magnitudes and gradients in one word, by both ways.
    fn both(
        rows: [[u32; WINDOW]; 3],
        x: [i16; PIXELS_A_WORD],
        y: [i16; PIXELS_A_WORD],
        low: u32,
        high: u32,
    ) -> Marks {
        let rows = rows.each_ref();
        let marks = every_pixel(rows, &x, &y, low, high);
        assert_eq!(marks, pixels_above(rows, &x, &y, low, high));
        marks
    }

    /// A word whose pixels 1 to 3 are the drawing's middle column, the same gradient everywhere.
    fn kept(picture: [[u32; 5]; 3], gradient: (i16, i16)) -> [bool; 3] {
        let rows =
            picture.map(|line| core::array::from_fn(|i| if (1..6).contains(&i) { line[i - 1] } else { 0 }));
        let marks = both(rows, [gradient.0; PIXELS_A_WORD], [gradient.1; PIXELS_A_WORD], 1, 8);
        assert_eq!(marks.strong & !marks.candidates, 0);
        core::array::from_fn(|i| marks.candidates >> (i + 1) & 1 != 0)
    }

    #[test]
    fn the_crest_is_kept_in_each_direction() {
        let ridge = [[0, 3, 9, 3, 0]; 3];
        assert_eq!(kept(ridge, (20, 0)), [false, true, false]);
        assert_eq!(kept(ridge, (-20, 8)), [false, true, false], "8/20 < tan 22.5°");
        assert_eq!(kept(ridge, (20, 9)), [false, true, false], "a diagonal neighbour is lower, too");
        assert_eq!(
            kept(ridge, (0, 20)),
            [false, false, false],
            "along the ridge nothing is higher than above"
        );
        let falling = [[9, 3, 0, 0, 0], [3, 9, 3, 0, 0], [0, 3, 9, 3, 0]];
        assert!(kept(falling, (20, -20))[0]);
        assert_eq!(kept(falling, (20, 20)), [false; 3]);
    }

    #[test]
    fn of_equals_the_first_is_kept() {
        assert_eq!(kept([[0, 7, 7, 0, 0]; 3], (20, 0)), [true, false, false]);
        assert_eq!(kept([[0, 7, 7, 0, 0]; 3], (-20, 0)), [true, false, false]);
        assert_eq!(kept([[2; 5], [7; 5], [7; 5]], (0, 20)), [true; 3], "the line below is not higher");
        assert_eq!(kept([[7; 5], [7; 5], [2; 5]], (0, 20)), [false; 3], "the line above has it");
    }

    proptest! {
        #[test]
        fn both_ways_agree(
            magnitudes in prop::collection::vec(0u32..40, 3 * WINDOW),
            gradients in prop::collection::vec(-20i16..21, 2 * PIXELS_A_WORD),
            low in 0u32..30, more in 0u32..30,
        ) {
            let rows = core::array::from_fn(|row| core::array::from_fn(|i| magnitudes[row * WINDOW + i]));
            let (x, y) = gradients.split_at(PIXELS_A_WORD);
            let (x, y) = (core::array::from_fn(|i| x[i]), core::array::from_fn(|i| y[i]));
            both(rows, x, y, low, low + more);
        }
    }
}
