//! Maps of 0 and 255, a bit a pixel; and runs of bytes of such bits.
//!
//! ```text
//! pixel   0 1 2 3 4 5 6 7 │ 8 …        the first pixel is the least significant bit
//! bit     0 1 2 3 4 5 6 7 │ 0 …        as in algos_nostd::edges::bits
//! ```
//!
//! Cost: one pass; 8 pixels a byte.

use super::room::Room;
use super::run_length;

/// Bits of the last byte that are no pixels.
#[must_use]
pub const fn unused_bits(pixels: usize) -> u8 {
    (pixels.wrapping_neg() % 8) as u8
}

/// Byte `at` of the packed line; `None` where a pixel is neither 0 nor 255.
fn packed(pixels: &[u8], at: usize) -> Option<[u8; 1]> {
    let rest = pixels.get(8 * at..)?;
    let mut byte = 0;
    for (bit, &pixel) in rest.iter().take(8).enumerate() {
        (pixel == 0 || pixel == 255).then_some(())?;
        byte |= (pixel & 1) << bit;
    }
    Some([byte])
}

pub(super) fn encode(pixels: &[u8], room: &mut Room<'_>) -> Option<()> {
    (0..pixels.len().div_ceil(8)).try_for_each(|at| room.put(&packed(pixels, at)?))
}

pub(super) fn decode(coded: &[u8], unused: u8, room: &mut Room<'_>) -> Option<()> {
    let count = (8 * coded.len()).checked_sub(unused.into())?;
    unpack(coded, room.take(count)?);
    Some(())
}

fn unpack(coded: &[u8], pixels: &mut [u8]) {
    for (byte, pixels) in coded.iter().zip(pixels.chunks_mut(8)) {
        for (bit, pixel) in pixels.iter_mut().enumerate() {
            *pixel = (byte >> bit & 1).wrapping_neg();
        }
    }
}

/// The number of pixels, then runs of the packed bytes.
pub(super) fn encode_runs(pixels: &[u8], room: &mut Room<'_>) -> Option<()> {
    room.put(&u16::try_from(pixels.len()).ok()?.to_le_bytes())?;
    run_length::encode_units(pixels.len().div_ceil(8), |at| packed(pixels, at), room)
}

pub(super) fn decode_runs(coded: &[u8], room: &mut Room<'_>) -> Option<()> {
    let (count, mut coded) = coded.split_first_chunk::<2>()?;
    let pixels = room.take(u16::from_le_bytes(*count).into())?;
    let mut places = pixels.chunks_mut(8);
    while let Some((&control, rest)) = coded.split_first() {
        let control = usize::from(control);
        if control < 128 {
            let (literals, rest) = rest.split_at_checked(control + 1)?;
            literals.iter().try_for_each(|&byte| places.next().map(|eight| unpack(&[byte], eight)))?;
            coded = rest;
        } else {
            let (&byte, rest) = rest.split_first()?;
            (0..control - 126).try_for_each(|_| places.next().map(|eight| unpack(&[byte], eight)))?;
            coded = rest;
        }
    }
    places.next().is_none().then_some(())
}
