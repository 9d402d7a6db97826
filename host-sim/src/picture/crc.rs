/// The IEEE CRC-32 of a frame's bytes (polynomial 0x04C11DB7 reflected, as in Ethernet, zip and PNG).
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    crc32_of(&[bytes])
}

/// The same of bytes that stand in several places.
#[must_use]
pub fn crc32_of(pieces: &[&[u8]]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    pieces.iter().for_each(|piece| hasher.update(piece));
    hasher.finalize()
}

/// The CRC continued from that of the bytes before; the link's [`Checksum`](firmware::link::Checksum).
#[must_use]
pub fn crc32_after(before: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(bytes);
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_value() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
        assert_eq!(crc32(b""), 0);
        assert_eq!(crc32_of(&[b"1234", b"", b"56789"]), 0xCBF4_3926);
        assert_eq!(crc32_after(crc32_after(0, b"1234"), b"56789"), 0xCBF4_3926);
    }
}
