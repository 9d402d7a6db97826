use super::pixel::{fill_span, put};
use crate::clip::Point;
use crate::image::ImageMut;

/// Draws a circle of single pixels.
///
/// ```text
/// . . ■ ■ ■ . .      one eighth, from the top to the diagonal:
/// . ■ . . . ■ .      at each column the nearest line, decided by whether the
/// ■ . . . . . ■      midpoint between two pixels is inside; the rest by symmetry
/// ■ . . ┼ . . ■
/// ```
///
/// In the upper eighths, 0 ≤ x ≤ y from the centre, column x is lit at y = √(radius² − x²) rounded to the nearest
/// (there are no ties).
///
/// Reference: J. E. Bresenham, "A linear algorithm for incremental digital display of circular arcs", Communications
/// of the ACM 20 (2), 1977, in the midpoint form of Foley and van Dam.
///
/// Cost: two additions for eight pixels. Memory: none.
pub fn draw_circle<P: Copy>(image: &mut ImageMut<'_, P>, center: Point, radius: u16, color: P) {
    each_of_circle(radius, |x, y| put(image, i32::from(center.x) + x, i32::from(center.y) + y, color));
}

/// Fills a circle, its outline (see [`draw_circle`]) included.
///
/// Cost: one span a line. Memory: none.
pub fn fill_circle<P: Copy>(image: &mut ImageMut<'_, P>, center: Point, radius: u16, color: P) {
    let (center_x, center_y) = (i32::from(center.x), i32::from(center.y));
    let mut span = |half: i32, y: i32| {
        fill_span(image, (center_x - half, center_x + half), center_y + y, color);
        fill_span(image, (center_x - half, center_x + half), center_y - y, color);
    };
    let mut eighth = Eighth::new(radius).peekable();
    while let Some((x, y)) = eighth.next() {
        span(y, x);
        // The upper lines are as wide as the last column that reaches them.
        if eighth.peek().is_none_or(|&(_, next)| next < y) {
            span(x, y);
        }
    }
}

/// All pixels of a circle about (0, 0); those on the axes and diagonals come twice.
pub(super) fn each_of_circle(radius: u16, mut pixel: impl FnMut(i32, i32)) {
    for (x, y) in Eighth::new(radius) {
        for (x, y) in [(x, y), (y, x)] {
            pixel(x, y);
            pixel(-x, y);
            pixel(x, -y);
            pixel(-x, -y);
        }
    }
}

/// The pixels with 0 ≤ x ≤ y, from the axis on.
struct Eighth {
    x: i32,
    y: i32,
    /// x² + y² − radius² at the midpoint to the right and half below, less a quarter: whole, and below 0 if inside.
    decision: i32,
}

impl Eighth {
    fn new(radius: u16) -> Self {
        let radius = i32::from(radius);
        Self { x: 0, y: radius, decision: 1 - radius }
    }
}

impl Iterator for Eighth {
    type Item = (i32, i32);

    fn next(&mut self) -> Option<(i32, i32)> {
        if self.x > self.y {
            return None;
        }
        let pixel = (self.x, self.y);
        self.x += 1;
        if self.decision >= 0 {
            self.y -= 1;
            self.decision -= 2 * self.y;
        }
        self.decision += 2 * self.x + 1;
        Some(pixel)
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::{Picture, draw};
    use super::*;

    #[test]
    fn outlines() {
        let expected: Picture<9, 7> = [
            *b"..###...#", //
            *b".#...#..#",
            *b"#.....##.",
            *b"#..#..##.",
            *b"#.....##.",
            *b".#...#..#",
            *b"..###...#",
        ];
        let drawn = draw(|image| {
            draw_circle(image, Point::new(3, 3), 3, b'#');
            draw_circle(image, Point::new(3, 3), 0, b'#');
            draw_circle(image, Point::new(11, 3), 4, b'#');
        });
        assert_eq!(drawn, expected);
    }

    #[test]
    fn a_filled_circle_is_its_outline_and_what_is_within() {
        for radius in 0..40 {
            let center = Point::new(20, 22);
            let outline: Picture<44, 44> = draw(|image| draw_circle(image, center, radius, b'#'));
            let filled: Picture<44, 44> = draw(|image| fill_circle(image, center, radius, b'#'));
            for (outline, filled) in outline.iter().zip(&filled) {
                let lit = |row: &[u8; 44]| {
                    let first = row.iter().position(|&pixel| pixel == b'#');
                    first.zip(row.iter().rposition(|&pixel| pixel == b'#'))
                };
                if radius < 20 {
                    assert_eq!(lit(outline), lit(filled));
                }
                if let Some((first, last)) = lit(filled) {
                    assert!(filled[first..=last].iter().all(|&pixel| pixel == b'#'));
                }
            }
        }
    }
}
