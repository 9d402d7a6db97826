//! Colour bars: eight of the same width, from white to black.
//!
//! ```text
//! white yellow cyan green magenta red blue black
//!  RGB    RG    GB    G     RB     R    B
//! ```
//!
//! Source: the bars of ITU-R BT.471, as the kernel's test pattern generator (`v4l2-tpg`) and libcamera draw them.

use image::{Rgb, RgbImage};

/// Which of red, green and blue a bar has.
const BARS: [[u8; 3]; 8] =
    [[1, 1, 1], [1, 1, 0], [0, 1, 1], [0, 1, 0], [1, 0, 1], [1, 0, 0], [0, 0, 1], [0, 0, 0]];

/// The bar at a column.
fn bar(x: u32, width: u32) -> [u8; 3] {
    BARS[(x * 8 / width) as usize]
}

/// Bars of this level: 255 is 100 %.
#[must_use]
pub fn picture(width: u32, height: u32, level: u8) -> RgbImage {
    RgbImage::from_fn(width, height, |x, _| Rgb(bar(x, width).map(|part| part * level)))
}

/// The luma of such bars, by BT.709 in full range, as vivid makes gray.
#[must_use]
pub fn luma(width: u32, height: u32, level: u8) -> RgbImage {
    RgbImage::from_fn(width, height, |x, _| {
        let [r, g, b] = bar(x, width).map(|part| f64::from(part * level));
        Rgb([(0.2126 * r + 0.7152 * g + 0.0722 * b).round() as u8; 3])
    })
}

/// The greatest difference of a sample, and the pixel of it. Pixels no further than `margin` from a border between bars, or from the
/// picture's, are left out: there a mosaic is interpolated.
#[must_use]
pub fn difference(picture: &RgbImage, expected: &RgbImage, margin: u32) -> (u8, (u32, u32)) {
    assert_eq!(picture.dimensions(), expected.dimensions());
    let (width, height) = picture.dimensions();
    let inside = |x: u32, y: u32| {
        let within = |at: u32, size: u32| at >= margin && at + margin < size;
        within(x, width)
            && within(y, height)
            && bar(x - margin, width) == bar(x, width)
            && bar(x + margin, width) == bar(x, width)
    };
    let of = |x: u32, y: u32| {
        let (got, wanted) = (picture.get_pixel(x, y).0, expected.get_pixel(x, y).0);
        got.iter().zip(wanted).map(|(&got, wanted)| got.abs_diff(wanted)).max().unwrap_or(0)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let all = pixels.filter(|&(x, y)| inside(x, y)).map(|(x, y)| (of(x, y), (x, y)));
    all.max_by_key(|(difference, _)| *difference).expect("the margin leaves nothing")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_those_of_the_definition() {
        let bars = picture(16, 2, 191);
        let row: Vec<[u8; 3]> = (0..16).step_by(2).map(|x| bars.get_pixel(x + 1, 1).0).collect();
        assert_eq!(
            row,
            [
                [191, 191, 191],
                [191, 191, 0],
                [0, 191, 191],
                [0, 191, 0],
                [191, 0, 191],
                [191, 0, 0],
                [0, 0, 191],
                [0, 0, 0]
            ]
        );
        let luma = luma(8, 1, 255);
        assert_eq!([0, 3, 7].map(|x| luma.get_pixel(x, 0).0[0]), [255, 182, 0]);
    }

    #[test]
    fn a_difference_is_found_and_borders_can_be_left_out() {
        let expected = picture(64, 8, 255);
        let mut other = expected.clone();
        assert_eq!(difference(&other, &expected, 2).0, 0);
        other.get_pixel_mut(8, 4).0[1] = 200;
        assert_eq!(difference(&other, &expected, 0), (55, (8, 4)));
        assert_eq!(difference(&other, &expected, 2).0, 0);
        other.get_pixel_mut(11, 4).0[1] = 245;
        assert_eq!(difference(&other, &expected, 2), (10, (11, 4)));
    }
}
