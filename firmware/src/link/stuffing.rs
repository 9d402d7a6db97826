//! Consistent overhead byte stuffing: bytes without a zero, so that a zero can end a packet.
//!
//! ```text
//! body   11 22 00 33 00           a group: its length + 1, then bytes that are not zero
//! wire   03 11 22 02 33 01 │ 00   a zero is understood between groups, but not after a group of 254 bytes (FF)
//! ```
//!
//! Stuart Cheshire, Mary Baker: *Consistent overhead byte stuffing*, IEEE/ACM Transactions on Networking 7 (2), 1999.
//! The crates `cobs` and `corncobs` go byte by byte; here groups are found with `memchr` and moved whole, and the encoder works
//! in place. `cargo bench -p firmware --bench link` measures it beside them (`docs/link.md`).
//!
//! Cost: one byte for each 254 begun, and the closing zero. One pass over the bytes to find the zeros, one to move them.

use memchr::memchr;

/// Bytes in the longest group.
const GROUP: usize = 254;

/// Bytes that stuffing adds to `length` bytes at most, without the closing zero.
#[must_use]
pub const fn overhead(length: usize) -> usize {
    if length == 0 { 1 } else { length.div_ceil(GROUP) }
}

/// Stuffs `buffer[start .. start + length]` and puts the result, closed by a zero, at `at`. Both may overlap if `at` is
/// at least [`overhead`] below `start`. Returns where the zero ends.
///
/// `None` if the buffer is too short, or `at` too close to `start`.
pub(super) fn stuff(buffer: &mut [u8], start: usize, length: usize, at: usize) -> Option<usize> {
    let end = start.checked_add(length)?;
    if end > buffer.len() || at.checked_add(overhead(length))? > start {
        return None;
    }
    let (mut read, mut write) = (start, at);
    loop {
        let rest = buffer.get(read..end)?;
        let group = rest.get(..GROUP).unwrap_or(rest);
        let found = memchr(0, group);
        let size = found.unwrap_or(group.len());
        *buffer.get_mut(write)? = size as u8 + 1;
        let group_end = read.checked_add(size)?;
        if group_end > buffer.len() || write + 1 > buffer.len() - size {
            return None;
        }
        buffer.copy_within(read..group_end, write + 1);
        write += 1 + size;
        read += size;
        if found.is_some() {
            read += 1;
        } else if read == end {
            break;
        }
    }
    *buffer.get_mut(write)? = 0;
    Some(write + 1)
}

/// Takes stuffed bytes as they come and gives the plain ones.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Unstuffer {
    /// Bytes of the group that are still to come.
    left: usize,
    /// A zero comes before the next group, if there is one.
    zero: bool,
}

/// The plain bytes do not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Overflow;

impl Unstuffer {
    /// Appends the plain bytes of `stuffed`, in which no zero is, to the first `filled` of `plain`.
    pub(super) fn take(
        &mut self,
        mut stuffed: &[u8],
        plain: &mut [u8],
        filled: &mut usize,
    ) -> Result<(), Overflow> {
        loop {
            if self.left == 0 {
                let Some((&code, rest)) = stuffed.split_first() else { return Ok(()) };
                stuffed = rest;
                if self.zero {
                    *plain.get_mut(*filled).ok_or(Overflow)? = 0;
                    *filled += 1;
                }
                self.left = usize::from(code).saturating_sub(1);
                self.zero = self.left < GROUP;
            }
            let size = self.left.min(stuffed.len());
            let Some((group, rest)) = stuffed.split_at_checked(size) else { return Ok(()) };
            let room = plain.get_mut(*filled..).and_then(|room| room.get_mut(..size)).ok_or(Overflow)?;
            room.copy_from_slice(group);
            *filled += size;
            self.left -= size;
            stuffed = rest;
            if stuffed.is_empty() {
                return Ok(());
            }
        }
    }

    /// The packet may end here: no group is cut.
    pub(super) fn is_whole(self) -> bool {
        self.left == 0
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;

    fn stuffed(plain: &[u8]) -> Vec<u8> {
        let start = overhead(plain.len());
        let mut buffer = std::vec![0xAA; start];
        buffer.extend(plain);
        buffer.push(0xAA);
        let end = stuff(&mut buffer, start, plain.len(), 0).unwrap();
        buffer.truncate(end);
        buffer
    }

    /// Byte by byte, as the paper has it.
    fn naive(plain: &[u8]) -> Vec<u8> {
        let (mut wire, mut code) = (std::vec![0], 0);
        for (at, &byte) in plain.iter().enumerate() {
            if byte != 0 {
                wire.push(byte);
            }
            if byte == 0 || (wire.len() - code == 255 && at + 1 < plain.len()) {
                wire[code] = (wire.len() - code) as u8;
                code = wire.len();
                wire.push(0);
            }
        }
        wire[code] = (wire.len() - code) as u8;
        wire.push(0);
        wire
    }

    #[test]
    fn the_examples_of_the_page() {
        assert_eq!(stuffed(&[0x11, 0x22, 0, 0x33, 0]), [3, 0x11, 0x22, 2, 0x33, 1, 0]);
        assert_eq!(stuffed(&[]), [1, 0]);
        assert_eq!(stuffed(&[7; 254]).len(), 256);
        assert_eq!(stuffed(&[7; 255])[254..], [7, 2, 7, 0]);
    }

    #[test]
    fn it_refuses_to_run_over_what_it_has_not_read() {
        let mut buffer = [1; 300];
        assert_eq!(stuff(&mut buffer, 1, 255, 0), None);
        assert_eq!(stuff(&mut buffer, 2, 299, 0), None);
        assert_eq!(stuff(&mut buffer, 2, 255, 0), Some(258));
    }

    proptest! {
        #[test]
        fn there_and_back_in_any_pieces(
            plain in prop::collection::vec(prop_oneof![3 => Just(0u8), 20 => 1u8..4], 0..1200),
            zeros in any::<bool>(),
            cut in 1usize..400,
        ) {
            let plain: Vec<u8> = plain.iter().map(|&byte| if zeros { byte } else { byte.max(1) }).collect();
            let wire = stuffed(&plain);
            prop_assert_eq!(&wire, &naive(&plain));
            prop_assert!(wire.len() <= plain.len() + overhead(plain.len()) + 1);
            let (mut back, mut filled, mut unstuffer) = ([0xEE; 1300], 0, Unstuffer::default());
            for piece in wire[..wire.len() - 1].chunks(cut) {
                unstuffer.take(piece, &mut back, &mut filled).unwrap();
            }
            prop_assert!(unstuffer.is_whole());
            prop_assert_eq!(&back[..filled], &plain[..]);
        }
    }
}
