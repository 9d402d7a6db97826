//! RAW samples in memory: right-aligned in 16 bits, packed as on MIPI CSI-2, or brought to 8 bits.
//!
//! ```text
//! 16 bits   0000 00aa aaaa aaaa        one sample a word: what a 10-bit bus leaves in memory
//! RAW10     a9…a2  b9…b2  c9…c2  d9…d2  d1d0 c1c0 b1b0 a1a0      4 samples in 5 bytes
//! RAW12     a11…a4  b11…b4  b3…b0 a3…a0                          2 samples in 3 bytes
//! ```
//!
//! The packings are those of MIPI CSI-2 v1.1 §11.4.4 and §11.4.5. Samples are right-aligned `u16` throughout;
//! bits above the depth are cut off when packing.

use super::layout::{BitDepth, ByteOrder, check_length, check_multiple};
use crate::image::Error;

const BY_FOUR: &str = "a multiple of 4, because RAW10 packs four samples into five bytes";
const BY_TWO: &str = "a multiple of 2, because RAW12 packs two samples into three bytes";

/// Bytes of a line of `width` samples of 16 bits.
#[must_use]
pub const fn line_bytes16(width: usize) -> usize {
    2 * width
}

/// Bytes of a line of `width` packed RAW10 samples; `width` is a multiple of 4.
#[must_use]
pub const fn line_bytes10(width: usize) -> usize {
    width / 4 * 5
}

/// Bytes of a line of `width` packed RAW12 samples; `width` is a multiple of 2.
#[must_use]
pub const fn line_bytes12(width: usize) -> usize {
    width / 2 * 3
}

/// Writes samples as 16-bit words.
///
/// # Errors
/// [`Error::BufferLength`] if `bytes` does not hold [`line_bytes16`] of the samples; nothing is then written.
pub fn encode_line16(samples: &[u16], bytes: &mut [u8], order: ByteOrder) -> Result<(), Error> {
    check_length("bytes", line_bytes16(samples.len()), bytes.len())?;
    let (words, _) = bytes.as_chunks_mut::<2>();
    words.iter_mut().zip(samples).for_each(|(word, sample)| {
        *word = match order {
            ByteOrder::LittleEndian => sample.to_le_bytes(),
            ByteOrder::BigEndian => sample.to_be_bytes(),
        };
    });
    Ok(())
}

/// Reads samples from 16-bit words; bits above the depth (a bus that floats) are cut off.
///
/// # Errors
/// As [`encode_line16`].
pub fn decode_line16(
    bytes: &[u8],
    samples: &mut [u16],
    order: ByteOrder,
    depth: BitDepth,
) -> Result<(), Error> {
    check_length("bytes", line_bytes16(samples.len()), bytes.len())?;
    let (words, _) = bytes.as_chunks::<2>();
    let mask = depth.max();
    samples.iter_mut().zip(words).for_each(|(sample, &word)| {
        *sample = mask
            & match order {
                ByteOrder::LittleEndian => u16::from_le_bytes(word),
                ByteOrder::BigEndian => u16::from_be_bytes(word),
            };
    });
    Ok(())
}

/// Packs a line of RAW10.
///
/// # Errors
/// [`Error::Parameter`] if the number of samples is not a multiple of 4, [`Error::BufferLength`] if `bytes` does
/// not hold [`line_bytes10`] of them; nothing is then written.
pub fn pack_line10(samples: &[u16], bytes: &mut [u8]) -> Result<(), Error> {
    check_multiple(samples.len(), 4, BY_FOUR)?;
    check_length("bytes", line_bytes10(samples.len()), bytes.len())?;
    let (fours, _) = samples.as_chunks::<4>();
    let (fives, _) = bytes.as_chunks_mut::<5>();
    for (five, &[a, b, c, d]) in fives.iter_mut().zip(fours) {
        let low = (d & 3) << 6 | (c & 3) << 4 | (b & 3) << 2 | (a & 3);
        *five = [(a >> 2) as u8, (b >> 2) as u8, (c >> 2) as u8, (d >> 2) as u8, low as u8];
    }
    Ok(())
}

/// Unpacks a line of RAW10.
///
/// # Errors
/// As [`pack_line10`].
pub fn unpack_line10(bytes: &[u8], samples: &mut [u16]) -> Result<(), Error> {
    check_multiple(samples.len(), 4, BY_FOUR)?;
    check_length("bytes", line_bytes10(samples.len()), bytes.len())?;
    let (fours, _) = samples.as_chunks_mut::<4>();
    let (fives, _) = bytes.as_chunks::<5>();
    for (four, &[a, b, c, d, low]) in fours.iter_mut().zip(fives) {
        let sample = |high: u8, shift: u8| u16::from(high) << 2 | u16::from(low >> shift & 3);
        *four = [sample(a, 0), sample(b, 2), sample(c, 4), sample(d, 6)];
    }
    Ok(())
}

