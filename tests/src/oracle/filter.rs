//! Filters from their definitions: a loop over the neighbours of each pixel, and nothing shared between pixels.

/// A gray picture that answers for every coordinate: outside lies the nearest pixel inside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gray {
    /// Row by row from the top left.
    pub pixels: Vec<u8>,
    /// Pixels a line.
    pub width: usize,
    /// Lines.
    pub height: usize,
}

impl Gray {
    /// The pixel at, or nearest to, a place.
    #[must_use]
    pub fn at(&self, x: i64, y: i64) -> u8 {
        let x = x.clamp(0, self.width as i64 - 1) as usize;
        let y = y.clamp(0, self.height as i64 - 1) as usize;
        self.pixels[y * self.width + x]
    }

    /// A picture of the same size, made pixel by pixel.
    #[must_use]
    pub fn map(&self, pixel: impl Fn(i64, i64) -> u8) -> Self {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x as i64, y as i64)));
        Self { pixels: places.map(|(x, y)| pixel(x, y)).collect(), ..*self }
    }

    /// The values of the places of a `columns × lines` rectangle around a pixel, each with its offset from the centre.
    fn around(&self, x: i64, y: i64, columns: i64, lines: i64) -> Vec<(i64, i64, u8)> {
        (-(lines / 2)..=lines / 2)
            .flat_map(|dy| (-(columns / 2)..=columns / 2).map(move |dx| (dx, dy)))
            .map(|(dx, dy)| (dx, dy, self.at(x + dx, y + dy)))
            .collect()
    }
}

/// `offset + ⌊Σ weight · pixel / divisor + 1/2⌋`, clamped; the kernel is laid on the picture as it is.
#[must_use]
pub fn correlation(picture: &Gray, kernel: &[Vec<i64>], divisor: i64, offset: i64) -> Gray {
    let (lines, columns) = (kernel.len() as i64, kernel[0].len() as i64);
    picture.map(|x, y| {
        let sum: i64 = picture
            .around(x, y, columns, lines)
            .iter()
            .map(|&(dx, dy, value)| {
                kernel[(dy + lines / 2) as usize][(dx + columns / 2) as usize] * i64::from(value)
            })
            .sum();
        ((2 * sum + divisor).div_euclid(2 * divisor) + offset).clamp(0, 255) as u8
    })
}

/// The same with the kernel turned by half a turn.
#[must_use]
pub fn convolution(picture: &Gray, kernel: &[Vec<i64>], divisor: i64, offset: i64) -> Gray {
    let turned: Vec<Vec<i64>> = kernel.iter().rev().map(|row| row.iter().rev().copied().collect()).collect();
    correlation(picture, &turned, divisor, offset)
}

/// The kernel that is the product of a column and a row.
#[must_use]
pub fn product(down: &[i64], across: &[i64]) -> Vec<Vec<i64>> {
    down.iter().map(|a| across.iter().map(|b| a * b).collect()).collect()
}

/// The 5 × 5 integer Gaussian for σ = 1.4, to be divided by 159.
#[must_use]
pub fn gaussian_159() -> Vec<Vec<i64>> {
    vec![
        vec![2, 4, 5, 4, 2],
        vec![4, 9, 12, 9, 4],
        vec![5, 12, 15, 12, 5],
        vec![4, 9, 12, 9, 4],
        vec![2, 4, 5, 4, 2],
    ]
}

/// A Gaussian in floating point over `size × size` pixels.
#[must_use]
pub fn gaussian(picture: &Gray, size: i64, sigma: f64) -> Vec<f64> {
    let weight = |dx: i64, dy: i64| (-((dx * dx + dy * dy) as f64) / (2.0 * sigma * sigma)).exp();
    let mut smooth = Vec::new();
    for y in 0..picture.height as i64 {
        for x in 0..picture.width as i64 {
            let (mut sum, mut total) = (0.0, 0.0);
            for (dx, dy, value) in picture.around(x, y, size, size) {
                sum += weight(dx, dy) * f64::from(value);
                total += weight(dx, dy);
            }
            smooth.push(sum / total);
        }
    }
    smooth
}

/// The middle of the sorted values.
#[must_use]
pub fn median(picture: &Gray, size: i64) -> Gray {
    picture.map(|x, y| {
        let mut values: Vec<u8> =
            picture.around(x, y, size, size).iter().map(|&(_, _, value)| value).collect();
        values.sort_unstable();
        values[values.len() / 2]
    })
}

/// Tomasi and Manduchi's filter in floating point over the disc of diameter `size`.
#[must_use]
pub fn bilateral(picture: &Gray, size: i64, sigma_space: f64, sigma_range: f64) -> Vec<f64> {
    let mut smooth = Vec::new();
    for y in 0..picture.height as i64 {
        for x in 0..picture.width as i64 {
            let centre = f64::from(picture.at(x, y));
            let (mut sum, mut total) = (0.0, 0.0);
            for (dx, dy, value) in picture.around(x, y, size, size) {
                let distance = (dx * dx + dy * dy) as f64;
                if distance.sqrt() <= (size / 2) as f64 {
                    let difference = f64::from(value) - centre;
                    let weight = (-distance / (2.0 * sigma_space * sigma_space)).exp()
                        * (-difference * difference / (2.0 * sigma_range * sigma_range)).exp();
                    sum += weight * f64::from(value);
                    total += weight;
                }
            }
            smooth.push(sum / total);
        }
    }
    smooth
}

/// The least value under the mask, given row by row.
#[must_use]
pub fn erode(picture: &Gray, mask: &[Vec<bool>]) -> Gray {
    picture.map(|x, y| under(picture, mask, x, y, 1).min().unwrap_or(0))
}

/// The greatest value under the mask turned by half a turn.
#[must_use]
pub fn dilate(picture: &Gray, mask: &[Vec<bool>]) -> Gray {
    picture.map(|x, y| under(picture, mask, x, y, -1).max().unwrap_or(0))
}

fn under<'a>(
    picture: &'a Gray,
    mask: &'a [Vec<bool>],
    x: i64,
    y: i64,
    sign: i64,
) -> impl Iterator<Item = u8> + 'a {
    let (lines, columns) = (mask.len() as i64, mask[0].len() as i64);
    (0..lines)
        .flat_map(move |v| (0..columns).map(move |u| (u, v)))
        .filter(|&(u, v)| mask[v as usize][u as usize])
        .map(move |(u, v)| picture.at(x + sign * (u - columns / 2), y + sign * (v - lines / 2)))
}

/// Two pictures pixel by pixel.
#[must_use]
pub fn combine(a: &Gray, b: &Gray, pixel: impl Fn(i64, i64) -> i64) -> Gray {
    a.map(|x, y| pixel(i64::from(a.at(x, y)), i64::from(b.at(x, y))).clamp(0, 255) as u8)
}
