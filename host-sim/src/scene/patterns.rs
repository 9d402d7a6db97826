//! The plain scenes, each for one question.

use image::{Rgb, RgbImage};

use super::paint::{BLACK, SUB, WHITE, disc_cover, hue, mix, ramp, scramble};

/// Squares of a sixteenth of the height: where a line is lost or a pixel shifted, they break.
pub(super) fn checker(picture: &mut RgbImage) {
    let side = (picture.height() / 16).max(1);
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        *pixel = if (x / side + y / side).is_multiple_of(2) { WHITE } else { BLACK };
    }
}

/// Hue across, brightness down, and a gray ramp at the foot: where bits are swapped or lost, it is no longer smooth.
pub(super) fn gradient(picture: &mut RgbImage) {
    let (width, height) = picture.dimensions();
    let foot = height - height / 6;
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        *pixel = if y < foot {
            let colour = hue((u64::from(x) * 1_536 / u64::from(width)) as u32);
            // White at the top, the full colour in the middle, black at the foot.
            let (step, half) = (i64::from(y), i64::from(foot.div_ceil(2)));
            if step < half { mix(WHITE, colour, step, half) } else { mix(colour, BLACK, step - half, half) }
        } else {
            Rgb([ramp(0, 255, x, width); 3])
        };
    }
}

/// A yellow disc with a dark rim on blue-gray. It moves by a 64th of the width a frame and a 96th of the height.
pub(super) fn moving(picture: &mut RgbImage, frame_number: u64) {
    let (width, height) = (i64::from(picture.width()) * SUB, i64::from(picture.height()) * SUB);
    let radius = (width.min(height) / 8).max(SUB / 2);
    let centre = (
        bounce(frame_number, (width / 64).max(SUB), radius, width - radius),
        bounce(frame_number, (height / 96).max(SUB), radius, height - radius),
    );
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let ground = Rgb([40, 52, 70]);
        let rim = mix(ground, Rgb([12, 12, 16]), disc_cover(x, y, centre, radius), SUB);
        *pixel = mix(rim, Rgb([250, 205, 40]), disc_cover(x, y, centre, radius * 7 / 8), SUB);
    }
}

/// Where something is that goes to and fro between two ends by `step` a frame.
pub(super) fn bounce(frame_number: u64, step: i64, from: i64, to: i64) -> i64 {
    let way = (to - from).max(1);
    let gone = (i128::from(frame_number) * i128::from(step)).rem_euclid(2 * i128::from(way)) as i64;
    from + if gone <= way { gone } else { 2 * way - gone }
}

/// Every byte on its own.
pub(super) fn noise(picture: &mut RgbImage, seed: u64, frame_number: u64) {
    let start = scramble(seed ^ scramble(frame_number));
    for (index, eight) in (0u64..).zip(picture.chunks_mut(8)) {
        let bits = scramble(start.wrapping_add(index)).to_le_bytes();
        eight.copy_from_slice(&bits[..eight.len()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bouncing_stays_between_its_ends() {
        let places: Vec<_> = (0..9).map(|frame| bounce(frame, 2, 10, 16)).collect();
        assert_eq!(places, [10, 12, 14, 16, 14, 12, 10, 12, 14]);
        assert_eq!(bounce(u64::MAX, 3, 5, 5), bounce(u64::MAX, 3, 5, 5), "no way to go is no fault");
    }

    #[test]
    fn noise_is_even() {
        let mut picture = RgbImage::new(256, 256);
        noise(&mut picture, 7, 0);
        let mean = picture.iter().map(|&byte| u64::from(byte)).sum::<u64>() / picture.len() as u64;
        assert!((126..=129).contains(&mean), "{mean}");
    }
}
