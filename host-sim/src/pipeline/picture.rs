use algos_nostd::image::{Error, Image, ImageMut, Rgb};
use algos_nostd::lines::{LineFilter, run};
use algos_nostd::pixel::{gray8, rgb888};
use image::RgbImage;
use rgb::FromSlice as _;

/// A picture that owns its pixels, line after line without a gap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame<P> {
    pixels: Vec<P>,
    width: usize,
    height: usize,
}

impl<P: Copy> Frame<P> {
    /// A picture of one value.
    #[must_use]
    pub fn filled(width: usize, height: usize, value: P) -> Self {
        Self { pixels: vec![value; width * height], width, height }
    }

    /// Pixels a line.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Lines.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels.
    #[must_use]
    pub fn pixels(&self) -> &[P] {
        &self.pixels
    }

    /// All pixels, to be written to.
    pub(super) fn pixels_mut(&mut self) -> &mut [P] {
        &mut self.pixels
    }

    /// The picture as the algorithms take it.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if it has no pixels.
    pub fn view(&self) -> Result<Image<'_, P>, Error> {
        Image::new(&self.pixels, self.width, self.height)
    }

    /// The same, to be written to.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if it has no pixels.
    pub fn view_mut(&mut self) -> Result<ImageMut<'_, P>, Error> {
        ImageMut::new(&mut self.pixels, self.width, self.height)
    }

    /// The lines, top to bottom.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[P]> {
        self.pixels.chunks(self.width.max(1))
    }

    /// The same, to be written to.
    pub(super) fn rows_mut(&mut self) -> impl Iterator<Item = &mut [P]> {
        self.pixels.chunks_mut(self.width.max(1))
    }

    /// What a line filter makes of it, in a picture of `(width, height)`.
    pub(super) fn through<F>(&self, filter: &mut F, size: (usize, usize)) -> Result<Frame<F::Output>, Error>
    where
        F: LineFilter<Input = P>,
        F::Output: Copy + Default,
    {
        let mut made = Frame::filled(size.0, size.1, F::Output::default());
        run(filter, self.view()?, &mut made.view_mut()?)?;
        Ok(made)
    }

    /// Width and height.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }
}

/// What flows through a pipeline: a picture in colour or in gray, 8 bits a channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Picture {
    /// Red, green and blue.
    Rgb(Frame<Rgb>),
    /// Gray, or a map: edges are 255 and all else 0.
    Gray(Frame<u8>),
}

impl Picture {
    /// Of a picture file.
    #[must_use]
    pub fn from_image(image: &RgbImage) -> Self {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::Rgb(Frame { pixels: image.as_raw().as_rgb().to_vec(), width, height })
    }

    /// For a picture file; gray becomes equal red, green and blue.
    #[must_use]
    pub fn into_image(self) -> RgbImage {
        let frame = self.into_rgb();
        let mut image = RgbImage::new(frame.width as u32, frame.height as u32);
        let bytes: &mut [u8] = &mut image;
        bytes.copy_from_slice(rgb888::as_bytes(&frame.pixels));
        image
    }

    /// Width and height, in pixels.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        match self {
            Self::Rgb(frame) => frame.size(),
            Self::Gray(frame) => frame.size(),
        }
    }

    /// In gray: the luma of BT.601, exactly rounded.
    #[must_use]
    pub fn into_gray(self) -> Frame<u8> {
        match self {
            Self::Gray(frame) => frame,
            Self::Rgb(frame) => {
                let mut gray = Frame::filled(frame.width, frame.height, 0);
                // Both are of one length.
                let _ = gray8::encode_line(&frame.pixels, &mut gray.pixels);
                gray
            }
        }
    }

    /// In colour: gray is given to red, green and blue alike.
    #[must_use]
    pub fn into_rgb(self) -> Frame<Rgb> {
        match self {
            Self::Rgb(frame) => frame,
            Self::Gray(frame) => {
                let mut rgb = Frame::filled(frame.width, frame.height, Rgb::default());
                // Both are of one length.
                let _ = gray8::decode_line(&frame.pixels, &mut rgb.pixels);
                rgb
            }
        }
    }
}

impl From<Frame<Rgb>> for Picture {
    fn from(frame: Frame<Rgb>) -> Self {
        Self::Rgb(frame)
    }
}

impl From<Frame<u8>> for Picture {
    fn from(frame: Frame<u8>) -> Self {
        Self::Gray(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_come_back_and_gray_keeps_its_levels() {
        let image = RgbImage::from_fn(5, 3, |x, y| image::Rgb([x as u8 * 50, y as u8 * 99, 7]));
        assert_eq!(Picture::from_image(&image).into_image(), image);
        let gray = Frame { pixels: (0..=255).collect(), width: 16, height: 16 };
        let back = Picture::Rgb(Picture::Gray(gray.clone()).into_rgb()).into_gray();
        assert_eq!(back, gray);
        assert_eq!(Picture::Gray(gray).size(), (16, 16));
    }
}
