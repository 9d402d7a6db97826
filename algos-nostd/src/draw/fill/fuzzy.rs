use super::Area;
use super::span::{PendingRun, fill_runs};
use crate::clip::{Point, Window};
use crate::image::{Error, Image, ImageMut, Rgb};

/// How unlike two pixels are.
pub trait Distance: Copy {
    /// The greatest difference of a channel, 0 to 255.
    fn distance(self, other: Self) -> u8;
}

impl Distance for u8 {
    fn distance(self, other: Self) -> u8 {
        self.abs_diff(other)
    }
}

impl Distance for Rgb {
    fn distance(self, other: Self) -> u8 {
        self.r.abs_diff(other.r).max(self.g.abs_diff(other.g)).max(self.b.abs_diff(other.b))
    }
}

/// Finds the pixels that are like the seed and joined to it, and writes how much they belong to `mask`: 255 wholly, 0
/// not at all. Returns how many were found. The picture is not changed; see [`paint_mask`](crate::draw::paint_mask).
///
/// ```text
/// alpha
/// 255 ──────╮
///           │╲          distance = |pixel − seed|, the greatest over the channels
///   0       │ ╲─────
///     tolerance  + softness
/// ```
///
/// Pixels up to `tolerance` from the seed's colour get 255; over the `softness` next values alpha falls evenly and
/// pixels still belong; what lies beyond is a wall. Pixels whose mask is not 0 to begin with are walls and are
/// left alone, so that several fills add up in one mask.
///
/// Reference: the "magic wand" of painting programs; runs as in [`flood_fill`](super::flood_fill).
///
/// Cost: each pixel of the area is compared a few times. Memory: `pending`, see [`flood_fill`](super::flood_fill).
///
/// # Errors
/// [`Error::SizeMismatch`] if the mask is not as large as the picture; it is then not touched.
pub fn fuzzy_fill<P: Distance>(
    image: Image<'_, P>,
    seed: Point,
    (tolerance, softness): (u8, u8),
    mask: &mut ImageMut<'_, u8>,
    pending: &mut [PendingRun],
) -> Result<usize, Error> {
    let expected = (image.width(), image.height());
    let got = (mask.width(), mask.height());
    if expected != got {
        return Err(Error::SizeMismatch { expected, got });
    }
    let window = Window::of(&image);
    let last = window.bottom_right();
    let size = (i32::from(last.x) + 1, i32::from(last.y) + 1);
    let Some(&color) = window.contains(seed).then(|| image.pixel(seed.x as usize, seed.y as usize)).flatten()
    else {
        return Ok(0);
    };
    let mut area = Similar { image, mask: mask.reborrow(), size, color, tolerance, softness };
    Ok(fill_runs(&mut area, seed, pending))
}

struct Similar<'a, 'b, P> {
    image: Image<'a, P>,
    mask: ImageMut<'b, u8>,
    size: (i32, i32),
    color: P,
    tolerance: u8,
    softness: u8,
}

impl<P: Distance> Similar<'_, '_, P> {
    fn alpha(&self, pixel: P) -> u8 {
        let beyond = u32::from(pixel.distance(self.color).saturating_sub(self.tolerance));
        let steps = u32::from(self.softness) + 1;
        // 255 · (steps − beyond) / steps, rounded; 1 at least while beyond < steps.
        ((255 * steps.saturating_sub(beyond) * 2 + steps) / (2 * steps)) as u8
    }
}

impl<P: Distance> Area for Similar<'_, '_, P> {
    fn size(&self) -> (i32, i32) {
        self.size
    }

    fn has(&self, x: i32, y: i32) -> bool {
        let place = (x as usize, y as usize);
        x < self.size.0
            && self.mask.as_image().pixel(place.0, place.1) == Some(&0)
            && self.image.pixel(place.0, place.1).is_some_and(|&pixel| self.alpha(pixel) > 0)
    }

    fn run_end(&self, x: i32, y: i32) -> i32 {
        (x..self.size.0).find(|&x| !self.has(x, y)).unwrap_or(self.size.0)
    }

    fn run_start(&self, x: i32, y: i32) -> i32 {
        (0..x).rev().find(|&x| !self.has(x, y)).map_or(0, |wall| wall + 1)
    }

    fn paint(&mut self, start: i32, end: i32, y: i32) {
        for x in start as usize..end as usize {
            let alpha = self.image.pixel(x, y as usize).map_or(0, |&pixel| self.alpha(pixel));
            if let Some(place) = self.mask.pixel_mut(x, y as usize) {
                *place = alpha;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_falls_with_the_distance() {
        let pixels = [100, 110, 111, 112, 113, 114, 100, 100];
        let image = Image::new(&pixels, 8, 1).unwrap();
        let mut mask = [0; 8];
        let mut view = ImageMut::new(&mut mask, 8, 1).unwrap();
        let found = fuzzy_fill(image, Point::new(0, 0), (10, 3), &mut view, &mut []).unwrap();
        assert_eq!((found, mask), (5, [255, 255, 191, 128, 64, 0, 0, 0]));
    }

    #[test]
    fn fills_add_up_in_a_mask() {
        let pixels = [0, 0, 9, 5, 5, 9, 0, 0];
        let image = Image::new(&pixels, 8, 1).unwrap();
        let mut mask = [0; 8];
        let mut view = ImageMut::new(&mut mask, 8, 1).unwrap();
        let mut pending = [PendingRun::default(); 4];
        for (seed, found) in [(0, 2), (7, 2), (1, 0)] {
            let seed = Point::new(seed, 0);
            assert_eq!(fuzzy_fill(image, seed, (1, 0), &mut view, &mut pending), Ok(found));
        }
        assert_eq!(mask, [255, 255, 0, 0, 0, 0, 255, 255]);
    }

    #[test]
    fn the_mask_must_fit() {
        let image = Image::new(&[0u8; 4], 2, 2).unwrap();
        let mut mask = [0; 4];
        let mut view = ImageMut::new(&mut mask, 4, 1).unwrap();
        let error = Error::SizeMismatch { expected: (2, 2), got: (4, 1) };
        assert_eq!(fuzzy_fill(image, Point::new(0, 0), (1, 0), &mut view, &mut []), Err(error));
    }
}
