use super::font::{GLYPH, glyph};
use super::pixel::{fill_span, put};
use crate::clip::{Point, Window};
use crate::image::ImageMut;

/// Pixels from a character to the next one, and from a line of text to the next.
const ADVANCE: (i32, i32) = (GLYPH.0 as i32 + 1, GLYPH.1 as i32 + 2);

/// Columns and lines that a text takes, in pixels, at a scale of 1; without the gap behind the last character.
#[must_use]
pub fn text_size(text: &str) -> (usize, usize) {
    let widest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    let lines = text.lines().count();
    let pixels =
        |count: usize, advance: i32, gap: i32| (count * advance as usize).saturating_sub(gap as usize);
    (
        pixels(widest, ADVANCE.0, ADVANCE.0 - GLYPH.0 as i32),
        pixels(lines, ADVANCE.1, ADVANCE.1 - GLYPH.1 as i32),
    )
}

/// Writes text with its upper left corner at a pixel, each pixel of the font `scale` × `scale` large.
///
/// ```text
/// # . . . # . . . . . .       5 × 7 pixels a character, 1 between characters,
/// # . . . # . . # . . .       2 between lines; a newline starts the next
/// # # # # # . . . . . .
/// ```
///
/// The font has the printable characters of ASCII; a box stands for others. The background is left as it is; for a
/// plate behind the text fill a rectangle of [`text_size`] first.
///
/// Cost: 35 look-ups a character that meets the picture. Memory: 672 bytes of constants.
pub fn draw_text<P: Copy>(image: &mut ImageMut<'_, P>, at: Point, text: &str, scale: u8, color: P) {
    let scale = i32::from(scale);
    let (width, height) = (image.width(), image.height());
    let visible = |first: i32, length: usize, limit: usize| {
        first + length as i32 * scale > 0 && usize::try_from(first).map_or(true, |first| first < limit)
    };
    // Positions grow by at most 9 × 255 a character; a text that leaves `i32` has left the picture before.
    let mut y = i32::from(at.y);
    for line in text.lines() {
        if visible(y, GLYPH.1, height) {
            let mut x = i32::from(at.x);
            for character in line.chars() {
                if visible(x, GLYPH.0, width) {
                    draw_glyph(image, (x, y), character, scale, color);
                }
                x = x.saturating_add(ADVANCE.0 * scale);
            }
        }
        y = y.saturating_add(ADVANCE.1 * scale);
    }
}

fn draw_glyph<P: Copy>(
    image: &mut ImageMut<'_, P>,
    (x, y): (i32, i32),
    character: char,
    scale: i32,
    color: P,
) {
    for (line, bits) in (0..).zip(glyph(character)) {
        for column in (0..GLYPH.0 as i32).filter(|column| bits >> (GLYPH.0 as i32 - 1 - column) & 1 != 0) {
            for row in 0..scale {
                let first = x + column * scale;
                fill_span(image, (first, first + scale - 1), y + line * scale + row, color);
            }
        }
    }
}

/// Draws the outline of a rectangle, one pixel thick, both corners included.
pub fn draw_box<P: Copy>(image: &mut ImageMut<'_, P>, window: &Window, color: P) {
    let (left, top, right, bottom) = sides(window);
    fill_span(image, (left, right), top, color);
    fill_span(image, (left, right), bottom, color);
    let lines = i32::try_from(image.height()).unwrap_or(i32::MAX);
    for y in top.max(0)..=bottom.min(lines - 1) {
        put(image, left, y, color);
        put(image, right, y, color);
    }
}

/// Fills a rectangle.
pub fn fill_box<P: Copy>(image: &mut ImageMut<'_, P>, window: &Window, color: P) {
    let (left, top, right, bottom) = sides(window);
    let lines = i32::try_from(image.height()).unwrap_or(i32::MAX);
    for y in top.max(0)..=bottom.min(lines - 1) {
        fill_span(image, (left, right), y, color);
    }
}

fn sides(window: &Window) -> (i32, i32, i32, i32) {
    let (a, b) = (window.top_left(), window.bottom_right());
    (i32::from(a.x), i32::from(a.y), i32::from(b.x), i32::from(b.y))
}

#[cfg(test)]
mod tests {
    use super::super::picture::{Picture, draw};
    use super::*;

    #[test]
    fn letters() {
        let expected: Picture<12, 7> = [
            *b"..#.....#...", //
            *b".#.#........",
            *b"#...#..##...",
            *b"#...#...#...",
            *b"#####...#...",
            *b"#...#...#...",
            *b"#...#..###..",
        ];
        assert_eq!(draw(|image| draw_text(image, Point::new(0, 0), "Ai", 1, b'#')), expected);
    }

    #[test]
    fn clipped_scaled_and_in_lines() {
        let expected: Picture<8, 6> = [
            *b"........", // the stem is left of the picture
            *b"........",
            *b"........",
            *b"######..",
            *b"######..",
            *b"........",
        ];
        let drawn = draw(|image| draw_text(image, Point::new(-4, -9), "L\nL", 2, b'#'));
        assert_eq!(drawn, expected);
        assert_eq!((text_size("abc\nd"), text_size("")), ((17, 16), (0, 0)));
    }

    #[test]
    fn every_character_has_a_glyph_of_its_own() {
        for a in ' '..='~' {
            assert!((' '..a).all(|b| glyph(a) != glyph(b)), "{a}");
        }
        assert_eq!(glyph('é'), glyph('\n'));
    }

    #[test]
    fn boxes() {
        let window = Window::new(Point::new(1, -3), Point::new(9, 2)).unwrap();
        let outline: Picture<5, 4> = draw(|image| draw_box(image, &window, b'#'));
        assert_eq!(outline, [*b".#...", *b".#...", *b".####", *b"....."]);
        let filled: Picture<5, 4> = draw(|image| fill_box(image, &window, b'#'));
        assert_eq!(filled, [*b".####", *b".####", *b".####", *b"....."]);
    }
}
