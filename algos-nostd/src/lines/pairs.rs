//! Two 16-bit values in a word: the vector unit of a processor that has none.
//!
//! ```text
//!      31        16 15         0
//!     ┌────────────┬────────────┐      one addition of words adds both lanes, as long as no lane
//!     │ pixel x + 1│  pixel x   │      leaves 0 to 65,535; a difference is kept in that range by an
//!     └────────────┴────────────┘      offset of 2¹⁵, which [`signed`] turns into a sign
//! ```
//!
//! A Cortex-M4 adds, subtracts and shifts pairs in the same single instruction as one value, and joins and splits them in
//! one as well (`PKHBT`, `UXTB16`); so does any 32-bit processor in two or three. Nothing here names an instruction: the
//! results are the same on every target.

/// The offset of a lane that stands for a signed value.
pub(crate) const SIGN: u16 = 1 << 15;

/// The same value in both lanes.
#[inline(always)]
pub(crate) const fn both(value: u16) -> u32 {
    value as u32 * 0x1_0001
}

/// Two values as a pair, the first in the low lane.
#[inline(always)]
pub(crate) fn join(values: [u16; 2]) -> u32 {
    // The processors in question store the low half first: a load or a store of two is one of a word.
    if cfg!(target_endian = "little") {
        bytemuck::cast(values)
    } else {
        u32::from(values[0]) | u32::from(values[1]) << 16
    }
}

/// A pair as two values.
#[inline(always)]
pub(crate) fn apart(pair: u32) -> [u16; 2] {
    if cfg!(target_endian = "little") { bytemuck::cast(pair) } else { [pair as u16, (pair >> 16) as u16] }
}

/// A pair as two signed values.
#[inline(always)]
pub(crate) fn split(pair: u32) -> [i16; 2] {
    bytemuck::cast(apart(pair))
}

/// Of two pairs in a row `a b`, `c d` the one in the middle: `b c`.
#[inline(always)]
pub(crate) fn middle(left: u32, right: u32) -> u32 {
    left >> 16 | right << 16
}

/// Takes the offset of [`SIGN`] off both lanes: what is left is in two's complement.
#[inline(always)]
pub(crate) fn signed(pair: u32) -> u32 {
    pair ^ both(SIGN)
}

/// Four bytes in a row as two pairs: the even ones and the odd ones.
#[inline(always)]
pub(crate) fn even_odd(bytes: [u8; 4]) -> [u32; 2] {
    const LOW_BYTES: u32 = 0x00FF_00FF;
    let word = u32::from_le_bytes(bytes);
    [word & LOW_BYTES, word >> 8 & LOW_BYTES]
}

/// Even ones and odd ones put in a row again.
#[inline(always)]
pub(crate) fn in_a_row([even, odd]: [u32; 2]) -> [u16; 4] {
    const LOW: u32 = 0xFFFF;
    bytemuck::cast([apart(even & LOW | odd << 16), apart(even >> 16 | odd & !LOW)])
}

/// Even ones and odd ones, each below 256, as four bytes in a row.
#[inline(always)]
pub(crate) fn bytes_in_a_row([even, odd]: [u32; 2]) -> [u8; 4] {
    (even | odd << 8).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_do_not_meet() {
        assert_eq!(apart(join([40_000, 9]) + join([25_535, 3])), [65_535, 12]);
        assert_eq!(middle(join([1, 2]), join([3, 4])), join([2, 3]));
        let difference = join([5, 20_000]) + both(SIGN) - join([20_000, 5]);
        assert_eq!(split(signed(difference)), [-19_995, 19_995]);
    }

    #[test]
    fn bytes_come_apart_and_together() {
        let [even, odd] = even_odd([1, 2, 253, 254]);
        assert_eq!((apart(even), apart(odd)), ([1, 253], [2, 254]));
        assert_eq!(in_a_row([even, odd]), [1, 2, 253, 254]);
        assert_eq!(bytes_in_a_row([even, odd]), [1, 2, 253, 254]);
    }
}
