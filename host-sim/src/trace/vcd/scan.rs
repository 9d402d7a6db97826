//! Eight characters at a time, in one register.
//!
//! ```text
//! bytes   # 1 8 0 8 4 \n 1      one load, little-endian: the first character is the lowest byte
//! subtract, mask, count zeros   how many are digits; where the token ends
//! three multiplications         the number they spell
//! ```
//!
//! References: D. Lemire, "Quickly parsing eight digits" (2018) for [`decimal`]; H. S. Warren, "Hacker's Delight" 2nd ed. §6-1
//! for finding a byte. Each function is tested against a loop.

const ONES: u64 = 0x0101_0101_0101_0101;
const HIGHS: u64 = 0x8080_8080_8080_8080;

/// As many bytes as any common token has, with the blank behind it.
pub(super) type Window = [u8; 32];

/// The eight bytes at `at`, of which it must be clear to the compiler that they are in the window.
#[inline(always)]
pub(super) fn word(window: &Window, at: usize) -> u64 {
    load(window, at)
}

/// The eight bytes at `at`; blanks where there are none.
#[inline(always)]
pub(super) fn load(bytes: &[u8], at: usize) -> u64 {
    match bytes.get(at..at.wrapping_add(8)).and_then(|found| found.first_chunk::<8>()) {
        Some(&found) => u64::from_le_bytes(found),
        None => load_tail(bytes, at),
    }
}

#[cold]
fn load_tail(bytes: &[u8], at: usize) -> u64 {
    let mut found = [b'\n'; 8];
    for (to, from) in found.iter_mut().zip(bytes.get(at..).unwrap_or_default()) {
        *to = *from;
    }
    u64::from_le_bytes(found)
}

/// White space and control characters end a token.
#[inline(always)]
pub(super) fn is_blank(byte: u8) -> bool {
    byte <= b' '
}

/// Marks the first byte that is blank with its highest bit; 0 if none is. Bytes above it may be marked wrongly.
#[inline(always)]
pub(super) fn blanks(word: u64) -> u64 {
    word.wrapping_sub(ONES * 0x21) & !word & HIGHS
}

/// How many of the first bytes are decimal digits, 0 to 8.
#[inline(always)]
pub(super) fn digit_count(word: u64) -> u32 {
    not_digits(word ^ (ONES * 0x30)).trailing_zeros() / 8
}

/// Not 0 if any of the bytes, which are characters less `0`, is no decimal digit.
#[inline(always)]
pub(super) fn not_digits(digits: u64) -> u64 {
    (((digits & !HIGHS) + ONES * 0x76) | digits) & HIGHS
}

/// The number that the first `count` bytes spell, which must be 1 to 8 digits.
#[inline(always)]
pub(super) fn decimal(word: u64, count: u32) -> u64 {
    decimal_of_eight((word & (ONES * 0x0F)) << (64 - 8 * count))
}

/// The number of eight digits, given as bytes from 0 to 9, the first in the lowest byte.
#[inline(always)]
pub(super) fn decimal_of_eight(digits: u64) -> u64 {
    let pairs = (digits.wrapping_mul(10 << 8 | 1) >> 8) & 0x00FF_00FF_00FF_00FF;
    let fours = (pairs.wrapping_mul(100 << 16 | 1) >> 16) & 0x0000_FFFF_0000_FFFF;
    fours.wrapping_mul(10_000 << 32 | 1) >> 32
}

/// How many of the first bytes are `0` or `1`, 0 to 8.
#[inline(always)]
pub(super) fn bit_count(word: u64) -> u32 {
    let others = (word ^ (ONES * 0x30)) & (ONES * 0xFE);
    others.trailing_zeros() / 8
}

/// The number that the first `count` bytes spell, which must be 1 to 8 characters `0` or `1`.
#[inline(always)]
pub(super) fn binary(word: u64, count: u32) -> u64 {
    // Byte i holds the bit of weight 7 − i; the product gathers all of them in the highest byte, without carries.
    let bits = (word & ONES) << (64 - 8 * count);
    bits.wrapping_mul(0x8040_2010_0804_0201) >> 56
}

/// Where the token that begins at `at` ends: its first blank, or the end of `bytes`.
pub(super) fn token_end(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or_default();
    at + rest.iter().position(|&byte| is_blank(byte)).unwrap_or(rest.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn naive(bytes: [u8; 8], inside: impl Fn(u8) -> bool) -> u32 {
        bytes.iter().take_while(|&&byte| inside(byte)).count() as u32
    }

    proptest! {
        #[test]
        fn counts_are_those_of_a_loop(
            raw in any::<[u8; 8]>(),
            digits in "[0-9]{0,8}",
            bits in "[01]{0,8}",
        ) {
            let with = |text: &str| {
                let mut bytes = raw;
                bytes[..text.len()].copy_from_slice(text.as_bytes());
                bytes
            };
            for bytes in [raw, with(&digits), with(&bits)] {
                let word = u64::from_le_bytes(bytes);
                prop_assert_eq!(digit_count(word), naive(bytes, |b| b.is_ascii_digit()));
                prop_assert_eq!(bit_count(word), naive(bytes, |b| b == b'0' || b == b'1'));
                prop_assert_eq!(blanks(word).trailing_zeros() / 8, naive(bytes, |b| !is_blank(b)));
            }
            if !digits.is_empty() {
                let word = u64::from_le_bytes(with(&digits));
                prop_assert_eq!(decimal(word, digits.len() as u32), digits.parse::<u64>().unwrap());
            }
            if !bits.is_empty() {
                let word = u64::from_le_bytes(with(&bits));
                prop_assert_eq!(binary(word, bits.len() as u32), u64::from_str_radix(&bits, 2).unwrap());
            }
        }
    }

    #[test]
    fn loads_past_the_end_are_blank() {
        assert_eq!(load(b"#1", 0).to_le_bytes(), *b"#1\n\n\n\n\n\n");
        assert_eq!(load(b"#1", 9).to_le_bytes(), [b'\n'; 8]);
        assert_eq!(token_end(b"ab c", 0), 2);
        assert_eq!(token_end(b"ab c", 3), 4);
    }
}
