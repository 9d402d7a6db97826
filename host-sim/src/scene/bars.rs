//! Colour bars, in the manner of SMPTE EG 1: eight bars at 75 %, a row of those that hold blue, a ramp and steps near black.
//!
//! ```text
//! ┌──┬──┬──┬──┬──┬──┬──┬──┐
//! │w │y │c │g │m │r │b │k │  bars: every neighbour differs in green, or in red and blue
//! ├──┼──┼──┼──┼──┼──┼──┼──┤
//! │b │  │m │  │c │  │w │  │  those that hold blue: shows swapped chroma
//! ├──┴──┴──┴──┴──┴──┴──┴──┤
//! │ black ────────► white │  ramp: shows lost bits
//! ├───────┬───────┬───────┤
//! │ white │ steps │ black │
//! └───────┴───────┴───────┘
//! ```

use image::{Rgb, RgbImage};

use super::paint::{Area, BLACK, WHITE, ramp};

/// 75 % of full brightness.
const HIGH: u8 = 191;

/// Red, green and blue of the bars, from white to black.
const BARS: [[bool; 3]; 8] = [
    [true, true, true],
    [true, true, false],
    [false, true, true],
    [false, true, false],
    [true, false, true],
    [true, false, false],
    [false, false, true],
    [false, false, false],
];

/// The bar at a place in a line; all eight have a share that differs by a pixel at most.
pub(super) fn bar(x: u32, width: u32) -> Rgb<u8> {
    let index = (u64::from(x) * BARS.len() as u64 / u64::from(width.max(1))) as usize;
    colour(index)
}

/// The colour of a bar; there is none past the last.
fn colour(index: usize) -> Rgb<u8> {
    let bar = BARS[index.min(BARS.len() - 1)];
    Rgb(bar.map(|on| if on { HIGH } else { 0 }))
}

/// Blue, magenta, cyan and white with black between: the bars that hold blue, in the order that puts each below
/// another one.
fn blue_ones(x: u32, width: u32) -> Rgb<u8> {
    let index = (u64::from(x) * 8 / u64::from(width.max(1))) as usize;
    match index {
        0 | 2 | 4 | 6 => colour(6 - index),
        _ => BLACK,
    }
}

pub(super) fn paint(picture: &mut RgbImage) {
    let across = [0, 1_000];
    let width = picture.width();
    Area::of(picture, across, [0, 640]).fill(picture, |x, _| bar(x, width));
    Area::of(picture, across, [640, 730]).fill(picture, |x, _| blue_ones(x, width));
    Area::of(picture, across, [730, 860]).fill(picture, |x, _| Rgb([ramp(0, 255, x, width); 3]));
    Area::of(picture, [0, 300], [860, 1_000]).fill(picture, |_, _| WHITE);
    let steps = Area::of(picture, [300, 700], [860, 1_000]);
    // Eight steps of four levels each, from black: a clipped black level hides some.
    steps.fill(picture, |x, _| Rgb([(x * 8 / steps.width.max(1) * 4) as u8; 3]));
    Area::of(picture, [700, 1_000], [860, 1_000]).fill(picture, |_, _| BLACK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bars_stand_in_their_order() {
        let mut picture = RgbImage::new(640, 480);
        paint(&mut picture);
        let letters = |y: u32| -> String {
            let letter = |pixel: [u8; 3]| match pixel.map(|value| value == HIGH) {
                [true, true, true] => 'w',
                [true, true, false] => 'y',
                [false, true, true] => 'c',
                [false, true, false] => 'g',
                [true, false, true] => 'm',
                [true, false, false] => 'r',
                [false, false, true] => 'b',
                [false, false, false] => 'k',
            };
            (0..8).map(|bar| letter(picture.get_pixel(bar * 80 + 79, y).0)).collect()
        };
        assert_eq!(letters(10), "wycgmrbk");
        assert_eq!(letters(330), "bkmkckwk");
        assert_eq!(picture.get_pixel(0, 370).0, [0, 0, 0], "the ramp's ends");
        assert_eq!(picture.get_pixel(639, 370).0, [255; 3]);
    }
}
