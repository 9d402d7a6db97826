//! k-means: each colour of a palette moves to the mean of the colours nearest to it, again and again.
//!
//! ```text
//!   ∙ ∙ ○   ∙  ○          ∙ ∙     ∙            each weighted colour ∙ votes for the nearest ○,
//!    ∙       ∙ ∙    ─►     ○        ○ ∙   ─►    each ○ goes to the mean of its voters, until none moves
//! ```
//!
//! Reference: Lloyd, "Least Squares Quantization in PCM", 1982; weighted colours as in Celebi, "Improving the
//! Performance of K-Means for Color Quantization", 2011. It only ever lowers the squared error, to the nearest local
//! minimum, so it wants a good start: [`super::Wu`]'s palette, or any other.
//!
//! Deterministic: means are kept in quarters of a level, the first of equally near colours is taken, and a colour
//! without voters stays where it is.
//!
//! Cost: colours × palette × 3 multiplications an iteration, in vector code where there is some. Memory: a
//! [`Cluster`] and a [`Probe`] for each colour of the palette, 64 bytes.

use super::nearest::{BLOCK, Probe, nearest_of_block};
use super::palette::{Total, WeightedColor, check_colors, check_palette, lent, quarters, rounded};
use crate::image::{Error, Rgb};

/// A palette colour, and the sum of what is nearest to it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cluster {
    center: [u16; 3],
    total: Total,
}

impl Cluster {
    /// A place to be filled.
    pub const EMPTY: Self = Self { center: [0; 3], total: Total { count: 0, sum: [0; 3] } };
}

/// Refines palettes, in lent memory.
#[derive(Debug)]
pub struct KMeans<'a> {
    clusters: &'a mut [Cluster],
    probes: &'a mut [Probe],
}

impl<'a> KMeans<'a> {
    /// Lent memory: as many clusters and probes as palettes will have colours.
    #[must_use]
    pub fn new(clusters: &'a mut [Cluster], probes: &'a mut [Probe]) -> Self {
        Self { clusters, probes }
    }

    /// Moves the colours of `palette` for at most `iterations`, fewer if nothing moves any more; says how many it
    /// took.
    ///
    /// # Errors
    /// If the palette's length is not 1 to 256, there is less memory than that, or the colours stand for no pixel
    /// or too many; the palette is then as it was.
    pub fn refine(
        &mut self,
        colors: &[WeightedColor],
        palette: &mut [Rgb],
        iterations: usize,
    ) -> Result<usize, Error> {
        check_palette(palette)?;
        check_colors(colors)?;
        let clusters = lent("clusters", self.clusters, palette.len())?;
        let probes = lent("probes", self.probes, palette.len())?;
        for (cluster, &color) in clusters.iter_mut().zip(palette.iter()) {
            cluster.center = quarters(color);
        }
        let mut taken = 0;
        let mut moved = true;
        while moved && taken < iterations {
            vote(colors, clusters, probes);
            moved = false;
            for cluster in clusters.iter_mut() {
                let mean = cluster.total.mean().unwrap_or(cluster.center);
                moved |= mean != cluster.center;
                cluster.center = mean;
            }
            taken += 1;
        }
        for (color, cluster) in palette.iter_mut().zip(clusters.iter()) {
            *color = rounded(cluster.center);
        }
        Ok(taken)
    }
}

/// Sums up for each cluster the colours that are nearest to it.
fn vote(colors: &[WeightedColor], clusters: &mut [Cluster], probes: &mut [Probe]) {
    for (index, (cluster, probe)) in clusters.iter_mut().zip(probes.iter_mut()).enumerate() {
        cluster.total = Total::default();
        *probe = Probe::new(cluster.center, index);
    }
    let mut block = [[0; BLOCK]; 3];
    for chunk in colors.chunks(BLOCK) {
        for (lane, color) in chunk.iter().enumerate() {
            for (channel, level) in block.iter_mut().zip(color.quarters()) {
                channel[lane] = i32::from(level);
            }
        }
        for (&color, index) in chunk.iter().zip(nearest_of_block(probes, &block)) {
            if let Some(cluster) = clusters.get_mut(usize::from(index)) {
                cluster.total.add(color);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(level: u8, count: u32) -> WeightedColor {
        WeightedColor::new(Rgb { r: level, g: level, b: level }, count)
    }

    #[test]
    fn two_heaps_draw_two_colours_and_the_third_stays() {
        let (mut clusters, mut probes) = ([Cluster::EMPTY; 3], [Probe::EMPTY; 3]);
        let mut kmeans = KMeans::new(&mut clusters, &mut probes);
        let colors = [gray(10, 3), gray(14, 1), gray(200, 5)];
        let blue = Rgb { r: 0, g: 0, b: 255 };
        let mut palette = [gray(100, 0).rounded(), gray(120, 0).rounded(), blue];
        assert_eq!(kmeans.refine(&colors, &mut palette, 9), Ok(2), "the second finds that nothing moves");
        assert_eq!(palette, [gray(11, 0).rounded(), gray(200, 0).rounded(), blue]);
        assert_eq!(kmeans.refine(&colors, &mut palette, 0), Ok(0));
    }

    #[test]
    fn bad_parameters_are_refused() {
        let (mut clusters, mut probes) = ([Cluster::EMPTY; 2], [Probe::EMPTY; 1]);
        let mut kmeans = KMeans::new(&mut clusters, &mut probes);
        assert!(kmeans.refine(&[], &mut [Rgb::default()], 1).is_err());
        assert!(kmeans.refine(&[gray(0, 1)], &mut [], 1).is_err());
        assert_eq!(
            kmeans.refine(&[gray(0, 1)], &mut [Rgb::default(); 2], 1),
            Err(Error::BufferLength { name: "probes", expected: 2, got: 1 })
        );
    }
}
