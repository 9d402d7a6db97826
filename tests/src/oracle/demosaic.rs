//! Demosaic from the papers' figures: for every pixel and channel the stencil is looked up and weighed in floating point.

/// Which channel (0 red, 1 green, 2 blue) a mosaic named like `"rggb"` has at a place.
#[must_use]
pub fn channel(name: &str, x: i64, y: i64) -> usize {
    let at = (2 * y.rem_euclid(2) + x.rem_euclid(2)) as usize;
    "rgb".find(&name[at..=at]).expect("a mosaic is named by r, g and b")
}

/// A mosaic with a name, mirrored about its outermost lines and columns.
#[derive(Debug)]
pub struct Mosaic<'a> {
    /// Samples, line after line.
    pub samples: &'a [u16],
    /// Samples a line.
    pub width: i64,
    /// The order, such as `"rggb"`.
    pub name: &'a str,
}

impl Mosaic<'_> {
    fn sample(&self, x: i64, y: i64) -> f64 {
        let mirrored = |at: i64, length: i64| {
            let period = (2 * (length - 1)).max(1);
            let at = at.rem_euclid(period);
            at.min(period - at)
        };
        let height = self.samples.len() as i64 / self.width;
        f64::from(self.samples[(mirrored(y, height) * self.width + mirrored(x, self.width)) as usize])
    }

    fn weigh(&self, x: i64, y: i64, stencil: &[[f64; 5]; 5]) -> f64 {
        let mut sum = 0.0;
        for (row, weights) in stencil.iter().enumerate() {
            for (column, weight) in weights.iter().enumerate() {
                sum += weight * self.sample(x + column as i64 - 2, y + row as i64 - 2);
            }
        }
        sum
    }

    /// The mean of the nearest samples of a channel.
    #[must_use]
    pub fn bilinear(&self, x: i64, y: i64, wanted: usize) -> f64 {
        if channel(self.name, x, y) == wanted {
            return self.sample(x, y);
        }
        for ring in [&[(0, -1), (-1, 0), (1, 0), (0, 1)][..], &[(-1, -1), (1, -1), (-1, 1), (1, 1)]] {
            let found: Vec<f64> = ring
                .iter()
                .filter(|(dx, dy)| channel(self.name, x + dx, y + dy) == wanted)
                .map(|(dx, dy)| self.sample(x + dx, y + dy))
                .collect();
            if !found.is_empty() {
                return found.iter().sum::<f64>() / found.len() as f64;
            }
        }
        unreachable!("every channel lies within 3 × 3")
    }

    /// The stencils of Malvar, He and Cutler (2004), figure 2, over 8.
    #[must_use]
    pub fn malvar(&self, x: i64, y: i64, wanted: usize) -> f64 {
        let here = channel(self.name, x, y);
        if here == wanted {
            return self.sample(x, y);
        }
        let green = [
            [0.0, 0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 2.0, 0.0, 0.0],
            [-1.0, 2.0, 4.0, 2.0, -1.0],
            [0.0, 0.0, 2.0, 0.0, 0.0],
            [0.0, 0.0, -1.0, 0.0, 0.0],
        ];
        let beside = [
            [0.0, 0.0, 0.5, 0.0, 0.0],
            [0.0, -1.0, 0.0, -1.0, 0.0],
            [-1.0, 4.0, 5.0, 4.0, -1.0],
            [0.0, -1.0, 0.0, -1.0, 0.0],
            [0.0, 0.0, 0.5, 0.0, 0.0],
        ];
        let across = [
            [0.0, 0.0, -1.5, 0.0, 0.0],
            [0.0, 2.0, 0.0, 2.0, 0.0],
            [-1.5, 0.0, 6.0, 0.0, -1.5],
            [0.0, 2.0, 0.0, 2.0, 0.0],
            [0.0, 0.0, -1.5, 0.0, 0.0],
        ];
        let mut above = beside;
        for (row, weights) in above.iter_mut().enumerate() {
            for (column, weight) in weights.iter_mut().enumerate() {
                *weight = beside[column][row];
            }
        }
        let stencil = match (wanted, here) {
            (1, _) => green,
            (_, 1) if channel(self.name, x + 1, y) == wanted => beside,
            (_, 1) => above,
            _ => across,
        };
        self.weigh(x, y, &stencil) / 8.0
    }
}
