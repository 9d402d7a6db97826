//! CRC-32 of a chunk.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// Computes the IEEE CRC-32 (reflected 0x04C11DB7, start and final inversion): the one of Ethernet, PNG and zip.
pub trait Checksum {
    /// The checksum of `bytes`.
    fn crc32(bytes: &[u8]) -> u32;
}

static TABLE: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A table of 1 KiB in flash, a byte at a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct SmallTable;

impl Checksum for SmallTable {
    fn crc32(bytes: &[u8]) -> u32 {
        TABLE.checksum(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_value_of_the_catalogue() {
        assert_eq!(SmallTable::crc32(b"123456789"), 0xCBF4_3926);
    }
}
