use super::pixel::change;
use crate::image::{Error, Image, ImageMut, Rgb};

/// `value / 255`, rounded to the nearest (there is no tie): exact from 0 to 65,535, without a division.
#[inline]
#[must_use]
pub const fn divide_by_255(value: u32) -> u32 {
    // 1/255 = 1/256 + 1/256² + …: the second term is enough up to 16 bits.
    let rounded = value + 128;
    (rounded + (rounded >> 8)) >> 8
}

/// Opaque pixels that another colour can be laid over in part.
pub trait Mix: Copy {
    /// This colour over another one, covering `alpha`/255 of it: this·α + over·(1 − α), each channel rounded once to
    /// the nearest.
    #[must_use]
    fn mix(self, over: Self, alpha: u8) -> Self;
}

impl Mix for u8 {
    #[inline]
    fn mix(self, over: Self, alpha: u8) -> Self {
        let alpha = u32::from(alpha);
        divide_by_255(u32::from(self) * alpha + u32::from(over) * (255 - alpha)) as u8
    }
}

impl Mix for Rgb {
    #[inline]
    fn mix(self, over: Self, alpha: u8) -> Self {
        Self { r: self.r.mix(over.r, alpha), g: self.g.mix(over.g, alpha), b: self.b.mix(over.b, alpha) }
    }
}

/// Lays a colour over a picture as thickly as a mask says: 255 covers, 0 leaves as it is.
///
/// # Errors
/// [`Error::SizeMismatch`] if the mask is not as large as the picture, which is then not touched.
pub fn paint_mask<P: Mix>(image: &mut ImageMut<'_, P>, mask: Image<'_, u8>, color: P) -> Result<(), Error> {
    let expected = (image.width(), image.height());
    let got = (mask.width(), mask.height());
    if expected != got {
        return Err(Error::SizeMismatch { expected, got });
    }
    for (row, mask_row) in image.rows_mut().zip(mask.rows()) {
        for (pixel, &alpha) in row.iter_mut().zip(mask_row) {
            *pixel = color.mix(*pixel, alpha);
        }
    }
    Ok(())
}

/// Lays a colour over one pixel, if it is in the picture.
#[inline]
pub(super) fn cover<P: Mix>(image: &mut ImageMut<'_, P>, x: i32, y: i32, color: P, alpha: u8) {
    change(image, x, y, |old| color.mix(old, alpha));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn division_by_255_is_exact() {
        for value in 0..=65_535 {
            assert_eq!(divide_by_255(value), (2 * value + 255) / 510);
        }
    }

    #[test]
    fn the_ends_of_alpha_are_the_two_colours() {
        for old in 0..=255u8 {
            assert_eq!((77.mix(old, 0), 77.mix(old, 255), old.mix(old, 99)), (old, 77, old));
        }
    }

    #[test]
    fn a_mask_lays_on_colour() {
        let (red, blue) = (Rgb { r: 255, g: 0, b: 0 }, Rgb { r: 0, g: 0, b: 255 });
        let mut pixels = [blue; 3];
        let mut image = ImageMut::new(&mut pixels, 3, 1).unwrap();
        let mask = [0, 51, 255];
        paint_mask(&mut image, Image::new(&mask, 3, 1).unwrap(), red).unwrap();
        assert!(paint_mask(&mut image, Image::new(&mask, 1, 3).unwrap(), red).is_err());
        assert_eq!(pixels, [blue, Rgb { r: 51, g: 0, b: 204 }, red]);
    }
}
