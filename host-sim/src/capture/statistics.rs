use serde::Serialize;

/// What came of the frames of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Statistics {
    /// Frames that the device gave.
    pub taken: u64,
    /// Of these, whole ones without an error.
    pub good: u64,
    /// Frames that the device took and did not give: gaps in its sequence numbers.
    pub lost: u64,
    /// Frames that the device said are damaged.
    pub damaged: u64,
    /// Frames of which the device wrote less than the whole.
    pub short: u64,
    /// Frames that are no pictures: broken JPEG.
    pub broken: u64,
    /// Good frames that were not used, because what is done with them takes longer than they come.
    pub dropped: u64,
    /// How often the sequence number went back, as if the device had begun anew.
    pub restarts: u64,
    /// Bytes of all frames that the device gave.
    pub bytes: u64,
    /// Bytes that were copied as they were, from the device's memory or further.
    pub copied_bytes: u64,
    /// Bytes of pictures that were made of frames.
    pub converted_bytes: u64,
    #[serde(skip)]
    last_sequence: Option<u32>,
}

impl Statistics {
    /// Counts a frame of this sequence number, and those that are missing before it.
    ///
    /// ```text
    /// 5 6 9       two are lost
    /// 2³²−1 0     none is: it wraps
    /// 9 0         it began anew
    /// ```
    pub(super) fn saw(&mut self, sequence: u32, bytes: usize) {
        self.taken += 1;
        self.bytes += bytes as u64;
        if let Some(last) = self.last_sequence.replace(sequence) {
            match sequence.wrapping_sub(last) {
                step @ 1..0x8000_0000 => self.lost += u64::from(step - 1),
                // Back, or on the spot.
                _ => self.restarts += 1,
            }
        }
    }

    /// Whether all frames that came are good.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.damaged + self.short + self.broken == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(sequences: &[u32]) -> (u64, u64) {
        let mut statistics = Statistics::default();
        for &sequence in sequences {
            statistics.saw(sequence, 10);
        }
        assert_eq!(statistics.taken, sequences.len() as u64);
        assert_eq!(statistics.bytes, 10 * statistics.taken);
        (statistics.lost, statistics.restarts)
    }

    #[test]
    fn gaps_wraps_and_restarts_are_told_apart() {
        assert_eq!(of(&[]), (0, 0));
        assert_eq!(of(&[7]), (0, 0), "what was before the first is not known");
        assert_eq!(of(&[0, 1, 2]), (0, 0));
        assert_eq!(of(&[5, 6, 9, 10]), (2, 0));
        assert_eq!(of(&[u32::MAX - 1, u32::MAX, 0, 1]), (0, 0));
        assert_eq!(of(&[u32::MAX - 1, 2]), (3, 0), "a gap over the wrap");
        assert_eq!(of(&[8, 9, 0, 1]), (0, 1));
        assert_eq!(of(&[3, 3]), (0, 1));
    }
}
