//! Gray and mosaics, by small differences to the pixel `BACK` before, which has the same colour.
//!
//! ```text
//! 00aaabbb   two pixels: a − 4, b − 4               11nnnnnn   n + 1 pixels: 0, n < 62
//! 01aabbcc   three pixels: a − 2, b − 2, c − 2      FE v       one pixel: v itself
//! 10dddddd   one pixel: d − 32
//! ```
//!
//! Cost: one pass. At worst twice the pixels, so raw is what remains.

use super::room::Room;

const RUN_MAX: usize = 62;

pub(super) fn encode<const BACK: usize>(pixels: &[u8], room: &mut Room<'_>) -> Option<()> {
    let mut at = 0;
    while at < pixels.len() {
        let step = |offset: usize| {
            let place = at + offset;
            let before = place.checked_sub(BACK).and_then(|place| pixels.get(place)).copied().unwrap_or(0);
            pixels.get(place).map(|pixel| pixel.wrapping_sub(before))
        };
        let steps = [step(0), step(1), step(2)];
        if steps == [Some(0); 3] {
            let mut run = 3;
            while run < RUN_MAX && step(run) == Some(0) {
                run += 1;
            }
            room.byte(0xC0 | (run - 1) as u8)?;
            at += run;
            continue;
        }
        let within = |step: Option<u8>, least: u8, codes: u8| {
            step.map(|step| step.wrapping_add(least)).filter(|&code| code < codes)
        };
        if let [Some(a), Some(b), Some(c)] = steps.map(|step| within(step, 2, 4)) {
            room.byte(0x40 | a << 4 | b << 2 | c)?;
            at += 3;
        } else if let (Some(a), Some(b)) = (within(steps[0], 4, 8), within(steps[1], 4, 8)) {
            room.byte(a << 3 | b)?;
            at += 2;
        } else if let Some(code) = within(steps[0], 32, 64) {
            room.byte(0x80 | code)?;
            at += 1;
        } else {
            room.put(&[0xFE, *pixels.get(at)?])?;
            at += 1;
        }
    }
    Some(())
}

pub(super) fn decode<const BACK: usize>(coded: &[u8], room: &mut Room<'_>) -> Option<()> {
    // The last pixels, the one before last of all first.
    let mut last = [0u8; BACK];
    let mut coded = coded.iter();
    while let Some(&first) = coded.next() {
        let mut put = |step: u8| {
            last.rotate_left(1);
            let pixel = last.last_mut()?;
            *pixel = pixel.wrapping_add(step);
            room.byte(*pixel)
        };
        match first {
            0xFE => {
                last.rotate_left(1);
                *last.last_mut()? = *coded.next()?;
                room.byte(*last.last()?)?;
            }
            0xFF => return None,
            0xC0.. => (0..=first & 63).try_for_each(|_| put(0))?,
            0x80.. => put((first & 63).wrapping_sub(32))?,
            0x40.. => [4, 2, 0].into_iter().try_for_each(|by| put((first >> by & 3).wrapping_sub(2)))?,
            _ => [3, 0].into_iter().try_for_each(|by| put((first >> by & 7).wrapping_sub(4)))?,
        }
    }
    Some(())
}
