//! Canny's edge detector over a whole frame: the line part, then hysteresis.
//!
//! ```text
//! gray 8 bits ─► CannyLines ─► candidates ┐
//!                          └─► strong ────┴─► grow ─► edges, one bit a pixel
//! ```
//!
//! Reference: J. Canny, "A computational approach to edge detection", IEEE PAMI 8(6), 1986. See [`super::CannyLines`] and
//! [`super::grow`] for the parts; this joins them and makes no pass over the frame of its own.
//!
//! Memory: [`canny_memory`] words beside the result. At VGA with the 5 × 5 kernel both together are 97 KB, of which
//! the two bit maps are 77.

use super::bits::{BitMap, BitMapMut, same_size, words_a_line, words_a_map};
use super::canny_lines::{CannyLines, Norm, Thresholds};
use super::hysteresis::grow;
use super::smooth::{Gaussian3, Gaussian5, NoSmoothing, Smoothing};
use super::suppress::Marks;
use crate::image::{Error, Image};
use crate::lines::LineFilter;

/// How [`canny`] smooths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CannySmoothing {
    /// Not at all: the picture is smooth already.
    None,
    /// Gaussian of 3 × 3 pixels, 1 2 1 squared.
    Gaussian3,
    /// Gaussian of 5 × 5 pixels, σ = 1.4.
    Gaussian5,
}

/// What [`canny`] is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CannyConfig {
    /// The smoothing.
    pub smoothing: CannySmoothing,
    /// The thresholds and the norm they are in.
    pub thresholds: Thresholds,
}

impl Default for CannyConfig {
    /// The textbooks' setting: Gaussian 5 × 5, L2, 50 and 150.
    fn default() -> Self {
        let thresholds = Thresholds { low: 50, high: 150, norm: Norm::L2 };
        Self { smoothing: CannySmoothing::Gaussian5, thresholds }
    }
}

/// Words of memory that [`canny`] takes for a picture of `width × height` pixels, beside the map of edges itself.
#[must_use]
pub const fn canny_memory(width: usize, height: usize, smoothing: CannySmoothing) -> usize {
    let lines = match smoothing {
        CannySmoothing::None => CannyLines::<NoSmoothing>::memory(width),
        CannySmoothing::Gaussian3 => CannyLines::<Gaussian3>::memory(width),
        CannySmoothing::Gaussian5 => CannyLines::<Gaussian5>::memory(width),
    };
    lines.saturating_add(words_a_map(width, height))
}

/// Finds the edges of a gray picture. Whatever was in `memory` and `edges` is overwritten; afterwards `memory` begins with
/// the map of candidates.
///
/// # Errors
/// [`Error::Parameter`] if `low` is above `high`, [`Error::SizeMismatch`] if the map is not of the picture's size,
/// [`Error::BufferLength`] if `memory` is shorter than [`canny_memory`]. The map is then as it was.
pub fn canny(
    image: Image<'_, u8>,
    config: &CannyConfig,
    memory: &mut [u32],
    edges: &mut BitMapMut<'_>,
) -> Result<(), Error> {
    let (width, height) = (image.width(), image.height());
    same_size((width, height), (edges.width(), edges.height()))?;
    let (expected, got) = (canny_memory(width, height, config.smoothing), memory.len());
    if got < expected {
        return Err(Error::BufferLength { name: "memory", expected, got });
    }
    let (candidates, rows) = memory.split_at_mut(words_a_map(width, height));
    let classify = match config.smoothing {
        CannySmoothing::None => classify::<NoSmoothing>,
        CannySmoothing::Gaussian3 => classify::<Gaussian3>,
        CannySmoothing::Gaussian5 => classify::<Gaussian5>,
    };
    classify(image, config.thresholds, rows, candidates, edges)?;
    grow(BitMap::new(candidates, width, height)?, edges)
}

/// The line part over all rows, into the two maps.
fn classify<S: Smoothing>(
    image: Image<'_, u8>,
    thresholds: Thresholds,
    rows: &mut [u32],
    candidates: &mut [u32],
    strong: &mut BitMapMut<'_>,
) -> Result<(), Error> {
    let mut lines = CannyLines::<S>::new(image.width(), thresholds, rows)?;
    let mut maps = candidates.chunks_exact_mut(words_a_line(image.width())).zip(strong.rows_mut());
    let mut sink = |marks: &[Marks]| {
        if let Some((candidates, strong)) = maps.next() {
            for ((marks, candidates), strong) in marks.iter().zip(candidates).zip(strong) {
                (*candidates, *strong) = (marks.candidates, marks.strong);
            }
        }
    };
    for row in image.rows() {
        lines.push(row, &mut sink)?;
    }
    lines.finish(&mut sink);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::bits::tests::show;
    use super::*;

    fn edges(picture: &[&[u8]], smoothing: CannySmoothing, norm: Norm) -> Vec<String> {
        let (width, height) = (picture[0].len(), picture.len());
        let pixels = picture.concat();
        let mut memory = vec![u32::MAX; canny_memory(width, height, smoothing)];
        let mut words = vec![u32::MAX; words_a_map(width, height)];
        let mut map = BitMapMut::new(&mut words, width, height).unwrap();
        let config = CannyConfig { smoothing, thresholds: Thresholds { low: 50, high: 150, norm } };
        canny(Image::new(&pixels, width, height).unwrap(), &config, &mut memory, &mut map).unwrap();
        show(map.as_map())
    }

    #[test]
    fn a_step_is_one_line() {
        let step: &[u8] = &[10, 10, 10, 99, 99, 99];
        for (smoothing, norm) in [
            (CannySmoothing::None, Norm::L1),
            (CannySmoothing::Gaussian3, Norm::L2),
            (CannySmoothing::Gaussian5, Norm::L2),
        ] {
            assert_eq!(edges(&[step; 3], smoothing, norm), ["..#..."; 3], "{smoothing:?}");
        }
        let (dark, bright): (&[u8], &[u8]) = (&[10; 4], &[99; 4]);
        let made = edges(&[dark, dark, bright, bright], CannySmoothing::Gaussian5, Norm::L1);
        assert_eq!(made, ["....", "####", "....", "...."]);
    }

    #[test]
    fn a_weak_edge_lives_if_it_hangs_on_a_strong_one() {
        // Four times the step is the magnitude: from 200 at the top to 80 at the bottom.
        let lines: [[u8; 6]; 7] = core::array::from_fn(|y| {
            let right = 150 - 5 * y as u8;
            [100, 100, 100, right, right, right]
        });
        let fading = lines.each_ref().map(|line| &line[..]);
        let whole = edges(&fading, CannySmoothing::None, Norm::L1);
        assert!(whole.iter().all(|line| line.matches('#').count() == 1), "{whole:#?}");
        let weak = edges(&fading[4..], CannySmoothing::None, Norm::L1);
        assert!(weak.iter().all(|line| !line.contains('#')), "{weak:#?}");
    }

    #[test]
    fn flat_pictures_have_no_edges() {
        for smoothing in [CannySmoothing::None, CannySmoothing::Gaussian3, CannySmoothing::Gaussian5] {
            assert_eq!(edges(&[&[200; 33][..]; 2], smoothing, Norm::L2), [".".repeat(33), ".".repeat(33)]);
            assert_eq!(edges(&[&[255]], smoothing, Norm::L1), ["."]);
        }
    }
}
