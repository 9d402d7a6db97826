use super::mix::{Mix, cover};
use super::steps::Steps;
use crate::clip::Point;
use crate::image::ImageMut;

/// Draws a smooth line one pixel thick, as a cone-shaped eye of radius 1 sees it: equally strong in every direction.
///
/// ```text
///   ░ . . . .      four pixels a step, each as bright as its
///   ■ ▓ ▒ ░ .      distance from the ideal line says,
///   ░ ▒ ▓ ■ ▓      measured at a right angle to it
///   . . . ░ ▒
/// ```
///
/// The strength is the volume of the cone (height 3/π, so that it is 1 in all) over the strip that is the line: 200
/// of 255 at the middle, nothing from 1.5 pixels on.
///
/// Reference: S. Gupta and R. F. Sproull, "Filtering edges for gray-scale displays", SIGGRAPH 1981. We deviate in a
/// table of distances in 1/32 instead of 1/16 pixels, in four pixels a step instead of three, because the outer ones
/// of oblique lines are seen, and in ends that are cut off square to the axis, not rounded.
///
/// Cost: four mixed pixels and one square root a line. Memory: a table of 49 bytes.
pub fn draw_line_gupta_sproull<P: Mix>(image: &mut ImageMut<'_, P>, from: Point, to: Point, color: P) {
    let steps = Steps::new(from, to, image);
    let (major, minor) = (i64::from(steps.major), i64::from(steps.minor));
    // The line's length in 1/256 pixels: 25 bits.
    let length = (((major * major + minor * minor) as u64) << 16).isqrt().max(1);
    // From pixels across times `major` to distances in 1/32 pixels, with 24 bits of fraction.
    let to_distance = ((32 * 256) << 24) / length;
    for step in steps.first..steps.end {
        let passed = i64::from(step) * minor;
        let nearer = passed / major;
        for across in nearer - 1..=nearer + 2 {
            let offset = (passed - across * major).unsigned_abs();
            let distance = (offset * to_distance + (1 << 23)) >> 24;
            if let Some(&strength) = STRENGTH.get(distance as usize)
                && strength > 0
            {
                let (x, y) = steps.pixel(step as i32, across as i32);
                cover(image, x, y, color, strength);
            }
        }
    }
}

/// The cone's volume over a strip of width 1 whose middle is so many 1/32 pixels away, of 255.
const STRENGTH: [u8; 49] = [
    199, 199, 198, 196, 194, 191, 188, 184, 179, 174, 169, 163, 156, 150, 142, 135, 128, 120, 112, 105, 98,
    90, 84, 77, 70, 64, 58, 52, 47, 42, 37, 32, 28, 24, 21, 17, 14, 12, 9, 7, 5, 4, 3, 2, 1, 0, 0, 0, 0,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_line_has_the_table_at_whole_pixels() {
        let mut pixels = [0u8; 3 * 5];
        let mut image = ImageMut::new(&mut pixels, 3, 5).unwrap();
        draw_line_gupta_sproull(&mut image, Point::new(-9, 2), Point::new(1, 2), 255);
        let (middle, beside) = (STRENGTH[0], STRENGTH[32]);
        let expected = [0, beside, middle, beside, 0];
        for (row, expected) in pixels.chunks(3).zip(expected) {
            assert_eq!(row, [expected, expected, 0]);
        }
    }

    #[test]
    fn strengths_across_a_line_are_the_whole_colour_in_any_direction() {
        for (x, y) in [(60, 0), (60, 7), (60, 30), (60, 45), (60, 60), (20, 60)] {
            let mut pixels = [0u8; 80 * 80];
            let mut image = ImageMut::new(&mut pixels, 80, 80).unwrap();
            draw_line_gupta_sproull(&mut image, Point::new(5, 5), Point::new(5 + x, 5 + y), 255);
            let sum: u32 = pixels.iter().map(|&pixel| u32::from(pixel)).sum();
            let squared = u64::from((x * x + y * y) as u32);
            let length = (squared << 16).isqrt() as u32;
            // Square ends add up to one step; the strengths were rounded.
            let expected = 255 * length / 256;
            assert!(sum.abs_diff(expected) < expected / 25 + 400, "{sum} is not about {expected}");
        }
    }
}
