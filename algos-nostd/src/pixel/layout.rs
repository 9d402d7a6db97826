use crate::image::Error;

/// Which byte of a 16-bit word crosses the bus first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ByteOrder {
    /// The low byte first, as a little-endian core lays a word into memory.
    LittleEndian,
    /// The high byte first, as most sensors send it.
    BigEndian,
}

/// Bits of one RAW sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BitDepth {
    /// 0 to 255.
    Bits8,
    /// 0 to 1,023.
    Bits10,
    /// 0 to 4,095.
    Bits12,
    /// 0 to 16,383.
    Bits14,
}

impl BitDepth {
    /// The depth of so many bits, if it is one of 8, 10, 12 and 14.
    ///
    /// # Errors
    /// [`Error::Parameter`] for any other number.
    pub const fn new(bits: u32) -> Result<Self, Error> {
        match bits {
            8 => Ok(Self::Bits8),
            10 => Ok(Self::Bits10),
            12 => Ok(Self::Bits12),
            14 => Ok(Self::Bits14),
            _ => Err(Error::Parameter { name: "bits", got: bits as i64, allowed: "8, 10, 12 or 14" }),
        }
    }

    /// The number of bits.
    #[must_use]
    pub const fn bits(self) -> u32 {
        match self {
            Self::Bits8 => 8,
            Self::Bits10 => 10,
            Self::Bits12 => 12,
            Self::Bits14 => 14,
        }
    }

    /// The largest sample: white.
    #[must_use]
    pub const fn max(self) -> u16 {
        (1 << self.bits()) - 1
    }

    /// Eight bits brought to this depth by repeating the high bits below: 0 stays 0, 255 becomes white, and the
    /// high 8 bits of the result are the value itself.
    #[must_use]
    pub const fn expand(self, value: u8) -> u16 {
        let more = self.bits() - 8;
        ((value as u16) << more) | (value as u16 >> (8 - more))
    }
}

/// Checks that a buffer holds exactly so many elements.
pub(crate) fn check_length(name: &'static str, expected: usize, got: usize) -> Result<(), Error> {
    if expected == got { Ok(()) } else { Err(Error::BufferLength { name, expected, got }) }
}

/// Checks that a line is a whole number of groups of pixels.
pub(crate) fn check_multiple(width: usize, group: usize, allowed: &'static str) -> Result<(), Error> {
    if width.is_multiple_of(group) {
        Ok(())
    } else {
        Err(Error::Parameter { name: "width", got: i64::try_from(width).unwrap_or(i64::MAX), allowed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_expand_to_white_and_back() {
        for bits in [8, 10, 12, 14] {
            let depth = BitDepth::new(bits).unwrap();
            assert_eq!(depth.bits(), bits);
            assert_eq!(depth.expand(255), depth.max());
            for value in 0..=255u8 {
                assert_eq!(depth.expand(value) >> (bits - 8), u16::from(value));
            }
        }
        assert!(BitDepth::new(9).is_err());
    }
}
