use crate::clip::{Direction, Point, Walk, Window, clip_line};
use crate::image::ImageMut;

/// Draws a line of single pixels, both ends included: the pixels of [`Walk`] that are in the picture.
///
/// ```text
/// ■ ■ . . . . .      phase 0.50 + slope 0.33 a step;
/// . . ■ ■ ■ . .      when the phase runs over, one pixel across
/// . . . . . ■ ■
/// ```
///
/// The line is clipped once; the pixels are then a run of indices with two strides. Bresenham's error term is kept
/// as a 32-bit fraction of a pixel, whose carry is the step across: the chain from pixel to pixel is a single addition.
/// The fraction is rounded up; over 32,000 steps it gains less than the smallest difference that the exact term of a
/// line of 65,535 steps can have, so the pixels are exactly Bresenham's. Longer runs are drawn with the error term.
/// Horizontal lines are filled in bulk.
///
/// Reference: see [`Walk`] and [`clip_line`].
///
/// Cost: the clip, one division of 64 bits, then an addition, a selection and a store a pixel. Memory: none.
pub fn draw_line<P: Copy>(image: &mut ImageMut<'_, P>, from: Point, to: Point, color: P) {
    if let Some(walk) = clip_line(from, to, &Window::of_mut(image)) {
        draw_walk(image, &walk, color);
    }
}

/// Draws the pixels of a walk, which must have been clipped to the picture.
///
/// A pixel of it that is not in the picture does no harm: it lands elsewhere in the picture or nowhere.
pub(super) fn draw_walk<P: Copy>(image: &mut ImageMut<'_, P>, walk: &Walk, color: P) {
    let stride = image.stride();
    let index_of = |x: i16, y: i16| (y as usize).wrapping_mul(stride).wrapping_add(x as usize);
    let index = index_of(walk.position().x, walk.position().y);
    let (along, across) = walk.directions();
    let stride_of = |by: Direction| index_of(by.x, by.y);
    let strides = (stride_of(along), stride_of(along).wrapping_add(stride_of(across)));
    let (major, minor) = walk.sides();
    let pixels = image.as_mut_pixels();
    let count = walk.pixels_left();
    if minor == 0 {
        if along.y == 0 {
            let first = if along.x < 0 { index.wrapping_sub(count as usize - 1) } else { index };
            if let Some(run) = pixels.get_mut(first..first.wrapping_add(count as usize)) {
                run.fill(color);
            }
        } else {
            every(pixels, index, strides.0, count, color);
        }
    } else if minor == major {
        every(pixels, index, strides.1, count, color);
    } else if count <= EXACT_STEPS {
        by_phase(pixels, index, strides, walk, color);
    } else {
        by_error(pixels, index, strides, walk, color);
    }
}

/// Steps over which 32 bits of phase are exact: (steps + 1) · (1 + 2⁻¹⁴) / 2³² < 1 / (2 · 65,535).
const EXACT_STEPS: u32 = 32_000;

/// Every pixel at a fixed distance from the one before.
fn every<P: Copy>(pixels: &mut [P], mut index: usize, stride: usize, count: u32, color: P) {
    for _ in 0..count {
        if let Some(pixel) = pixels.get_mut(index) {
            *pixel = color;
        }
        index = index.wrapping_add(stride);
    }
}

#[inline(never)]
fn by_phase<P: Copy>(
    pixels: &mut [P],
    mut index: usize,
    (along, diagonal): (usize, usize),
    walk: &Walk,
    color: P,
) {
    let (major, minor) = walk.sides();
    // The error term counts from the point where the next pixel would be halfway: as a fraction of a pixel from the
    // lower limit of this one, it is (error − 2·minor + 2·major − 1) / (2·major), and across when it reaches 1.
    let fraction = (walk.error() - 2 * minor + 2 * major - 1) as u64;
    let per_half_step = (1u64 << 63).div_ceil(2 * major.max(1) as u64);
    let scaled = |value: u64| ((value * per_half_step) >> 31) as u32 + 1;
    let (mut phase, slope) = (scaled(fraction), scaled(2 * minor as u64));
    for _ in 0..walk.pixels_left() {
        if let Some(pixel) = pixels.get_mut(index) {
            *pixel = color;
        }
        let (next, carry) = phase.overflowing_add(slope);
        phase = next;
        index = index.wrapping_add(core::hint::select_unpredictable(carry, diagonal, along));
    }
}

fn by_error<P: Copy>(
    pixels: &mut [P],
    mut index: usize,
    (along, diagonal): (usize, usize),
    walk: &Walk,
    color: P,
) {
    let (major, minor) = walk.sides();
    let mut error = walk.error();
    for _ in 0..walk.pixels_left() {
        if let Some(pixel) = pixels.get_mut(index) {
            *pixel = color;
        }
        let across = error > 0;
        index = index.wrapping_add(if across { diagonal } else { along });
        error += 2 * minor - if across { 2 * major } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::{Picture, draw};
    use super::*;

    #[test]
    fn lines_are_clipped_to_the_picture() {
        let drawn = draw(|image| {
            draw_line(image, Point::new(-4, -2), Point::new(12, 6), b'#');
            draw_line(image, Point::new(9, 0), Point::new(-9, 0), b'-');
            draw_line(image, Point::new(7, -9), Point::new(7, 99), b'|');
            draw_line(image, Point::new(-1, 5), Point::new(5, -1), b'/');
        });
        let expected: Picture<8, 5> = [
            *b"----/--|", //
            *b"..#/...|",
            *b"../.##.|",
            *b"./....#|",
            *b"/......|",
        ];
        assert_eq!(drawn, expected);
    }

    #[test]
    fn phase_and_error_light_the_same_pixels() {
        let mut seed = 1u32;
        for _ in 0..2000 {
            let mut next = || {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (seed >> 8) as i16
            };
            let (from, to) = (Point::new(next(), next()), Point::new(next(), next()));
            let window = Window::new(Point::new(0, 0), Point::new(199, 149)).unwrap();
            let Some(walk) = clip_line(from, to, &window) else { continue };
            let mut fast = [0u8; 200 * 150];
            let mut slow = fast;
            draw_walk(&mut ImageMut::new(&mut fast, 200, 150).unwrap(), &walk, 1);
            for point in walk {
                slow[usize::from(point.y as u16) * 200 + usize::from(point.x as u16)] = 1;
            }
            assert!(fast == slow, "{from:?} {to:?}");
        }
    }

    #[test]
    fn the_longest_runs_are_exact() {
        // 32,768 pixels in a line: beyond what the phase is good for; 31,999: the most that it is asked for.
        for (length, rise) in [(32_767, 2), (32_767, 3), (31_999, 1), (31_999, 3), (31_998, 3)] {
            let mut pixels = std::vec![0u8; 32_768 * 4];
            let mut image = ImageMut::new(&mut pixels, 32_768, 4).unwrap();
            let (from, to) = (Point::new(0, rise), Point::new(length, 0));
            draw_line(&mut image, from, to, 1);
            let lit = |point: Point| pixels[point.y as usize * 32_768 + point.x as usize] == 1;
            assert!(Walk::new(from, to).all(lit));
            assert_eq!(pixels.iter().filter(|&&pixel| pixel == 1).count(), length as usize + 1);
        }
    }
}
