//! From the bits of a sample to those of a state.
//!
//! ```text
//! sample   byte 0 │ byte 1          channel k is bit k % 8 of byte k / 8
//!            ▼        ▼
//! tables   [256]    [256]           each entry: the bits of the state that this byte sets
//!            └── or ──┘ ─► state
//! ```

/// A table for each byte of a sample.
#[derive(Clone, Debug)]
pub(super) struct Gather {
    tables: Vec<[u64; 256]>,
    taps: Vec<(u32, u64)>,
}

impl Gather {
    /// For samples of `unit` bytes: the bit of a sample, and the bits of the state that it sets.
    pub(super) fn new(unit: usize, taps: Vec<(u32, u64)>) -> Self {
        let mut tables = vec![[0; 256]; unit];
        for &(bit, state) in &taps {
            if let Some(table) = tables.get_mut(bit as usize / 8) {
                let set = table.iter_mut().enumerate().filter(|(byte, _)| byte >> (bit % 8) & 1 == 1);
                set.for_each(|(_, entry)| *entry |= state);
            }
        }
        Self { tables, taps }
    }

    /// The state of a sample.
    #[inline(always)]
    pub(super) fn state(&self, sample: &[u8]) -> u64 {
        self.tables.iter().zip(sample).fold(0, |state, (table, &byte)| state | table[usize::from(byte)])
    }

    /// The bits of a sample, as bytes, that some bit of `watched` depends on.
    pub(super) fn mask<const N: usize>(&self, watched: u64) -> [u8; N] {
        let mut mask = [0; N];
        for &(bit, _) in self.taps.iter().filter(|(_, state)| state & watched != 0) {
            if let Some(byte) = mask.get_mut(bit as usize / 8) {
                *byte |= 1 << (bit % 8);
            }
        }
        mask
    }
}
