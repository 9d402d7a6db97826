use super::pixel::{fill_span, put};
use super::steps::Steps;
use crate::clip::Point;
use crate::image::ImageMut;

/// Draws a line of any thickness with square ends, each pixel once. `width` is in pixels, measured at a right angle to
/// the line; 0 draws nothing.
///
/// ```text
/// . . 0 1 . . . . . . .   Lines of pixels at a right angle to the line (0, 1,
/// . . 0 1 2 3 . . . . .   2 …), all of one shape, each a pixel further along:
/// . 0 1 2 3 4 5 6 . . .   they cover the plane without gap or overlap. What is
/// . . . 2 3 4 5 6 7 8 .   within half the width of the ideal line is lit.
/// . . . . . 5 6 7 8 9 0
/// . . . . . . . 7 8 9 0
/// . . . . . . . . . 0 .
/// ```
///
/// Lit are the pixels whose centre is at most half the width away from the ideal line (on the one side; less than that
/// on the other, so that level lines are exactly `width` thick), from the right-angled line through the start to that
/// through the end.
///
/// Reference: A. S. Murphy, "Line thickening by modification to Bresenham's algorithm", IBM Technical Disclosure Bulletin
/// 20 (12), 1978. We deviate in order: his lines at a right angle are the level sets of step + round(across·minor/major),
/// so that the same pixels can be drawn as runs along the line's longer side, one for each pixel across, which are
/// clipped and filled in bulk.
///
/// Cost: three divisions of 64 bits a run. Memory: none.
pub fn draw_line_thick<P: Copy>(image: &mut ImageMut<'_, P>, from: Point, to: Point, width: u8, color: P) {
    let steps = Steps::new(from, to, image);
    let (major, minor) = (i64::from(steps.major), i64::from(steps.minor));
    // Distances below are times 2·length, which makes them whole; half the width is then this root.
    let squared = u64::from(width) * u64::from(width) * (major * major + minor * minor) as u64;
    let above = squared.isqrt() as i64;
    // The largest whole number below the root: nothing at all for a width of 0.
    let below = squared.saturating_sub(1).isqrt() as i64;
    if width == 0 {
        return;
    }
    let shape = |across: i64| (2 * across * minor + major).div_euclid(2 * major);
    // A single pixel has no length, but `major` is 1 to have a direction.
    let last = if from == to { 0 } else { major + shape(minor) };
    // −below ≤ 2·(across·major − step·minor) ≤ above, for steps from 0 to `last`.
    let reach = (above + 2 * minor * minor) / (2 * major) + 1;
    let (limit_across, limit_along) = limits(&steps, image);
    for across in (-reach).max(limit_across.0)..=(minor + reach).min(limit_across.1) {
        let offset = 2 * across * major;
        let (band_first, band_last) = if minor > 0 {
            let rounded_up = -(above - offset).div_euclid(2 * minor);
            (rounded_up, (offset + below).div_euclid(2 * minor))
        } else if -below <= offset && offset <= above {
            (i64::MIN, i64::MAX)
        } else {
            continue;
        };
        let first = band_first.max(-shape(across)).max(limit_along.0);
        let last = band_last.min(last - shape(across)).min(limit_along.1);
        if first > last {
            continue;
        }
        // Within the picture, so back in 32 bits.
        let (a, b) = (steps.pixel(first as i32, across as i32), steps.pixel(last as i32, across as i32));
        if steps.is_level() {
            fill_span(image, (a.0.min(b.0), a.0.max(b.0)), a.1, color);
        } else {
            for y in a.1.min(b.1)..=a.1.max(b.1) {
                put(image, a.0, y, color);
            }
        }
    }
}

/// Pixels across, and steps along (before the start or behind the end as well), that are in the picture.
fn limits<P>(steps: &Steps, image: &ImageMut<'_, P>) -> ((i64, i64), (i64, i64)) {
    let last = |length: usize| i64::try_from(length - 1).unwrap_or(i64::MAX);
    let (origin, along, across) = (steps.pixel(0, 0), steps.pixel(1, 0), steps.pixel(0, 1));
    let range = |at: i32, towards: i32, limit: i64| {
        let at = i64::from(at);
        if i64::from(towards) > at { (-at, limit - at) } else { (at - limit, at) }
    };
    let columns = last(image.width()).min(i64::from(i32::MAX) / 2);
    let lines = last(image.height()).min(i64::from(i32::MAX) / 2);
    if steps.is_level() {
        (range(origin.1, across.1, lines), range(origin.0, along.0, columns))
    } else {
        (range(origin.0, across.0, columns), range(origin.1, along.1, lines))
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::{Picture, draw};
    use super::*;

    #[test]
    fn level_lines_are_as_thick_as_asked() {
        for width in 0..6 {
            let drawn: Picture<7, 9> =
                draw(|image| draw_line_thick(image, Point::new(-3, 4), Point::new(5, 4), width, b'#'));
            let lit = drawn.iter().filter(|row| **row == *b"######.").count();
            assert_eq!(lit, usize::from(width));
            let drawn: Picture<9, 7> =
                draw(|image| draw_line_thick(image, Point::new(4, 5), Point::new(4, -3), width, b'#'));
            let lit = drawn[0].iter().filter(|&&pixel| pixel == b'#').count();
            assert_eq!((lit, drawn[6]), (usize::from(width), *b"........."));
        }
    }

    #[test]
    fn oblique_lines_have_square_ends() {
        let drawn: Picture<12, 9> =
            draw(|image| draw_line_thick(image, Point::new(2, 2), Point::new(9, 6), 4, b'#'));
        let expected = [
            *b"............", //
            *b"...##.......",
            *b"..#####.....",
            *b".#######....",
            *b"..########..",
            *b"....######..",
            *b".....#####..",
            *b".......##...",
            *b"............",
        ];
        assert_eq!(drawn, expected);
    }
}
