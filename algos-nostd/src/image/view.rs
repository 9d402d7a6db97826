use super::Error;

/// A picture borrowed from its owner: `height` lines of `width` pixels, `stride` pixels from line to line.
///
/// Checked once when made; the accessors are then infallible.
#[derive(Debug)]
pub struct Image<'a, P> {
    pixels: &'a [P],
    width: usize,
    height: usize,
    stride: usize,
}

// By hand, because a view can be copied whatever its pixels are.
impl<P> Copy for Image<'_, P> {}

impl<P> Clone for Image<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

/// The same, to be written to.
#[derive(Debug)]
pub struct ImageMut<'a, P> {
    pixels: &'a mut [P],
    width: usize,
    height: usize,
    stride: usize,
}

/// Elements that a picture takes, or why it can't be.
fn checked_length(width: usize, height: usize, stride: usize, got: usize) -> Result<usize, Error> {
    if width == 0 || height == 0 {
        return Err(Error::ZeroSize { width, height });
    }
    if stride < width {
        return Err(Error::Stride { stride, width });
    }
    // The last line need not be padded out to the stride.
    let expected =
        stride.checked_mul(height - 1).and_then(|before| before.checked_add(width)).unwrap_or(usize::MAX);
    if got < expected { Err(Error::BufferLength { name: "pixels", expected, got }) } else { Ok(expected) }
}

impl<'a, P> Image<'a, P> {
    /// A picture whose lines follow one another without a gap.
    ///
    /// # Errors
    /// If a side is zero or `pixels` is shorter than `width × height`; longer is allowed.
    pub fn new(pixels: &'a [P], width: usize, height: usize) -> Result<Self, Error> {
        Self::with_stride(pixels, width, height, width)
    }

    /// A picture whose lines start `stride` pixels apart.
    ///
    /// # Errors
    /// As [`Image::new`], and if the stride is shorter than a line.
    pub fn with_stride(pixels: &'a [P], width: usize, height: usize, stride: usize) -> Result<Self, Error> {
        let length = checked_length(width, height, stride, pixels.len())?;
        Ok(Self { pixels: &pixels[..length], width, height, stride })
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

    /// Pixels from the start of a line to the start of the next.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The lines, top to bottom, each of `width` pixels.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &'a [P]> + DoubleEndedIterator + use<'a, P> {
        let width = self.width;
        self.pixels.chunks(self.stride).map(move |row| &row[..width])
    }

    /// Line `y`, if there is one.
    #[must_use]
    pub fn row(&self, y: usize) -> Option<&'a [P]> {
        let start = y.checked_mul(self.stride)?;
        self.pixels.get(start..start.checked_add(self.width)?)
    }

    /// The pixel in column `x` of line `y`, if there is one.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> Option<&'a P> {
        self.row(y)?.get(x)
    }

    /// The pixels as one slice, where lines follow one another without a gap.
    #[must_use]
    pub fn as_contiguous(&self) -> Option<&'a [P]> {
        (self.stride == self.width || self.height == 1).then_some(self.pixels)
    }

    /// The part of `width × height` pixels whose top left corner is at `(x, y)`, if it lies within the picture.
    #[must_use]
    pub fn crop(&self, x: usize, y: usize, width: usize, height: usize) -> Option<Image<'a, P>> {
        if x.checked_add(width)? > self.width || y.checked_add(height)? > self.height {
            return None;
        }
        let pixels = self.pixels.get(y * self.stride + x..)?;
        Self::with_stride(pixels, width, height, self.stride).ok()
    }
}

impl<'a, P> ImageMut<'a, P> {
    /// A picture whose lines follow one another without a gap.
    ///
    /// # Errors
    /// If a side is zero or `pixels` is shorter than `width × height`; longer is allowed.
    pub fn new(pixels: &'a mut [P], width: usize, height: usize) -> Result<Self, Error> {
        Self::with_stride(pixels, width, height, width)
    }

    /// A picture whose lines start `stride` pixels apart.
    ///
    /// # Errors
    /// As [`ImageMut::new`], and if the stride is shorter than a line.
    pub fn with_stride(
        pixels: &'a mut [P],
        width: usize,
        height: usize,
        stride: usize,
    ) -> Result<Self, Error> {
        let length = checked_length(width, height, stride, pixels.len())?;
        Ok(Self { pixels: &mut pixels[..length], width, height, stride })
    }

    /// The picture, to be read.
    #[must_use]
    pub fn as_image(&self) -> Image<'_, P> {
        Image { pixels: self.pixels, width: self.width, height: self.height, stride: self.stride }
    }

    /// The same picture, lent on.
    #[must_use]
    pub fn reborrow(&mut self) -> ImageMut<'_, P> {
        ImageMut { pixels: self.pixels, width: self.width, height: self.height, stride: self.stride }
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

    /// Pixels from the start of a line to the start of the next.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The lines, top to bottom, to be written to.
    pub fn rows_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [P]> + DoubleEndedIterator {
        let width = self.width;
        self.pixels.chunks_mut(self.stride).map(move |row| &mut row[..width])
    }

    /// All pixels as one slice, the padding between lines included: the pixel (x, y) is at `y × stride + x`.
    #[must_use]
    pub fn as_mut_pixels(&mut self) -> &mut [P] {
        self.pixels
    }

    /// Line `y`, if there is one.
    #[must_use]
    pub fn row_mut(&mut self, y: usize) -> Option<&mut [P]> {
        let start = y.checked_mul(self.stride)?;
        self.pixels.get_mut(start..start.checked_add(self.width)?)
    }

    /// The pixel in column `x` of line `y`, if there is one.
    #[must_use]
    pub fn pixel_mut(&mut self, x: usize, y: usize) -> Option<&mut P> {
        self.row_mut(y)?.get_mut(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_skip_the_padding() {
        let pixels = [1, 2, 0, 3, 4];
        let image = Image::with_stride(&pixels, 2, 2, 3).unwrap();
        assert!(image.rows().eq([&[1, 2][..], &[3, 4]]));
        assert_eq!(image.row(1), Some(&[3, 4][..]));
        assert_eq!(image.row(2), None);
        assert_eq!(image.pixel(2, 0), None, "padding is not a pixel");
    }

    #[test]
    fn crop_is_a_view() {
        let pixels: [u8; 12] = core::array::from_fn(|i| i as u8);
        let image = Image::new(&pixels, 4, 3).unwrap();
        let crop = image.crop(1, 1, 2, 2).unwrap();
        assert!(crop.rows().eq([&[5, 6][..], &[9, 10]]));
        assert!(image.crop(3, 0, 2, 1).is_none());
        assert!(image.crop(usize::MAX, 0, 2, 1).is_none());
    }

    #[test]
    fn bad_sizes_say_what_was_expected() {
        let mut pixels = [0u8; 5];
        assert_eq!(Image::new(&pixels, 0, 3).unwrap_err(), Error::ZeroSize { width: 0, height: 3 });
        assert_eq!(Image::with_stride(&pixels, 3, 1, 2).unwrap_err(), Error::Stride { stride: 2, width: 3 });
        assert_eq!(
            ImageMut::new(&mut pixels, 3, 2).unwrap_err(),
            Error::BufferLength { name: "pixels", expected: 6, got: 5 }
        );
        assert!(Image::new(&pixels, usize::MAX, usize::MAX).is_err());
    }
}
