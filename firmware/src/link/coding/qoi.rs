//! Colour, as in the Quite OK Image format: the chunks of an image of one line and three channels.
//!
//! Dominic Szablewski: [*The Quite OK Image Format*](https://qoiformat.org/qoi-specification.pdf), version 1.0, 2022.
//!
//! ```text
//! 00iiiiii             index[i]                           11nnnnnn     previous, n + 1 times, n < 62
//! 01rrggbb             previous + (r, g, b) − 2           FE r g b     r, g, b
//! 10gggggg rrrrbbbb    previous + (g − 32) + (r − 8, 0, b − 8)
//! ```
//!
//! Cost: one pass, 192 bytes of stack. At worst a third more than the pixels.

use super::room::Room;

type Rgb = [u8; 3];

const INDEX: usize = 64;
const RUN_MAX: u8 = 62;

/// Where a pixel stands in the index; its alpha is 255.
fn place(pixel: Rgb) -> usize {
    let [red, green, blue] = pixel.map(usize::from);
    (3 * red + 5 * green + 7 * blue + 11 * 255) % INDEX
}

pub(super) fn encode(pixels: &[u8], room: &mut Room<'_>) -> Option<()> {
    let (pixels, rest) = pixels.as_chunks::<3>();
    rest.is_empty().then_some(())?;
    let (mut index, mut before, mut run) = (Index::default(), [0; 3], 0);
    for &pixel in pixels {
        if pixel == before {
            run += 1;
            if run == RUN_MAX {
                room.byte(0xC0 | (run - 1))?;
                run = 0;
            }
            continue;
        }
        if run > 0 {
            room.byte(0xC0 | (run - 1))?;
            run = 0;
        }
        let place = place(pixel);
        if index.known(place, pixel) {
            room.byte(place as u8)?;
        } else {
            put_new(before, pixel, room)?;
        }
        index.set(place, pixel);
        before = pixel;
    }
    if run > 0 {
        room.byte(0xC0 | (run - 1))?;
    }
    Some(())
}

/// A pixel that is not in the index.
fn put_new(before: Rgb, pixel: Rgb, room: &mut Room<'_>) -> Option<()> {
    let [red, green, blue] = pixel;
    let step = |new: u8, old: u8, least: u8| new.wrapping_sub(old).wrapping_add(least);
    let small = [step(red, before[0], 2), step(green, before[1], 2), step(blue, before[2], 2)];
    if small.iter().all(|&step| step < 4) {
        return room.byte(0x40 | small[0] << 4 | small[1] << 2 | small[2]);
    }
    let luma = step(green, before[1], 32);
    let common = green.wrapping_sub(before[1]);
    let red_step = step(red, before[0].wrapping_add(common), 8);
    let blue_step = step(blue, before[2].wrapping_add(common), 8);
    if luma < 64 && red_step < 16 && blue_step < 16 {
        return room.put(&[0x80 | luma, red_step << 4 | blue_step]);
    }
    room.put(&[0xFE, red, green, blue])
}

pub(super) fn decode(mut coded: &[u8], room: &mut Room<'_>) -> Option<()> {
    let (mut index, mut pixel) = (Index::default(), [0; 3]);
    while let Some((&first, rest)) = coded.split_first() {
        coded = rest;
        match first {
            0xFE => {
                let (color, rest) = coded.split_first_chunk::<3>()?;
                pixel = *color;
                coded = rest;
            }
            0xFF => return None,
            0xC0.. => {
                let (pixels, _) = room.take(3 * usize::from((first & 63) + 1))?.as_chunks_mut::<3>();
                pixels.fill(pixel);
                index.set(place(pixel), pixel);
                continue;
            }
            0x80.. => {
                let (&second, rest) = coded.split_first()?;
                coded = rest;
                let common = (first & 63).wrapping_sub(32);
                let [red, green, blue] = pixel.map(|channel| channel.wrapping_add(common));
                let (red_step, blue_step) = ((second >> 4).wrapping_sub(8), (second & 15).wrapping_sub(8));
                pixel = [red.wrapping_add(red_step), green, blue.wrapping_add(blue_step)];
            }
            0x40.. => {
                let steps = [first >> 4 & 3, first >> 2 & 3, first & 3];
                for (channel, step) in pixel.iter_mut().zip(steps) {
                    *channel = channel.wrapping_add(step).wrapping_sub(2);
                }
            }
            _ => pixel = index.get(usize::from(first)),
        }
        index.set(place(pixel), pixel);
        room.put(&pixel)?;
    }
    Some(())
}

/// The pixels seen last, by their [`place`].
struct Index([Rgb; INDEX]);

impl Default for Index {
    fn default() -> Self {
        Self([[0; 3]; INDEX])
    }
}

impl Index {
    fn get(&self, place: usize) -> Rgb {
        self.0[place % INDEX]
    }

    fn set(&mut self, place: usize, pixel: Rgb) {
        self.0[place % INDEX] = pixel;
    }

    /// Black is never taken from the index: where nothing has been, the format has alpha 0, which is another pixel.
    fn known(&self, place: usize, pixel: Rgb) -> bool {
        pixel != [0; 3] && self.get(place) == pixel
    }
}
