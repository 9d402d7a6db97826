//! CRC-32 of a chunk.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// Computes the IEEE CRC-32 (reflected 0x04C11DB7, start and final inversion) of some bytes: the one of Ethernet, PNG and
/// zip. [`small_table`] is one; a host brings a faster one.
pub type Checksum = fn(&[u8]) -> u32;

static TABLE: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A byte at a time, with a table of 1 KiB in flash.
#[must_use]
pub fn small_table(bytes: &[u8]) -> u32 {
    TABLE.checksum(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_value_of_the_catalogue() {
        assert_eq!(small_table(b"123456789"), 0xCBF4_3926);
    }
}
