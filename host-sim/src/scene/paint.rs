//! Integer mathematics of pictures. Positions are in sixteenths of a pixel where a soft edge needs them.

use image::{Rgb, RgbImage};

pub(super) const BLACK: Rgb<u8> = Rgb([0, 0, 0]);
pub(super) const WHITE: Rgb<u8> = Rgb([255, 255, 255]);

/// Sixteenths in a pixel.
pub(super) const SUB: i64 = 16;

/// A part of a picture, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Area {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Area {
    /// The part of a picture between fractions of its sides, in thousandths.
    pub(super) fn of(picture: &RgbImage, x: [u32; 2], y: [u32; 2]) -> Self {
        let at = |side: u32, part: u32| (u64::from(side) * u64::from(part) / 1_000) as u32;
        let (left, right) = (at(picture.width(), x[0]), at(picture.width(), x[1]));
        let (top, bottom) = (at(picture.height(), y[0]), at(picture.height(), y[1]));
        Self { x: left, y: top, width: right - left, height: bottom - top }
    }

    /// Fills the area, each pixel from its place in the area.
    pub(super) fn fill(self, picture: &mut RgbImage, mut colour: impl FnMut(u32, u32) -> Rgb<u8>) {
        for y in 0..self.height {
            for x in 0..self.width {
                if let Some(pixel) = picture.get_pixel_mut_checked(self.x + x, self.y + y) {
                    *pixel = colour(x, y);
                }
            }
        }
    }
}

/// `part` of `whole` of the way from one colour to the other, rounded to the nearest.
pub(super) fn mix(from: Rgb<u8>, to: Rgb<u8>, part: i64, whole: i64) -> Rgb<u8> {
    let whole = whole.max(1);
    let part = part.clamp(0, whole);
    Rgb(std::array::from_fn(|channel| {
        let (from, to) = (i64::from(from.0[channel]), i64::from(to.0[channel]));
        ((from * (whole - part) + to * part + whole / 2) / whole) as u8
    }))
}

/// `from` to `to` over `steps` steps of which this is `step`; a ramp of one step is its start.
pub(super) fn ramp(from: u8, to: u8, step: u32, steps: u32) -> u8 {
    let last = i64::from(steps.max(2) - 1);
    let (from, to) = (i64::from(from), i64::from(to));
    (from + (to - from) * i64::from(step).min(last) / last) as u8
}

/// A colour of full brightness: 1,536 hues around the circle from red over green and blue.
pub(super) fn hue(angle: u32) -> Rgb<u8> {
    let (sector, part) = (angle / 256 % 6, (angle % 256) as u8);
    let (up, down) = (part, 255 - part);
    Rgb(match sector {
        0 => [255, up, 0],
        1 => [down, 255, 0],
        2 => [0, 255, up],
        3 => [0, down, 255],
        4 => [up, 0, 255],
        _ => [255, 0, down],
    })
}

/// How much of the pixel lies inside a disc, in sixteenths: centre and radius in sixteenths of a pixel.
///
/// The distance to the rim, clamped to a pixel: a soft edge without multisampling.
pub(super) fn disc_cover(x: u32, y: u32, centre: (i64, i64), radius: i64) -> i64 {
    let (dx, dy) = (i64::from(x) * SUB + SUB / 2 - centre.0, i64::from(y) * SUB + SUB / 2 - centre.1);
    let distance = (dx * dx + dy * dy).isqrt();
    (radius - distance + SUB / 2).clamp(0, SUB)
}

/// SplitMix64 (Steele, Lea, Flood 2014): 64 well-mixed bits of any number.
pub(super) fn scramble(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixing_ends_at_its_ends() {
        assert_eq!(mix(BLACK, WHITE, 0, 7), BLACK);
        assert_eq!(mix(BLACK, WHITE, 7, 7), WHITE);
        assert_eq!(mix(BLACK, WHITE, 1, 2), Rgb([128; 3]));
        assert_eq!(mix(BLACK, WHITE, 9, 0), WHITE, "no whole is one");
        assert_eq!((ramp(10, 250, 0, 25), ramp(10, 250, 24, 25), ramp(9, 1, 0, 1)), (10, 250, 9));
    }

    #[test]
    fn a_disc_is_round_and_soft() {
        let centre = (4 * SUB, 4 * SUB);
        let rows: Vec<String> = (0..8)
            .map(|y| {
                (0..8)
                    .map(|x| match disc_cover(x, y, centre, 3 * SUB) {
                        0 => '.',
                        16 => '#',
                        _ => '+',
                    })
                    .collect()
            })
            .collect();
        assert_eq!(
            rows,
            ["........", "..+##+..", ".+####+.", ".######.", ".######.", ".+####+.", "..+##+..", "........",]
        );
    }
}
