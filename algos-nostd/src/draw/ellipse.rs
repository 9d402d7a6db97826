use super::pixel::{fill_span, put};
use crate::clip::Point;
use crate::image::ImageMut;

/// Draws an ellipse of single pixels with its axes along columns and lines.
///
/// ```text
/// . . . ■ ■ ■ . . .     while flatter than the diagonal: a step to the right each,
/// . ■ ■ . . . ■ ■ .     the nearest line; then a step down each, the nearest column
/// ■ . . . ┼ . . . ■
/// ```
///
/// `radii` are the half widths along x and y, in pixels; with a radius of 0 it is a straight line.
///
/// Reference: J. R. Van Aken, "An efficient ellipse-drawing algorithm", IEEE Computer Graphics and Applications 4 (9),
/// 1984. We deviate at the tips: an ellipse so flat that its outline ends before the axis is closed along the axis;
/// and in changing over half a step later, which leaves fewer pixels beside the nearest: where the two parts join, one
/// pixel of a quarter may be a neighbour of the nearest one, all others are nearest in their column or line.
///
/// Cost: three additions of 64 bits for four pixels. Memory: none.
pub fn draw_ellipse<P: Copy>(image: &mut ImageMut<'_, P>, center: Point, radii: (u16, u16), color: P) {
    each_of_ellipse(radii, |x, y| put(image, i32::from(center.x) + x, i32::from(center.y) + y, color));
}

/// Fills an ellipse, its outline (see [`draw_ellipse`]) included.
///
/// Cost: one span a line. Memory: none.
pub fn fill_ellipse<P: Copy>(image: &mut ImageMut<'_, P>, center: Point, radii: (u16, u16), color: P) {
    let (center_x, center_y) = (i32::from(center.x), i32::from(center.y));
    let mut span = |(half, y): (i32, i32)| {
        fill_span(image, (center_x - half, center_x + half), center_y + y, color);
        fill_span(image, (center_x - half, center_x + half), center_y - y, color);
    };
    let mut latest = (0, i32::from(radii.1));
    each_of_quarter(radii, |x, y| {
        // x only grows, so a line is as wide as its last pixel says.
        if y != latest.1 {
            span(latest);
        }
        latest = (x, y);
    });
    span(latest);
}

/// All pixels of an ellipse about (0, 0); those on the axes come more than once.
pub(super) fn each_of_ellipse(radii: (u16, u16), mut pixel: impl FnMut(i32, i32)) {
    each_of_quarter(radii, |x, y| {
        pixel(x, y);
        pixel(-x, y);
        pixel(x, -y);
        pixel(-x, -y);
    });
}

/// The pixels with x, y ≥ 0, from the y axis to the x axis.
fn each_of_quarter((radius_x, radius_y): (u16, u16), mut pixel: impl FnMut(i32, i32)) {
    // F(x, y) = b²x² + a²y² − a²b² is below 0 inside. Radii are below 2¹⁶, so all below is less than 2⁵² in size.
    let (a, b) = (i64::from(radius_x), i64::from(radius_y));
    let (a2, b2) = (a * a, b * b);
    let (mut x, mut y) = (0, b);
    // 4·F at the midpoint one to the right and half below.
    let mut decision = 4 * b2 - 4 * a2 * b + a2;
    while b2 * (x + 1) < a2 * y {
        pixel(x as i32, y as i32);
        let outside = decision >= 0;
        decision += 4 * b2 * (2 * x + 3);
        if outside {
            decision -= 8 * a2 * (y - 1);
            y -= 1;
        }
        x += 1;
    }
    // From there to 4·F at the midpoint half to the right and one below.
    decision += a2 * (3 - 4 * y) - b2 * (4 * x + 3);
    while y > 0 {
        pixel(x as i32, y as i32);
        if decision < 0 {
            decision += 8 * b2 * (x + 1);
            x += 1;
        }
        decision += 4 * a2 * (3 - 2 * y);
        y -= 1;
    }
    for x in x..=a {
        pixel(x as i32, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::{Picture, draw};
    use super::*;

    #[test]
    fn outlines() {
        let expected: Picture<13, 7> = [
            *b"...#######...", //
            *b".##.......##.",
            *b"#...........#",
            *b"#....###....#",
            *b"#...........#",
            *b".##.......##.",
            *b"...#######...",
        ];
        let drawn = draw(|image| {
            draw_ellipse(image, Point::new(6, 3), (6, 3), b'#');
            draw_ellipse(image, Point::new(6, 3), (1, 0), b'#');
        });
        assert_eq!(drawn, expected);
    }

    #[test]
    fn filled_and_clipped() {
        let expected: Picture<5, 4> = [*b"###..", *b"####.", *b"###..", *b"....."];
        assert_eq!(draw(|image| fill_ellipse(image, Point::new(0, 1), (3, 1), b'#')), expected);
    }
}
