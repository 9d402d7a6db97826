//! The CRC-32 that closes every packet, continued piece by piece.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// Continues the IEEE CRC-32 of what came before over some more bytes; the CRC of nothing is 0. As `zlib.crc32(bytes,
/// before)`. [`small_table`] is one; a host brings a faster one.
pub type Checksum = fn(before: u32, bytes: &[u8]) -> u32;

static TABLE: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A byte at a time, with a table of 1 KiB in flash.
#[must_use]
pub fn small_table(before: u32, bytes: &[u8]) -> u32 {
    let mut digest = TABLE.digest_with_initial((!before).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_same_in_pieces() {
        assert_eq!(small_table(0, b""), 0);
        assert_eq!(small_table(0, b"123456789"), 0xCBF4_3926);
        assert_eq!(small_table(small_table(0, b"1234"), b"56789"), 0xCBF4_3926);
    }
}
