//! The demo's scene: a test card with something for every stage.
//!
//! ```text
//! ┌────────────────────────────────┐
//! │ w  y  c  g  m  r  b  k   bars  │  colour and its order
//! │   ,-*-.      ___       (( o )) │  a star that turns, balls with soft shading (one of them rolls),
//! │  (  *  )    (   )(  )  |||//// │  rings and lines that get finer: edges, aliasing, banding
//! │   `-*-'      ‾‾‾        ||///  │
//! │ CAMIF  640 x 480  FRAME 0003   │  letters: thin strokes
//! └────────────────────────────────┘
//! ```

use image::{Rgb, RgbImage};

use super::bars::bar;
use super::paint::{Area, SUB, disc_cover, mix, scramble};
use super::patterns::bounce;
use super::text;

const SKY: Rgb<u8> = Rgb([24, 34, 66]);
const GROUND: Rgb<u8> = Rgb([146, 120, 96]);
const PAPER: Rgb<u8> = Rgb([240, 236, 224]);
const INK: Rgb<u8> = Rgb([20, 20, 28]);

pub(super) fn paint(picture: &mut RgbImage, seed: u64, frame_number: u64) {
    background(picture, seed);
    let width = picture.width();
    Area::of(picture, [0, 1_000], [0, 170]).fill(picture, |x, _| bar(x, width));
    star(picture, frame_number);
    balls(picture, frame_number);
    rings(picture);
    wedge(picture);
    caption(picture, frame_number);
}

/// Fractions of the picture's sides, in thousandths, as sixteenths of a pixel.
fn place(picture: &RgbImage, x: i64, y: i64) -> (i64, i64) {
    (i64::from(picture.width()) * SUB * x / 1_000, i64::from(picture.height()) * SUB * y / 1_000)
}

/// A fraction of the shorter side (as if the picture were 4:3), in sixteenths of a pixel.
fn length(picture: &RgbImage, part: i64) -> i64 {
    let side = i64::from(picture.height()).min(i64::from(picture.width()) * 3 / 4).max(1);
    side * SUB * part / 1_000
}

/// Dusk over sand, with a grain of three levels either way that a sensor would have.
fn background(picture: &mut RgbImage, seed: u64) {
    let (width, height) = picture.dimensions();
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let ground = mix(SKY, GROUND, i64::from(y), i64::from(height));
        let grain = (scramble(seed ^ (u64::from(y) * u64::from(width) + u64::from(x))) % 7) as i16 - 3;
        *pixel = Rgb(ground.0.map(|value| (i16::from(value) + grain).clamp(0, 255) as u8));
    }
}

/// Runs over the pixels of a disc with their distance from its centre, in sixteenths, and their cover.
fn disc(
    picture: &mut RgbImage,
    centre: (i64, i64),
    radius: i64,
    mut colour: impl FnMut(i64, i64, Rgb<u8>) -> Rgb<u8>,
) {
    let (columns, rows) = (i64::from(picture.width()), i64::from(picture.height()));
    let span = |centre: i64, last: i64| {
        let first = ((centre - radius) / SUB - 1).clamp(0, last);
        first as u32..((centre + radius) / SUB + 2).clamp(0, last) as u32
    };
    for y in span(centre.1, rows) {
        for x in span(centre.0, columns) {
            let cover = disc_cover(x, y, centre, radius);
            if cover > 0 {
                let (dx, dy) =
                    (i64::from(x) * SUB + SUB / 2 - centre.0, i64::from(y) * SUB + SUB / 2 - centre.1);
                let pixel = picture.get_pixel_mut(x, y);
                *pixel = mix(*pixel, colour(dx, dy, *pixel), cover, SUB);
            }
        }
    }
}

/// The direction from the centre, 4,096 around: even along a diamond's edge, so no trigonometry is needed.
fn direction(dx: i64, dy: i64) -> i64 {
    let part = |of: i64| of * 1_024 / (dx.abs() + dy.abs()).max(1);
    match (dx >= 0, dy >= 0) {
        (true, true) => part(dy),
        (false, true) => 1_024 + part(-dx),
        (false, false) => 2_048 + part(-dy),
        (true, false) => 3_072 + part(dx),
    }
}

/// A Siemens star of 32 spokes, four by four places a pixel; it turns by a third of a spoke a frame.
fn star(picture: &mut RgbImage, frame_number: u64) {
    let turn = (frame_number % 4_096) as i64 * 43;
    let (centre, radius) = (place(picture, 195, 530), length(picture, 245));
    disc(picture, centre, radius, |_, _, _| INK);
    disc(picture, centre, radius * 24 / 25, |dx, dy, _| {
        let light = (0..16).filter(|place| {
            let (dx, dy) = (dx + place % 4 * 4 - 6, dy + place / 4 * 4 - 6);
            ((direction(dx, dy) + turn) / 64) % 2 == 0
        });
        mix(INK, PAPER, light.count() as i64, 16)
    });
}

