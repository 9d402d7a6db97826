//! Views as `embedded-graphics` draw targets and pictures, behind the feature `embedded-graphics`.
//!
//! | pixel | colour |
//! |---|---|
//! | [`Rgb`] | `Rgb888` |
//! | `u8` | `Gray8` |
//! | `u16` | `Rgb565` |
//!
//! Drawing outside the picture is cut off, as `embedded-graphics` has it, and cannot fail. Solid rectangles are filled line by
//! line rather than pixel by pixel.

use super::{Image, ImageMut, Rgb};
use core::convert::Infallible;
use embedded_graphics_core::Pixel;
use embedded_graphics_core::draw_target::DrawTarget;
use embedded_graphics_core::geometry::{OriginDimensions, Point, Size};
use embedded_graphics_core::image::ImageDrawable;
use embedded_graphics_core::pixelcolor::raw::{RawData, RawU16};
use embedded_graphics_core::pixelcolor::{Gray8, GrayColor, PixelColor, Rgb565, Rgb888, RgbColor};
use embedded_graphics_core::primitives::Rectangle;

/// A pixel that `embedded-graphics` has a colour for.
pub trait ColoredPixel: Copy {
    /// That colour.
    type Color: PixelColor;

    /// The pixel of a colour.
    fn from_color(color: Self::Color) -> Self;

    /// The colour of the pixel.
    fn to_color(self) -> Self::Color;
}

impl ColoredPixel for Rgb {
    type Color = Rgb888;

    fn from_color(color: Rgb888) -> Self {
        Self::new(color.r(), color.g(), color.b())
    }

    fn to_color(self) -> Rgb888 {
        Rgb888::new(self.r, self.g, self.b)
    }
}

impl ColoredPixel for u8 {
    type Color = Gray8;

    fn from_color(color: Gray8) -> Self {
        color.luma()
    }

    fn to_color(self) -> Gray8 {
        Gray8::new(self)
    }
}

impl ColoredPixel for u16 {
    type Color = Rgb565;

    fn from_color(color: Rgb565) -> Self {
        RawU16::from(color).into_inner()
    }

    fn to_color(self) -> Rgb565 {
        RawU16::new(self).into()
    }
}

fn size(width: usize, height: usize) -> Size {
    let side = |pixels: usize| u32::try_from(pixels).unwrap_or(u32::MAX);
    Size::new(side(width), side(height))
}

impl<P> OriginDimensions for ImageMut<'_, P> {
    fn size(&self) -> Size {
        size(self.width(), self.height())
    }
}

impl<P: ColoredPixel> DrawTarget for ImageMut<'_, P> {
    type Color = P::Color;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<P::Color>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(Point { x, y }, color) in pixels {
            if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y))
                && let Some(pixel) = self.pixel_mut(x, y)
            {
                *pixel = P::from_color(color);
            }
        }
        Ok(())
    }

    fn fill_solid(&mut self, area: &Rectangle, color: P::Color) -> Result<(), Infallible> {
        let inside = area.intersection(&Rectangle::new(Point::zero(), self.size()));
        // Within the picture, so neither is negative.
        let (left, top) = (inside.top_left.x as usize, inside.top_left.y as usize);
        for y in top..top + inside.size.height as usize {
            if let Some(run) =
                self.row_mut(y).and_then(|row| row.get_mut(left..left + inside.size.width as usize))
            {
                run.fill(P::from_color(color));
            }
        }
        Ok(())
    }
}

impl<P> OriginDimensions for Image<'_, P> {
    fn size(&self) -> Size {
        size(self.width(), self.height())
    }
}

impl<P: ColoredPixel> ImageDrawable for Image<'_, P> {
    type Color = P::Color;

    fn draw<D: DrawTarget<Color = P::Color>>(&self, target: &mut D) -> Result<(), D::Error> {
        let area = Rectangle::new(Point::zero(), self.size());
        target.fill_contiguous(&area, self.rows().flatten().map(|&pixel| pixel.to_color()))
    }

    fn draw_sub_image<D: DrawTarget<Color = P::Color>>(
        &self,
        target: &mut D,
        area: &Rectangle,
    ) -> Result<(), D::Error> {
        let inside = area.intersection(&Rectangle::new(Point::zero(), self.size()));
        let (left, top) = (inside.top_left.x as usize, inside.top_left.y as usize);
        let Some(part) = self.crop(left, top, inside.size.width as usize, inside.size.height as usize) else {
            return Ok(());
        };
        // Where the area begins before the picture, its corner is not the origin.
        let place = Rectangle::new(inside.top_left - area.top_left, inside.size);
        target.fill_contiguous(&place, part.rows().flatten().map(|&pixel| pixel.to_color()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_drawn_to_and_cut_off() {
        let mut pixels = *b"....|....|....|";
        let mut image = ImageMut::with_stride(&mut pixels, 4, 3, 5).unwrap();
        let at = |x, y| Pixel(Point::new(x, y), Gray8::new(b'x'));
        image.draw_iter([at(0, 0), at(3, 2), at(4, 0), at(-1, 1), at(0, 3)]).unwrap();
        image.fill_solid(&Rectangle::new(Point::new(2, -1), Size::new(9, 3)), Gray8::new(b'#')).unwrap();
        image.fill_solid(&Rectangle::new(Point::new(9, 9), Size::new(2, 2)), Gray8::new(b'!')).unwrap();
        assert_eq!(&pixels, b"x.##|..##|...x|");
    }

    #[test]
    fn a_view_is_a_picture() {
        let source = *b"abc-def-";
        let image = Image::with_stride(&source, 3, 2, 4).unwrap();
        let mut pixels = *b"............";
        let mut target = ImageMut::new(&mut pixels, 4, 3).unwrap();
        image.draw(&mut target).unwrap();
        assert_eq!(&pixels, b"abc.def.....");
        let mut pixels = *b"............";
        let mut target = ImageMut::new(&mut pixels, 4, 3).unwrap();
        image.draw_sub_image(&mut target, &Rectangle::new(Point::new(1, -1), Size::new(9, 9))).unwrap();
        image.draw_sub_image(&mut target, &Rectangle::new(Point::new(5, 5), Size::new(9, 9))).unwrap();
        assert_eq!(&pixels, b"....bc..ef..");
    }

    #[test]
    fn colours_survive() {
        for pixel in [Rgb::new(1, 2, 3), Rgb::new(255, 0, 254)] {
            assert_eq!(Rgb::from_color(pixel.to_color()), pixel);
        }
        assert!((0..=u16::MAX).all(|word| u16::from_color(word.to_color()) == word));
        assert!((0..=u8::MAX).all(|gray| u8::from_color(gray.to_color()) == gray));
    }
}
