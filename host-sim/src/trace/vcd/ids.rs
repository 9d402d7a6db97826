//! From identifier to wire.
//!
//! ```text
//! state   │ 18 PCLK │ 17 VSYNC │ 16 HSYNC │ 13 … 0 data │        one word holds all wires, here of a camera bus
//! "%&"    ─► key 0x2625 ─► × odd constant ─► slot ─► mask of the state's bits that it sets
//! ```
//!
//! Identifiers of up to seven characters are numbers, looked up by multiplicative hashing (Knuth, TAOCP vol. 3 §6.4)
//! with linear probing. Those of the wires come first and the constant is chosen so that none of them is displaced: a hit
//! costs one multiplication and one load. Longer identifiers are valid and slower. All declared identifiers are in
//! the table, so that one that is not is an error.

use std::collections::HashMap;

use super::super::wiring::Tap;
use super::error::Problem;
use super::header::{Declarations, Kind, shortened};

/// A bit that stands for all signals that are no wires. It may change at any time and nobody looks at it.
const OTHERS: u64 = 1 << 63;

/// Characters of an identifier that fit a key.
const KEY_CHARACTERS: usize = 7;
/// Set in the key of what is not a scalar, so that a scalar value does not find it.
pub(super) const VECTOR: u64 = 1 << 63;
/// Key of an empty slot.
const EMPTY: u64 = u64::MAX;
/// `Entry::vector` of what is no wanted vector.
const NONE: u32 = u32::MAX;

/// What a change of an identifier does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) key: u64,
    /// Bits of the state that a scalar sets, 0 if it is no wire. Of a vector: its width, 0 if it is no bits at all.
    pub(super) mask: u64,
    vector: u32,
}

impl Entry {
    pub(super) fn is_scalar(&self) -> bool {
        self.key & VECTOR == 0
    }

    /// Declared bits; 0 for numbers and text.
    pub(super) fn width(&self) -> u32 {
        if self.is_scalar() { 1 } else { self.mask as u32 }
    }
}

/// Bits of a vector, and the bits of the state that each of them sets.
type Taps = Vec<(u32, u64)>;

/// A wanted vector.
#[derive(Clone, Debug)]
pub(super) struct Vector {
    /// Bits of the vector from `shift` on, as many as are in `mask`, are the lowest bits of the state.
    straight: Option<(u32, u64)>,
    taps: Taps,
    /// All bits of the state that it sets.
    pub(super) mask: u64,
}

impl Vector {
    fn new(mut taps: Taps) -> Self {
        taps.sort_unstable();
        let mask = taps.iter().fold(0, |all, (_, bits)| all | bits);
        let shift = taps.first().map_or(0, |&(bit, _)| bit);
        let in_order =
            taps.iter().enumerate().all(|(n, &(bit, bits))| bit == shift + n as u32 && bits == 1 << n);
        Self { straight: in_order.then_some((shift, mask)), taps, mask }
    }

    /// Bits of the vector, lowest first, and the bits of the state that each sets.
    pub(super) fn taps(&self) -> &[(u32, u64)] {
        &self.taps
    }

    /// The state's bits for a value of the vector.
    #[inline]
    pub(super) fn bits(&self, value: u64) -> u64 {
        match self.straight {
            Some((shift, mask)) => value >> shift & mask,
            None => self
                .taps
                .iter()
                .filter(|(bit, _)| value.checked_shr(*bit).unwrap_or(0) & 1 != 0)
                .fold(0, |all, (_, bits)| all | bits),
        }
    }
}

/// All declared identifiers.
#[derive(Debug)]
pub(super) struct IdTable {
    /// What scalars with identifiers of one or two characters set; 0 if there is none. See [`IdTable::short`].
    short: Box<[u64; 1 << 16]>,
    slots: Box<[Entry]>,
    multiplier: u64,
    long: HashMap<Box<[u8]>, Entry>,
    mixed_lengths: bool,
    vectors: Vec<Vector>,
}

/// An identifier's characters as a number, if they fit.
fn key(id: &[u8]) -> Option<u64> {
    let mut bytes = [0; 8];
    if id.is_empty() || id.len() > KEY_CHARACTERS {
        return None;
    }
    bytes.get_mut(..id.len())?.copy_from_slice(id);
    Some(u64::from_le_bytes(bytes))
}

