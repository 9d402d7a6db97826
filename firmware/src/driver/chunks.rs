//! How a frame is cut into DMA transfers.
//!
//! A double-buffered DMA has one count for all transfers. If equal transfers fill the frame exactly, frames follow each
//! other with no restart and no gap, which a sensor without vertical blanking needs:
//!
//! ```text
//! frame A           │frame B           │       target 0: ▒   target 1: ░
//! ▒▒▒▒▒▒░░░░░░▒▒▒▒▒▒│░░░░░░▒▒▒▒▒▒░░░░░░│
//!       └ from here to A's end there is time to find B a buffer, or to stop capture behind A
//! ```
//!
//! So even a frame that one transfer could hold is cut in two: the decision then falls inside a frame, where clearing
//! CAPTURE is sure to act behind this frame and not the next; and a frame that is too long shows, because the DMA goes on
//! at the other target. A frame that cannot be cut evenly, that is shorter than the
//! FIFO is deep, or that has no fixed length is taken one at a time: capture stops by itself at its end, and the position
//! of the DMA tells its length.

use crate::camif::FIFO_WORDS;

/// Words that can be on the way from the wires to memory when a frame ends: the FIFO's four and a burst.
pub const IN_FLIGHT: u32 = 8;

/// More transfers than the least number that are tried in search of an even cut.
const TRIES: u32 = 64;

/// How a frame is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Words a transfer.
    pub chunk: u32,
    /// Transfers a frame.
    pub count: u32,
    /// The transfers fill a frame exactly, and frames follow each other without a restart.
    pub seamless: bool,
}

impl Plan {
    /// Cuts frames of `words` words where a transfer is at most `limit` words; `one_by_one` if capture has to stop at
    /// each frame's end anyway.
    ///
    /// `None` if there is nothing to transfer.
    #[must_use]
    pub fn new(words: u32, limit: u32, one_by_one: bool) -> Option<Self> {
        if words == 0 || limit == 0 {
            return None;
        }
        let least = words.div_ceil(limit);
        let most = least.saturating_add(TRIES).min(words / IN_FLIGHT);
        // Counts begin at 2.
        let even = |&count: &u32| count != 0 && words.is_multiple_of(count);
        // Bursts must not straddle transfers: a cut that leaves room for the longest is better than fewer transfers.
        let aligned = |count: &u32| even(count) && (words / count).is_multiple_of(FIFO_WORDS as u32);
        let mut counts = least.max(2)..=most;
        if let Some(count) = counts.clone().find(aligned).or_else(|| counts.find(even)) {
            return Some(Self { chunk: words.checked_div(count)?, count, seamless: !one_by_one });
        }
        let count = least.max(2).min(words).max(1);
        Some(Self { chunk: words.div_ceil(count), count, seamless: false })
    }

    /// Words that a buffer must have: a frame, and where the cut is uneven the rest of its last transfer.
    #[must_use]
    pub const fn room(&self) -> u64 {
        self.chunk as u64 * self.count as u64
    }

    /// First word of a transfer.
    #[must_use]
    pub const fn start(&self, index: u32) -> usize {
        self.chunk as usize * index as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn frames_around_the_limit_of_sixteen_bits() {
        let cut = |words| Plan::new(words, 65_535, false).unwrap();
        assert_eq!(cut(65_534), Plan { chunk: 32_767, count: 2, seamless: true });
        assert_eq!(cut(65_535), Plan { chunk: 21_845, count: 3, seamless: true });
        assert_eq!(cut(65_536), Plan { chunk: 32_768, count: 2, seamless: true });
        assert_eq!(cut(65_537), Plan { chunk: 32_769, count: 2, seamless: false }, "a prime");
        assert_eq!(cut(65_537).room(), 65_538);
        assert_eq!(cut(230_400), Plan { chunk: 57_600, count: 4, seamless: true }, "VGA, RGB888");
        assert_eq!(Plan::new(65_536, 65_535, true).unwrap().count, 2);
        assert_eq!(Plan::new(15, 65_535, false).unwrap(), Plan { chunk: 8, count: 2, seamless: false });
        assert_eq!(Plan::new(0, 65_535, false), None);
    }

    proptest! {
        #[test]
        fn a_plan_covers_the_frame_and_keeps_the_limit(words in 1_u32..3_000_000, limit in 1_u32..70_000, one: bool) {
            let plan = Plan::new(words, limit, one).unwrap();
            prop_assert!(plan.chunk <= limit && plan.chunk > 0);
            prop_assert!(plan.room() >= u64::from(words));
            prop_assert!(plan.room() - u64::from(words) < u64::from(plan.count));
            if plan.seamless {
                prop_assert_eq!(plan.room(), u64::from(words));
                prop_assert!(plan.count >= 2 && plan.chunk >= IN_FLIGHT && !one);
            } else {
                prop_assert!(one || plan.count <= words.div_ceil(limit).max(2));
            }
        }
    }
}
