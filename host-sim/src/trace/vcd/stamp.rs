//! Time stamps, guessed from the one before.
//!
//! ```text
//! before  #1 2 3 4 │ 5 6 7 8 9 0 1 2 \n       12 digits: a prefix worth 123,400,000,000, and eight more
//! now     #1 2 3 4 │ 5 6 7 9 1 6 3 0 \n       as many digits, the same prefix? then only the last eight are read
//!          prefix    low
//! ```
//!
//! A time stamp has nearly always as many digits as the one before and begins like it. If so, where it ends is known without
//! looking for its end, which lets the processor go on with the next lines at once; and of its digits only the last eight are to
//! be turned into a number. All of it is checked: the prefix is compared, the others must be digits, and a blank must follow.
//! [`Guess::read`] is the way for all others of up to 16 digits.

use super::scan::{Window, decimal, decimal_of_eight, digit_count, is_blank, not_digits, word};

const ZEROS: u64 = u64::from_le_bytes(*b"00000000");

/// The shape of a time stamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guess {
    digits: usize,
    /// The digits before the last eight, as characters, and where they are among eight of them.
    prefix: u64,
    prefix_mask: u64,
    /// What the prefix is worth.
    base: u64,
    /// Bits by which fewer than eight digits are moved up, and the zeros that come before them.
    shift: u32,
    zeros: u64,
}

impl Default for Guess {
    /// Fits nothing.
    fn default() -> Self {
        Self { digits: 0, prefix: 1, prefix_mask: 0, base: 0, shift: 0, zeros: 0 }
    }
}

impl Guess {
    /// The time at the beginning of `window`, which is a `#`, and the bytes it takes with the blank behind it; `None` if it does not
    /// look like the one before.
    #[inline(always)]
    pub(super) fn try_read(&self, window: &Window) -> Option<(u64, usize)> {
        let digits = self.digits % 32;
        let low = word(window, 1 + digits.saturating_sub(8) % 16) << self.shift | self.zeros;
        let low = low ^ ZEROS;
        let prefix_differs = word(window, 1) & self.prefix_mask ^ self.prefix;
        if prefix_differs | not_digits(low) != 0 || !is_blank(window[(1 + digits) % 32]) {
            return None;
        }
        Some((self.base + decimal_of_eight(low), digits + 2))
    }

    /// The same for any time of up to 16 digits, and the shape of the next one.
    #[inline(never)]
    pub(super) fn read(window: &Window) -> Option<(u64, usize, Self)> {
        let (first, second) = (word(window, 1), word(window, 9));
        let digits = match digit_count(first) {
            8 => 8 + digit_count(second),
            fewer => fewer,
        };
        let end = 1 + digits as usize;
        if digits == 0 || !window.get(end).copied().is_some_and(is_blank) {
            return None;
        }
        let before_low = digits.saturating_sub(8);
        let prefix_mask = 1_u64.checked_shl(8 * before_low).map_or(u64::MAX, |bit| bit - 1);
        let base = if before_low == 0 { 0 } else { decimal(first, before_low) * 100_000_000 };
        let low = decimal(word(window, end - digits.min(8) as usize), digits.min(8));
        let shift = 64 - 8 * digits.min(8);
        let guess = Self {
            digits: digits as usize,
            prefix: first & prefix_mask,
            prefix_mask,
            base,
            shift,
            zeros: ZEROS & ((1 << shift) - 1),
        };
        Some((base + low, end + 1, guess))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn window(text: &str) -> Window {
        let mut window = [b'\n'; 32];
        window[..text.len()].copy_from_slice(text.as_bytes());
        window
    }

    /// By the definition; at most 16 digits.
    fn naive(text: &str) -> Option<u64> {
        let end = text.find(|c: char| c <= ' ').unwrap_or(text.len());
        let digits = &text[1..end];
        let is_time = (1..=16).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
        if is_time { digits.parse().ok() } else { None }
    }

    proptest! {
        #[test]
        fn any_time_after_any_other_is_read(
            before in "[0-9]{1,16}", step in 1..200_000_000_u64, other in "[0-9]{0,18}", broken in "[0-9a:/# ]{0,18}",
        ) {
            let (_, _, guess) = Guess::read(&window(&format!("#{before}"))).unwrap();
            let after = (before.parse::<u64>().unwrap() + step).to_string();
            let padded = format!("{after:0>width$}", width = before.len());
            for text in [&before, &after, &padded, &other, &broken] {
                let text = format!("#{text}");
                let expected = naive(&text);
                let length = 2 + text[1..].find(' ').unwrap_or(text.len() - 1);
                let read = Guess::read(&window(&text)).map(|(time, length, _)| (time, length));
                prop_assert_eq!(read, expected.map(|time| (time, length)), "{}", text);
                let guessed = guess.try_read(&window(&text));
                prop_assert!(guessed.is_none() || guessed == read, "{}: {:?}", text, guessed);
            }
            let same = guess.try_read(&window(&format!("#{before}")));
            prop_assert_eq!(same.map(|(time, _)| time), before.parse::<u64>().ok());
        }
    }

    #[test]
    fn nothing_is_guessed_before_the_first() {
        for text in ["#0", "#", "#12345678", "#1234567890123456"] {
            assert_eq!(Guess::default().try_read(&window(text)), None);
        }
    }
}