impl IdTable {
    /// A table that knows no identifier.
    pub(super) fn empty() -> Self {
        Self {
            short: no_short(),
            slots: vec![Entry { key: EMPTY, mask: 0, vector: NONE }; slots_for(0)].into(),
            multiplier: 1,
            long: HashMap::new(),
            mixed_lengths: false,
            vectors: Vec::new(),
        }
    }

    /// The table in which a change of a tap sets the bits of the state that stand beside it.
    pub(super) fn new(declared: &Declarations, wires: &[(Tap, u64)]) -> Result<Self, Problem> {
        let mut kinds: HashMap<&[u8], (Kind, Taps)> = HashMap::new();
        for (id, kind) in &declared.ids {
            let (known, _) = kinds.entry(id).or_insert((*kind, Vec::new()));
            if known != kind {
                return Err(Problem::WidthConflict(shortened(&String::from_utf8_lossy(id))));
            }
        }
        for &(tap, state_bit) in wires {
            let taps = declared.ids.get(tap.signal).and_then(|(id, _)| kinds.get_mut(&**id));
            if let Some((_, taps)) = taps {
                // One wire may have two roles.
                match taps.iter_mut().find(|(bit, _)| *bit == tap.bit) {
                    Some((_, bits)) => *bits |= state_bit,
                    None => taps.push((tap.bit, state_bit)),
                }
            }
        }
        let mut table = Self::empty();
        table.slots = vec![Entry { key: EMPTY, mask: 0, vector: NONE }; slots_for(kinds.len())].into();
        let mut wanted = Vec::new();
        let mut others = Vec::new();
        for (id, (kind, taps)) in kinds {
            let is_wire = !taps.is_empty();
            let mut entry = Entry { key: key(id).unwrap_or(0), mask: 0, vector: NONE };
            match kind {
                Kind::Bits(1) => {
                    entry.mask = taps.first().map_or(0, |&(_, bits)| bits);
                    let short = key(id).and_then(|key| u16::try_from(key).ok());
                    if let Some(mask) = short.and_then(|key| table.short.get_mut(usize::from(key))) {
                        *mask = if is_wire { entry.mask } else { OTHERS };
                    }
                }
                Kind::Bits(width) => {
                    entry.key |= VECTOR;
                    entry.mask = u64::from(width);
                    if is_wire {
                        entry.vector = table.vectors.len() as u32;
                        table.vectors.push(Vector::new(taps));
                    }
                }
                Kind::Other => entry.key |= VECTOR,
            }
            match key(id) {
                None => drop(table.long.insert(id.into(), entry)),
                Some(_) if is_wire => wanted.push(entry),
                Some(_) => others.push(entry),
            }
        }
        let length = |entry: &Entry| entry.key.leading_zeros() / 8;
        let mut lengths = wanted.iter().filter(|entry| entry.is_scalar()).map(length);
        let first = lengths.next();
        table.mixed_lengths = lengths.any(|length| Some(length) != first);
        table.fill(&wanted, &others);
        Ok(table)
    }

    /// Chooses a constant that gives every wanted identifier the slot it hashes to, then puts in the others.
    fn fill(&mut self, wanted: &[Entry], others: &[Entry]) {
        let mut multiplier = 0x9E37_79B9_7F4A_7C15_u64;
        for _ in 0..1000 {
            self.multiplier = multiplier | 1;
            let mut homes: Vec<usize> = wanted.iter().map(|entry| self.home(entry.key)).collect();
            homes.sort_unstable();
            homes.dedup();
            if homes.len() == wanted.len() {
                break;
            }
            multiplier = multiplier.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
        }
        let last = self.slots.len() - 1;
        for entry in wanted.iter().chain(others) {
            let mut slot = self.home(entry.key);
            while self.slots[slot].key != EMPTY {
                slot = (slot + 1) & last;
            }
            self.slots[slot] = *entry;
        }
    }

    /// The wires' identifiers, where they are scalars, are not all of one length.
    pub(super) fn has_mixed_lengths(&self) -> bool {
        self.mixed_lengths
    }

