//! Packed parts. No size is believed that the packing could not reach, and none is more than [`LIMIT`].

use std::io::Read;

use super::error::FstProblem;

/// Bytes that a part may take.
pub(super) const LIMIT: u64 = 256 << 20;

/// How a part is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Zlib,
    Gzip,
    Lz4,
    FastLz,
}

impl Packing {
    /// Times that the bytes can become more, at most.
    fn most(self) -> u64 {
        match self {
            Self::Zlib | Self::Gzip => 1040,
            Self::Lz4 => 256,
            Self::FastLz => 264,
        }
    }

    /// Unpacks to exactly `size` bytes.
    pub(super) fn unpack(self, bytes: &[u8], size: u64, what: &'static str) -> Result<Vec<u8>, FstProblem> {
        let wrong = FstProblem::Packed(what);
        if size > LIMIT {
            return Err(FstProblem::TooLarge(what));
        }
        if size > self.most() * (bytes.len() as u64 + 16) {
            return Err(wrong);
        }
        let mut out = Vec::new();
        match self {
            Self::Zlib => drop(flate2::bufread::ZlibDecoder::new(bytes).take(size).read_to_end(&mut out)),
            Self::Gzip => drop(flate2::bufread::GzDecoder::new(bytes).take(size).read_to_end(&mut out)),
            Self::Lz4 => {
                out = lz4_flex::block::decompress(bytes, size as usize).map_err(|_| wrong.clone())?;
            }
            Self::FastLz => out = fastlz(bytes, size as usize).ok_or_else(|| wrong.clone())?,
        }
        if out.len() as u64 == size { Ok(out) } else { Err(wrong) }
    }
}

/// FastLZ, levels 1 and 2: literal runs of up to 32 bytes, and matches that go back up to 8 KiB, in level 2 up to 72 KiB.
fn fastlz(bytes: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(size);
    let level2 = match bytes.first()? >> 5 {
        0 => false,
        1 => true,
        _ => return None,
    };
    let mut at = 0;
    let mut next = || {
        let byte = bytes.get(at).copied();
        at += 1;
        byte
    };
    // The first instruction is a literal run, whose upper bits say the level.
    let mut code = next().map(|code| code & 31);
    while let Some(now) = code {
        if now < 32 {
            for _ in 0..=now {
                out.push(next()?);
            }
        } else {
            let mut length = usize::from(now >> 5) + 2;
            if length == 9 {
                loop {
                    let more = next()?;
                    length += usize::from(more);
                    if !level2 || more < 255 {
                        break;
                    }
                }
            }
            let low = next()?;
            let mut distance = usize::from(now & 31) << 8 | usize::from(low);
            if level2 && now & 31 == 31 && low == 255 {
                distance = 8191 + (usize::from(next()?) << 8 | usize::from(next()?));
            }
            let start = out.len().checked_sub(distance + 1)?;
            if out.len() + length > size {
                return None;
            }
            for from in start..start + length {
                out.push(*out.get(from)?);
            }
        }
        if out.len() > size {
            return None;
        }
        code = next();
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fastlz_is_as_its_author_describes_it() {
        // abc, then seven bytes from three back: abcabcabca.
        let packed = [2, b'a', b'b', b'c', 5 << 5, 2];
        assert_eq!(fastlz(&packed, 10).unwrap(), b"abcabcabca");
        // A long match of level 1: 9 + 3 bytes.
        assert_eq!(fastlz(&[0, b'x', 7 << 5, 3, 0], 13).unwrap(), b"x".repeat(13));
        for bad in [&[][..], &[5], &[0, b'x', 32, 9], &[0x40], &[0, b'x', 7 << 5]] {
            assert_eq!(fastlz(bad, 10), None);
        }
        assert!(Packing::Zlib.unpack(&[0; 10], LIMIT + 1, "time").is_err());
        assert!(Packing::Lz4.unpack(&[0; 10], 1 << 20, "time").is_err());
    }
}
