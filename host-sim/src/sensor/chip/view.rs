use image::{Rgb, RgbImage};

/// A window on the sensor's whole picture, and the size in which it comes out. In pixels of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct View {
    /// The whole picture, which shows all of the scene.
    pub whole: (u32, u32),
    /// Where the window starts; outside the picture it is black.
    pub origin: (i64, i64),
    /// Its size.
    pub size: (u32, u32),
    /// Pixels of the output.
    pub output: (u32, u32),
}

impl View {
    /// What it shows of a scene, which is asked for a picture of a size.
    pub(super) fn show(&self, render: impl FnOnce(u32, u32) -> RgbImage) -> RgbImage {
        let scaled =
            |length: i64, size: u32, output: u32| length * i64::from(output) / i64::from(size.max(1));
        let (width, height) = self.output;
        let whole = (
            scaled(i64::from(self.whole.0), self.size.0, width).max(1) as u32,
            scaled(i64::from(self.whole.1), self.size.1, height).max(1) as u32,
        );
        let origin = (scaled(self.origin.0, self.size.0, width), scaled(self.origin.1, self.size.1, height));
        let picture = render(whole.0, whole.1);
        if origin == (0, 0) && picture.dimensions() == self.output {
            return picture;
        }
        RgbImage::from_fn(width, height, |x, y| {
            let at = (u32::try_from(origin.0 + i64::from(x)), u32::try_from(origin.1 + i64::from(y)));
            match at {
                (Ok(x), Ok(y)) => picture.get_pixel_checked(x, y).copied().unwrap_or(Rgb([0; 3])),
                _ => Rgb([0; 3]),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture in which each pixel is its own place.
    fn places(width: u32, height: u32) -> RgbImage {
        RgbImage::from_fn(width, height, |x, y| Rgb([x as u8 + 1, y as u8 + 1, 0]))
    }

    #[test]
    fn the_whole_is_the_picture_itself() {
        let view = View { whole: (8, 4), origin: (0, 0), size: (8, 4), output: (4, 2) };
        assert_eq!(view.show(places), places(4, 2));
    }

    #[test]
    fn a_window_beside_the_picture_is_black_there() {
        let view = View { whole: (4, 2), origin: (-1, 1), size: (4, 2), output: (4, 2) };
        let seen = view.show(places);
        assert_eq!(seen.get_pixel(0, 0).0, [0; 3]);
        assert_eq!(seen.get_pixel(1, 0).0, [1, 2, 0]);
        assert_eq!(seen.get_pixel(1, 1).0, [0; 3]);
    }
}
