//! Letters of any size: the fonts of `embedded-graphics`, each dot a square of pixels.

use std::convert::Infallible;

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::ascii::FONT_6X10;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Baseline, Text};
use image::{Rgb, RgbImage};

/// Dots of a letter, with the gap to the next.
pub(super) const LETTER: (u32, u32) = (6, 10);

struct Dots<'a> {
    picture: &'a mut RgbImage,
    at: (u32, u32),
    dot: u32,
    colour: Rgb<u8>,
}

impl OriginDimensions for Dots<'_> {
    fn size(&self) -> Size {
        Size::new(self.picture.width(), self.picture.height())
    }
}

impl DrawTarget for Dots<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(Point { x, y }, _) in pixels {
            let (Ok(column), Ok(row)) = (u32::try_from(x), u32::try_from(y)) else { continue };
            for dot in 0..self.dot * self.dot {
                let place = (
                    self.at.0 + column * self.dot + dot % self.dot,
                    self.at.1 + row * self.dot + dot / self.dot,
                );
                if let Some(pixel) = self.picture.get_pixel_mut_checked(place.0, place.1) {
                    *pixel = self.colour;
                }
            }
        }
        Ok(())
    }
}

/// Writes a line of text; `dot` is the side of a dot in pixels. What does not fit is cut off.
pub(crate) fn write(picture: &mut RgbImage, at: (u32, u32), dot: u32, colour: Rgb<u8>, text: &str) {
    let style = MonoTextStyle::new(&FONT_6X10, BinaryColor::On);
    let mut dots = Dots { picture, at, dot, colour };
    let Ok(_) = Text::with_baseline(text, Point::zero(), style, Baseline::Top).draw(&mut dots);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_letter_has_its_dots() {
        let mut picture = RgbImage::new(6, 8);
        write(&mut picture, (0, 0), 1, Rgb([255; 3]), "C");
        let rows: Vec<String> = picture
            .rows()
            .map(|row| row.map(|pixel| if pixel.0[0] > 0 { '#' } else { '.' }).collect())
            .collect();
        assert_eq!(rows, ["......", ".###..", "#...#.", "#.....", "#.....", "#.....", "#...#.", ".###.."]);
    }
}