/// Packs a line of RAW12.
///
/// # Errors
/// [`Error::Parameter`] if the number of samples is not a multiple of 2, [`Error::BufferLength`] if `bytes` does
/// not hold [`line_bytes12`] of them; nothing is then written.
pub fn pack_line12(samples: &[u16], bytes: &mut [u8]) -> Result<(), Error> {
    check_multiple(samples.len(), 2, BY_TWO)?;
    check_length("bytes", line_bytes12(samples.len()), bytes.len())?;
    let (twos, _) = samples.as_chunks::<2>();
    let (threes, _) = bytes.as_chunks_mut::<3>();
    for (three, &[a, b]) in threes.iter_mut().zip(twos) {
        *three = [(a >> 4) as u8, (b >> 4) as u8, ((b & 15) << 4 | (a & 15)) as u8];
    }
    Ok(())
}

/// Unpacks a line of RAW12.
///
/// # Errors
/// As [`pack_line12`].
pub fn unpack_line12(bytes: &[u8], samples: &mut [u16]) -> Result<(), Error> {
    check_multiple(samples.len(), 2, BY_TWO)?;
    check_length("bytes", line_bytes12(samples.len()), bytes.len())?;
    let (twos, _) = samples.as_chunks_mut::<2>();
    let (threes, _) = bytes.as_chunks::<3>();
    for (two, &[a, b, low]) in twos.iter_mut().zip(threes) {
        *two = [u16::from(a) << 4 | u16::from(low & 15), u16::from(b) << 4 | u16::from(low >> 4)];
    }
    Ok(())
}

/// The high 8 bits of each sample; [`BitDepth::expand`] goes the other way.
///
/// # Errors
/// [`Error::BufferLength`] if `out` is not as long as `samples`; nothing is then written.
pub fn reduce_line(samples: &[u16], out: &mut [u8], depth: BitDepth) -> Result<(), Error> {
    check_length("out", samples.len(), out.len())?;
    let shift = depth.bits() - 8;
    out.iter_mut().zip(samples).for_each(|(out, &sample)| *out = (sample >> shift).min(255) as u8);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every sample of a depth in every place of its group.
    fn samples(depth: BitDepth) -> Vec<u16> {
        let all = depth.max();
        (0..4).flat_map(|shift| (0..=all).map(move |sample| (sample + shift * 5) & all)).collect()
    }

    #[test]
    fn every_sample_survives_packing() {
        let given = samples(BitDepth::Bits10);
        let (mut bytes, mut back) = (vec![0; line_bytes10(given.len())], vec![0; given.len()]);
        pack_line10(&given, &mut bytes).unwrap();
        unpack_line10(&bytes, &mut back).unwrap();
        assert_eq!(back, given);

        let given = samples(BitDepth::Bits12);
        let (mut bytes, mut back) = (vec![0; line_bytes12(given.len())], vec![0; given.len()]);
        pack_line12(&given, &mut bytes).unwrap();
        unpack_line12(&bytes, &mut back).unwrap();
        assert_eq!(back, given);
    }

    #[test]
    fn bits_lie_where_mipi_puts_them() {
        let mut bytes = [0; 5];
        pack_line10(&[0b11_1111_1101, 2, 3, 0], &mut bytes).unwrap();
        assert_eq!(bytes, [0xFF, 0, 0, 0, 0b00_11_10_01]);
        let mut bytes = [0; 3];
        pack_line12(&[0xABC, 0x123], &mut bytes).unwrap();
        assert_eq!(bytes, [0xAB, 0x12, 0x3C]);
    }

    #[test]
    fn every_word_survives_and_stray_bits_do_not() {
        let given = samples(BitDepth::Bits14);
        let (mut bytes, mut back) = (vec![0; line_bytes16(given.len())], vec![0; given.len()]);
        for order in [ByteOrder::LittleEndian, ByteOrder::BigEndian] {
            encode_line16(&given, &mut bytes, order).unwrap();
            decode_line16(&bytes, &mut back, order, BitDepth::Bits14).unwrap();
            assert_eq!(back, given);
        }
        let mut one = [0];
        decode_line16(&[0xFF, 0xFF], &mut one, ByteOrder::LittleEndian, BitDepth::Bits10).unwrap();
        assert_eq!(one, [1023]);
    }

    #[test]
    fn reduction_undoes_expansion() {
        for depth in [BitDepth::Bits8, BitDepth::Bits10, BitDepth::Bits12, BitDepth::Bits14] {
            let given: [u16; 256] = core::array::from_fn(|i| depth.expand(i as u8));
            let mut back = [0; 256];
            reduce_line(&given, &mut back, depth).unwrap();
            assert!(back.iter().enumerate().all(|(i, &value)| i == usize::from(value)));
        }
    }

    #[test]
    fn broken_groups_are_refused() {
        let error = pack_line10(&[0; 6], &mut [0; 5]).unwrap_err();
        assert_eq!(error, Error::Parameter { name: "width", got: 6, allowed: BY_FOUR });
        assert!(unpack_line12(&[0; 4], &mut [0; 3]).is_err());
        assert!(unpack_line12(&[0; 4], &mut [0; 2]).is_err());
    }
}
