use std::fmt;

/// A pixel format's code: four characters, with the highest bit set for the big-endian ones.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FourCc(pub u32);

impl FourCc {
    /// The code of four characters.
    #[must_use]
    pub const fn new(characters: &[u8; 4]) -> Self {
        Self(u32::from_le_bytes(*characters))
    }

    /// The same, big-endian.
    #[must_use]
    pub const fn big_endian(self) -> Self {
        Self(self.0 | 1 << 31)
    }

    /// Reads what [`fmt::Display`] writes: up to four characters, spaces at the end left out or not, and `-BE`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (name, big_endian) = match text.strip_suffix("-BE") {
            Some(name) => (name, true),
            None => (text, false),
        };
        let mut characters = [b' '; 4];
        if name.is_empty() || name.len() > 4 || !name.bytes().all(|byte| (b' '..0x7F).contains(&byte)) {
            return None;
        }
        characters[..name.len()].copy_from_slice(name.as_bytes());
        let code = Self::new(&characters);
        Some(if big_endian { code.big_endian() } else { code })
    }
}

impl fmt::Display for FourCc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let characters = (self.0 & !(1 << 31)).to_le_bytes();
        let name: String = characters.iter().map(|byte| char::from(*byte)).collect();
        write!(f, "{}{}", name.trim_end().escape_default(), if self.0 >> 31 == 1 { "-BE" } else { "" })
    }
}

impl fmt::Debug for FourCc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_read_as_they_are_written() {
        for text in ["YUYV", "Y16", "Y16-BE", "RGB3", "pBAA", "XR15-BE"] {
            assert_eq!(FourCc::parse(text).unwrap().to_string(), text);
        }
        assert_eq!(FourCc::parse("Y16 "), FourCc::parse("Y16"));
        assert_eq!(FourCc::parse("YUYV"), Some(FourCc(0x5659_5559)));
        for text in ["", "-BE", "YUYV2", "Ä", "a\n"] {
            assert_eq!(FourCc::parse(text), None, "{text:?}");
        }
        assert_eq!(FourCc(0).to_string(), r"\u{0}\u{0}\u{0}\u{0}", "what no driver should say");
    }
}
