//! Gray-edge: the mean of the scene's edges is taken for gray.
//!
//! ```text
//! white ∝ Σ |right − here|ᵖ + |below − here|ᵖ, then the p-th root          p = 1 or 2
//! ```
//!
//! J. van de Weijer, T. Gevers, A. Gijsenij, "Edge-based color constancy", IEEE Trans. Image Processing 16 (2007), first
//! order. Differences are forward ones; the smoothing σ of the paper is a Gaussian filter put before this estimate.
//! The result is scaled so that its brightest channel is 255: edges say nothing of the light's brightness.
//!
//! **Cost and memory.** Two differences a byte. One line, lent by the caller.

use super::White;
use crate::image::{Error, Rgb};
use crate::lines::check_width;
use crate::pixel::rgb888;

/// How differences are summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    /// Sum of magnitudes (Minkowski p = 1).
    L1,
    /// Root of the sum of squares (p = 2): strong edges count for more.
    L2,
}

/// Sums a picture's differences line by line.
#[derive(Debug)]
pub struct GrayEdge<'a> {
    above: &'a mut [Rgb],
    has_above: bool,
    norm: Norm,
    sums: [u64; 3],
}

impl<'a> GrayEdge<'a> {
    /// For lines as long as the lent one.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if the lent line is empty.
    pub fn new(norm: Norm, line: &'a mut [Rgb]) -> Result<Self, Error> {
        if line.is_empty() {
            return Err(Error::ZeroSize { width: 0, height: 1 });
        }
        Ok(Self { above: line, has_above: false, norm, sums: [0; 3] })
    }

    /// Takes a line.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if it is not as long as the lent one.
    pub fn push(&mut self, line: &[Rgb]) -> Result<(), Error> {
        check_width(self.above.len(), line.len())?;
        let bytes = rgb888::as_bytes(line);
        self.add(sum_differences(bytes, &bytes[3..], self.norm));
        if self.has_above {
            self.add(sum_differences(rgb888::as_bytes(self.above), bytes, self.norm));
        }
        self.above.copy_from_slice(line);
        self.has_above = true;
        Ok(())
    }

    fn add(&mut self, sums: [u64; 3]) {
        self.sums.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
    }

    /// The light's colour, and is ready for the next frame. `None` if no channel has an edge.
    pub fn finish(&mut self) -> Option<White> {
        self.has_above = false;
        let sums = core::mem::take(&mut self.sums);
        let norms = match self.norm {
            Norm::L1 => sums,
            // Eight more bits before the root keep four after it: small pictures have small sums.
            Norm::L2 => sums.map(|sum| sum.saturating_mul(256).isqrt()),
        };
        let most = norms.into_iter().max().filter(|&most| most > 0)?;
        let [r, g, b] = norms.map(|norm| {
            let scaled = (u128::from(norm) * (255 << 8) + u128::from(most / 2)) / u128::from(most);
            scaled as u16
        });
        Some(White { r, g, b })
    }
}

/// Sums over the shorter of two runs of bytes, channel by channel.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn sum_differences(one: &[u8], other: &[u8], norm: Norm) -> [u64; 3] {
    /// A multiple of 3 and of 32; a column of squares takes at most 65,025 a row.
    const COLUMNS: usize = 96;
    let mut sums = [0; 3];
    let length = one.len().min(other.len());
    for (one, other) in one[..length].chunks(COLUMNS * 256).zip(other[..length].chunks(COLUMNS * 256)) {
        let mut columns = [0u32; COLUMNS];
        for (one, other) in one.chunks(COLUMNS).zip(other.chunks(COLUMNS)) {
            for ((column, &a), &b) in columns.iter_mut().zip(one).zip(other) {
                let difference = u32::from(a.abs_diff(b));
                *column += match norm {
                    Norm::L1 => difference,
                    Norm::L2 => difference * difference,
                };
            }
        }
        for (at, &column) in columns.iter().enumerate() {
            sums[at % 3] += u64::from(column);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_edge_either_way_counts_once() {
        // A single lit pixel has an edge on all four sides.
        let (dark, lit) = (Rgb::new(10, 10, 10), Rgb::new(60, 110, 20));
        let frame = [[dark; 3], [dark, lit, dark], [dark; 3]];
        for norm in [Norm::L1, Norm::L2] {
            let mut above = [Rgb::default(); 3];
            let mut edges = GrayEdge::new(norm, &mut above).unwrap();
            for _ in 0..2 {
                frame.iter().for_each(|line| edges.push(line).unwrap());
                let white = edges.finish().unwrap();
                assert_eq!(white, White { r: 127 << 8 | 128, g: 255 << 8, b: 25 << 8 | 128 });
            }
            edges.push(&[dark; 3]).unwrap();
            assert_eq!(edges.finish(), None, "no edge, no light");
            assert!(edges.push(&[dark; 2]).is_err());
        }
        assert!(GrayEdge::new(Norm::L1, &mut []).is_err());
    }
}
