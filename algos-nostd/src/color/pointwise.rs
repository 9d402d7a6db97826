//! What changes each pixel by itself, run as a line filter.
//!
//! ```text
//! line ─► copy into a lent line ─► apply ─► sink        LATENCY = 0, memory: one line
//! ```
//!
//! Gains, matrices and curves work in place on a line that the caller owns. Where they must stand in a chain of
//! [`LineFilter`]s, [`Pointwise`] lends them a line to work in.

use crate::image::Error;
use crate::lines::{LineFilter, LineSink, check_width};

/// Changes pixels in place, each by itself.
pub trait PixelMap<P> {
    /// Changes every pixel of the line.
    fn apply_line(&self, line: &mut [P]);
}

/// A [`PixelMap`] as a line filter.
#[derive(Debug)]
pub struct Pointwise<'a, P, M> {
    map: M,
    line: &'a mut [P],
}

impl<'a, P: Copy, M: PixelMap<P>> Pointwise<'a, P, M> {
    /// A filter for lines as long as the lent one.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if the lent line is empty.
    pub fn new(map: M, line: &'a mut [P]) -> Result<Self, Error> {
        if line.is_empty() {
            return Err(Error::ZeroSize { width: 0, height: 1 });
        }
        Ok(Self { map, line })
    }
}

impl<P: Copy, M: PixelMap<P>> LineFilter for Pointwise<'_, P, M> {
    type Input = P;
    type Output = P;

    const LATENCY: usize = 0;

    fn push(&mut self, line: &[P], sink: &mut impl LineSink<P>) -> Result<(), Error> {
        check_width(self.line.len(), line.len())?;
        self.line.copy_from_slice(line);
        self.map.apply_line(self.line);
        sink.line(self.line);
        Ok(())
    }

    fn finish(&mut self, _: &mut impl LineSink<P>) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Double;

    impl PixelMap<u8> for Double {
        fn apply_line(&self, line: &mut [u8]) {
            line.iter_mut().for_each(|value| *value *= 2);
        }
    }

    #[test]
    fn a_map_is_a_filter() {
        let mut line = [0; 3];
        let mut filter = Pointwise::new(Double, &mut line).unwrap();
        let mut seen = [0; 3];
        filter.push(&[1, 2, 3], &mut |line: &[u8]| seen.copy_from_slice(line)).unwrap();
        assert_eq!(seen, [2, 4, 6]);
        assert!(filter.push(&[1], &mut |_: &[u8]| {}).is_err());
        assert!(Pointwise::new(Double, &mut []).is_err());
    }
}