    /// The bits of the state that a scalar sets whose identifier has one character, or two with the first in the lower
    /// byte. `None` if no scalar is called so.
    #[inline(always)]
    pub(super) fn short(&self, id: u16) -> Option<u64> {
        Some(self.short[usize::from(id)]).filter(|&mask| mask != 0)
    }

    #[inline(always)]
    fn home(&self, key: u64) -> usize {
        (key.wrapping_mul(self.multiplier) >> 40) as usize & (self.slots.len() - 1)
    }

    /// The entry of a key at its own slot, or whatever is there: the caller compares the keys.
    #[inline(always)]
    pub(super) fn first(&self, key: u64) -> Entry {
        self.slots[self.home(key)]
    }

    /// The entry of a key.
    #[inline]
    pub(super) fn get(&self, key: u64) -> Option<Entry> {
        let mut slot = self.home(key);
        // At most half of the slots are taken, so an empty one ends the search.
        loop {
            let entry = self.slots[slot];
            if entry.key == key {
                return Some(entry);
            }
            if entry.key == EMPTY {
                return None;
            }
            slot = (slot + 1) & (self.slots.len() - 1);
        }
    }

    /// The scalar that `id` identifies; or else the vector (or number or text).
    pub(super) fn find(&self, id: &[u8]) -> Option<Entry> {
        match key(id) {
            Some(key) => self.get(key).or_else(|| self.get(key | VECTOR)),
            None => self.long.get(id).copied(),
        }
    }

    /// The vector of an entry, if it is a wanted one.
    #[inline]
    pub(super) fn vector(&self, entry: Entry) -> Option<&Vector> {
        self.vectors.get(entry.vector as usize)
    }
}

/// Allocated as zeros, of which only the pages in use ever take memory.
fn no_short() -> Box<[u64; 1 << 16]> {
    vec![0; 1 << 16].try_into().unwrap_or_else(|_| Box::new([0; 1 << 16]))
}

/// A power of two, at least twice the identifiers.
fn slots_for(identifiers: usize) -> usize {
    (identifiers * 2).next_power_of_two().max(256)
}

#[cfg(test)]
mod tests {
    use super::super::super::edges::{HSYNC, PCLK, VSYNC, wires};
    use super::super::super::wiring::Wiring;
    use super::*;

    #[test]
    fn vectors_set_the_bits_they_are_wired_to() {
        let straight = Vector::new((2..10).map(|bit| (bit, 1 << (bit - 2))).collect());
        assert_eq!(straight.bits(0b11_0000_0111), 0b1100_0001);
        assert!(straight.straight.is_some());
        let crossed = Vector::new(vec![(0, 2), (1, 1), (70, PCLK)]);
        assert!(crossed.straight.is_none());
        assert_eq!(crossed.bits(0b01), 2);
        assert_eq!(crossed.bits(0b10), 1);
    }

    #[test]
    fn ten_thousand_identifiers_are_told_apart() {
        let mut declared = Declarations::default();
        for number in 0..10_000_u32 {
            let (a, b) = ((33 + number % 94) as u8, (33 + number / 94 % 94) as u8);
            let long = format!("long-identifier-{number}").into_bytes();
            let id = match number % 3 {
                0 => vec![a, b, b'!'],
                1 => vec![a, b],
                _ => long,
            };
            declared.ids.push((id.into(), Kind::Bits(1)));
        }
        let data: Vec<Tap> = (0..8).map(|line| Tap { signal: line * 997, bit: 0 }).collect();
        let tap = |signal| Tap { signal, bit: 0 };
        let wiring = Wiring {
            pclk: tap(5),
            hsync: Some(tap(6)),
            vsync: Some(tap(7)),
            data,
            matched: Default::default(),
        };
        let table = IdTable::new(&declared, &wires(&wiring)).unwrap();
        for (number, (id, _)) in declared.ids.iter().enumerate() {
            let expected = match number {
                5 => PCLK,
                6 => HSYNC,
                7 => VSYNC,
                _ if number % 997 == 0 && number / 997 < 8 => 1 << (number / 997),
                _ => 0,
            };
            assert_eq!(table.find(id).unwrap().mask, expected, "{number}");
        }
        for unknown in [&b"~~~~"[..], b"~", b"", b"long-identifier-x"] {
            assert!(table.find(unknown).is_none());
        }
    }
}
