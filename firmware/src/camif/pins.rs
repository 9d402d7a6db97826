//! What the block sees on its pins: two sync wires, the data bus, the clock's edges.

/// Levels of the two sync wires as they are on the pins, with no polarity applied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sync {
    /// HSYNC (HREF, LV) is high.
    pub hsync: bool,
    /// VSYNC (FV) is high.
    pub vsync: bool,
}

/// All input pins at one edge of the pixel clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pins {
    /// The sync wires.
    pub sync: Sync,
    /// The data bus, D0 in bit 0. Bits above the bus width are ignored by the block.
    pub data: u16,
}

/// An edge of the pixel clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Low to high.
    Rising,
    /// High to low.
    Falling,
}

/// Samples of the data bus, one a pixel clock, taken at the active clock edge.
#[derive(Clone, Copy, Debug)]
pub enum Samples<'a> {
    /// An 8-bit bus.
    Bytes(&'a [u8]),
    /// A bus of up to 14 bits.
    Words(&'a [u16]),
    /// The bus holds one value, as in blanking.
    Repeat {
        /// The value held.
        value: u16,
        /// Pixel clocks.
        clocks: u32,
    },
}

impl<'a> Samples<'a> {
    /// Pixel clocks.
    #[must_use]
    #[inline]
    pub fn len(&self) -> usize {
        match *self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Words(words) => words.len(),
            Self::Repeat { clocks, .. } => clocks as usize,
        }
    }

    /// No pixel clock at all.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The sample at clock `index`, if there is one.
    #[must_use]
    #[inline]
    pub fn get(&self, index: usize) -> Option<u16> {
        match *self {
            Self::Bytes(bytes) => bytes.get(index).map(|&byte| u16::from(byte)),
            Self::Words(words) => words.get(index).copied(),
            Self::Repeat { value, clocks } => (index < clocks as usize).then_some(value),
        }
    }

    /// The samples from clock `start` on; empty past the end.
    #[must_use]
    #[inline]
    pub fn skip(&self, start: usize) -> Samples<'a> {
        match *self {
            Self::Bytes(bytes) => Self::Bytes(bytes.get(start..).unwrap_or(&[])),
            Self::Words(words) => Self::Words(words.get(start..).unwrap_or(&[])),
            Self::Repeat { value, clocks } => {
                let start = u32::try_from(start).unwrap_or(u32::MAX);
                Self::Repeat { value, clocks: clocks.saturating_sub(start) }
            }
        }
    }

    /// At most the first `count` samples.
    #[must_use]
    #[inline]
    pub fn take(&self, count: usize) -> Samples<'a> {
        match *self {
            Self::Bytes(bytes) => Self::Bytes(bytes.get(..count).unwrap_or(bytes)),
            Self::Words(words) => Self::Words(words.get(..count).unwrap_or(words)),
            Self::Repeat { value, clocks } => {
                Self::Repeat { value, clocks: clocks.min(u32::try_from(count).unwrap_or(u32::MAX)) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_split_anywhere() {
        for samples in
            [Samples::Bytes(&[7, 7, 7]), Samples::Words(&[7, 7, 7]), Samples::Repeat { value: 7, clocks: 3 }]
        {
            for cut in 0..5 {
                let (head, tail) = (samples.take(cut), samples.skip(cut));
                assert_eq!(head.len() + tail.len(), 3);
                assert_eq!(head.get(cut), None);
                assert_eq!(tail.get(0), (cut < 3).then_some(7));
            }
        }
    }
}
