use std::borrow::Cow;
use std::path::{Path, PathBuf};

use image::RgbImage;
use image::imageops::FilterType;

use crate::picture::{self, PictureError};

/// A picture file as a scene.
#[derive(Clone, Debug)]
pub struct Still {
    path: PathBuf,
    picture: RgbImage,
}

impl Still {
    /// Reads a PNG or JPEG file; see [`picture::read`].
    ///
    /// # Errors
    /// Those of [`picture::read`].
    pub fn open(path: &Path) -> Result<Self, PictureError> {
        Ok(Self { path: path.to_owned(), picture: picture::read(path)? })
    }

    /// A picture that is in memory; `path` is what reports call it.
    #[must_use]
    pub fn new(path: PathBuf, picture: RgbImage) -> Self {
        Self { path, picture }
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What to tell the user if a frame of this size can't hold the file's pixels as they are.
    #[must_use]
    pub fn scaling_note(&self, width: u32, height: u32) -> Option<String> {
        let (from_width, from_height) = self.picture.dimensions();
        if (from_width, from_height) == (width, height) {
            return None;
        }
        let distorted =
            u64::from(from_width) * u64::from(height) != u64::from(width) * u64::from(from_height);
        Some(format!(
            "{} is {from_width} × {from_height} pixels, scaled to {width} × {height}{}",
            self.path.display(),
            if distorted { " without keeping its proportions" } else { "" }
        ))
    }

    /// The picture in this size: its own pixels if the size is its own, else scaled to fill the frame, bilinear
    /// with the pixels averaged that fall together.
    #[must_use]
    pub fn scaled(&self, width: u32, height: u32) -> RgbImage {
        Self::fit(&self.picture, width, height).into_owned()
    }

    /// The same of a picture that is at hand.
    #[must_use]
    pub fn fit(picture: &RgbImage, width: u32, height: u32) -> Cow<'_, RgbImage> {
        if picture.dimensions() == (width, height) {
            Cow::Borrowed(picture)
        } else {
            Cow::Owned(image::imageops::resize(picture, width, height, FilterType::Triangle))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_own_size_is_its_own_pixels() {
        let picture = RgbImage::from_fn(4, 2, |x, y| image::Rgb([x as u8 * 60, y as u8 * 90, 7]));
        let still = Still::new("small.png".into(), picture.clone());
        assert_eq!(still.scaled(4, 2), picture);
        assert_eq!(still.scaling_note(4, 2), None);
    }

    #[test]
    fn another_size_is_scaled_and_said() {
        let still = Still::new("red.png".into(), RgbImage::from_pixel(4, 2, image::Rgb([200, 3, 1])));
        let scaled = still.scaled(8, 8);
        assert_eq!(scaled.dimensions(), (8, 8));
        assert!(scaled.pixels().all(|pixel| pixel.0 == [200, 3, 1]));
        assert_eq!(
            still.scaling_note(8, 8).unwrap(),
            "red.png is 4 × 2 pixels, scaled to 8 × 8 without keeping its proportions"
        );
        assert_eq!(still.scaling_note(8, 4).unwrap(), "red.png is 4 × 2 pixels, scaled to 8 × 4");
    }

    #[test]
    fn a_picture_without_pixels_is_no_fault() {
        assert_eq!(Still::new("none".into(), RgbImage::new(0, 0)).scaled(4, 3).dimensions(), (4, 3));
    }
}