/// Balls lit from the upper left, each with its shadow on the ground.
fn balls(picture: &mut RgbImage, frame_number: u64) {
    let roll = bounce(frame_number, 12, 400, 640);
    for (centre, part, colour) in [
        ((430, 430), 130, Rgb([206, 52, 44])),
        ((575, 540), 165, Rgb([58, 150, 84])),
        ((roll, 760), 85, Rgb([228, 178, 40])),
    ] {
        let (centre, radius) = (place(picture, centre.0, centre.1), length(picture, part));
        let foot = (centre.0 + radius / 4, centre.1 + radius / 3);
        disc(picture, foot, radius, |dx, dy, below| {
            // Softer towards the rim.
            mix(below, mix(below, INK, 1, 2), radius * radius - dx * dx - dy * dy, radius * radius)
        });
        disc(picture, centre, radius, |dx, dy, _| {
            let height = (radius * radius - dx * dx - dy * dy).max(0).isqrt();
            // Lambert, light from (-3, -4, 5); 7 is that direction's length.
            let lit = (-3 * dx - 4 * dy + 5 * height).max(0) / 7;
            let shaded = mix(mix(INK, colour, 1, 4), colour, lit, radius);
            // A highlight where the light is near to straight on.
            mix(shaded, PAPER, (lit - radius * 9 / 10) * 7, radius)
        });
    }
}

/// A zone plate: rings that get finer with the distance, two pixels at the rim.
fn rings(picture: &mut RgbImage) {
    let (centre, radius) = (place(picture, 840, 390), length(picture, 170));
    // The phase's slope at the rim is half a turn a pixel: 2 · rim · slope = 512 / 2 for a turn of 512.
    let rim = (radius / SUB).max(1);
    disc(picture, centre, radius, |dx, dy, _| {
        let turn = ((dx * dx + dy * dy) * 128 / (rim * SUB * SUB)) % 512;
        mix(PAPER, INK, if turn < 256 { turn } else { 511 - turn }, 255)
    });
}

/// Seven lines that converge from six pixels to one.
fn wedge(picture: &mut RgbImage) {
    let area = Area::of(picture, [715, 965], [620, 850]);
    let (width, height) = (i64::from(area.width), i64::from(area.height));
    area.fill(picture, |x, y| {
        // Seven dark and eight light strips over the width that is left at this height.
        let left = (width * 2 - width * 5 / 3 * i64::from(y) / height.max(1)).max(1);
        let from_middle = i64::from(x) * 2 - width + left / 2;
        let strip = from_middle * 30 / left;
        let inside = (0..left).contains(&from_middle);
        if inside && strip % 2 == 1 { INK } else { PAPER }
    });
}

/// What the picture is, on a dark band.
fn caption(picture: &mut RgbImage, frame_number: u64) {
    let band = Area::of(picture, [0, 1_000], [895, 1_000]);
    band.fill(picture, |_, _| INK);
    let caption = format!("CAMIF  {} x {}  frame {frame_number:04}", picture.width(), picture.height());
    let letters = u32::try_from(caption.len()).unwrap_or(u32::MAX).saturating_add(2);
    let dot =
        (band.height / (text::LETTER.1 + 2)).min(band.width / letters.saturating_mul(text::LETTER.0)).max(1);
    let at = (band.x + text::LETTER.0 * dot, band.y + band.height.saturating_sub(text::LETTER.1 * dot) / 2);
    text::write(picture, at, dot, PAPER, &caption);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_go_around_once() {
        let around = [(9, 0), (9, 9), (0, 9), (-9, 9), (-9, 0), (-9, -9), (0, -9), (9, -9)];
        let directions: Vec<_> = around.iter().map(|&(dx, dy)| direction(dx, dy)).collect();
        assert_eq!(directions, [0, 512, 1_024, 1_536, 2_048, 2_560, 3_072, 3_584]);
        assert_eq!(direction(0, 0), 0);
    }

    #[test]
    fn the_card_holds_many_colours_and_both_ends() {
        let mut picture = RgbImage::new(320, 240);
        paint(&mut picture, 1, 0);
        let colours: std::collections::HashSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
        assert!(colours.len() > 2_000, "{}", colours.len());
        assert!(colours.contains(&INK.0) && colours.contains(&PAPER.0));
    }
}
