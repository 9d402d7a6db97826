//! The rivals side by side: what the frame looks like under each format, with its name and confidence.

use image::{Rgb, RgbImage, imageops};

use super::bus::BusGuess;
use super::format::FormatGuess;
use crate::picture;
use crate::profile::Profile;
use crate::scene::text;

/// Rivals that are shown.
pub const SHOWN: usize = 6;
const COLUMNS: u32 = 3;
/// Pixels of a picture's cell, without its label.
const CELL: (u32, u32) = (320, 240);
const GAP: u32 = 16;
const LABEL: u32 = 40;
const GROUND: Rgb<u8> = Rgb([24, 27, 31]);
const BRIGHT: Rgb<u8> = Rgb([236, 238, 240]);
const DIM: Rgb<u8> = Rgb([150, 157, 165]);

/// The frame under a format.
#[must_use]
pub fn picture_of(guess: &BusGuess, format: &FormatGuess) -> RgbImage {
    let bytes: Vec<u8> = if guess.profile.bus.bits == 8 {
        guess.samples.iter().map(|&sample| sample as u8).collect()
    } else {
        guess.samples.iter().flat_map(|sample| sample.to_le_bytes()).collect()
    };
    let profile = Profile { frame: format.frame, ..guess.profile.clone() };
    picture::decode(&bytes, &profile).picture
}

/// The first [`SHOWN`] formats, the most likely at the top left.
#[must_use]
pub fn contact_sheet(guess: &BusGuess) -> RgbImage {
    let shown = guess.formats.len().min(SHOWN) as u32;
    let columns = shown.clamp(1, COLUMNS);
    let rows = shown.div_ceil(columns).max(1);
    let size = (GAP + columns * (CELL.0 + GAP), GAP + rows * (CELL.1 + LABEL + GAP));
    let mut sheet = RgbImage::from_pixel(size.0, size.1, GROUND);
    for (place, format) in (0..shown).zip(&guess.formats) {
        let at = (GAP + place % columns * (CELL.0 + GAP), GAP + place / columns * (CELL.1 + LABEL + GAP));
        let picture = picture_of(guess, format);
        let (width, height) = fitted(picture.dimensions());
        let small = imageops::thumbnail(&picture, width, height);
        let (x, y) = (at.0 + (CELL.0 - width) / 2, at.1 + (CELL.1 - height) / 2);
        imageops::replace(&mut sheet, &small, i64::from(x), i64::from(y));
        let colour = if place == 0 { BRIGHT } else { DIM };
        let name = format.to_string().replace('×', "x");
        text::write(&mut sheet, (at.0, at.1 + CELL.1 + 6), 1, colour, &name);
        let numbers = format!(
            "confidence {}.{} %, {}.{:02} bits a sample",
            format.confidence / 10,
            format.confidence % 10,
            format.millibits / 1000,
            format.millibits % 1000 / 10
        );
        text::write(&mut sheet, (at.0, at.1 + CELL.1 + 20), 1, colour, &numbers);
    }
    sheet
}

/// The largest size of these proportions that fits a cell.
fn fitted((width, height): (u32, u32)) -> (u32, u32) {
    let (w, h) = (u64::from(width.max(1)), u64::from(height.max(1)));
    let (most_w, most_h) = (u64::from(CELL.0), u64::from(CELL.1));
    if w * most_h >= h * most_w {
        (CELL.0, (h * most_w / w).max(1) as u32)
    } else {
        ((w * most_h / h).max(1) as u32, CELL.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn proportions_are_kept() {
        assert_eq!(
            [(640, 480), (1920, 480), (10, 480), (0, 0)].map(fitted),
            [(320, 240), (320, 80), (5, 240), (240, 240)]
        );
    }
}
