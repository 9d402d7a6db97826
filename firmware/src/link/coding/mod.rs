//! The encodings of a line, without loss; each packet is coded by itself.
//!
//! | file | what lives there |
//! |---|---|
//! | `run_length` | runs of equal units |
//! | `qoi` | colour, as in the Quite OK Image format |
//! | `differences` | gray and mosaics, by small differences |
//! | `bits` | maps of 0 and 255, a bit a pixel, and runs of them |

mod bits;
mod differences;
mod qoi;
mod run_length;
mod room;

use algos_nostd::pixel::format::Format as Pixels;

use super::format::{Choice, Encoding, Format};
use room::Room;

pub use bits::unused_bits;

/// Encodes the pixels of a line in an encoding that `choice` allows, into at most `room.len()` bytes.
///
/// Returns the encoding and its bytes; `None` if none of them can hold these pixels, or none fits. [`Encoding::Raw`] is
/// never tried: it is what remains.
pub fn encode(format: Format, choice: Choice, pixels: &[u8], room: &mut [u8]) -> Option<(Encoding, usize)> {
    let tried = match (choice, format) {
        (Choice::One(Encoding::Raw), _) => &[][..],
        (Choice::One(encoding), _) => &[encoding],
        (Choice::Sender, Format::GRAY8) => &[Encoding::BitsRunLength, Encoding::Bits, Encoding::Qoi],
        (Choice::Sender, Format::Pixels(Pixels::Rgb888 | Pixels::Raw8)) => &[Encoding::Qoi],
        (Choice::Sender, _) => &[Encoding::RunLength],
    };
    for &encoding in tried {
        // Runs of bits are worth it only where they are shorter than the bits.
        let limit = if choice == Choice::Sender && encoding == Encoding::BitsRunLength {
            room.len().min(pixels.len().div_ceil(8))
        } else {
            room.len()
        };
        if let Some(length) =
            room.get_mut(..limit).and_then(|room| encode_one(format, encoding, pixels, room))
        {
            return Some((encoding, length));
        }
    }
    None
}

fn encode_one(format: Format, encoding: Encoding, pixels: &[u8], room: &mut [u8]) -> Option<usize> {
    let mut room = Room::new(room);
    match (encoding, format) {
        (Encoding::Raw, _) => room.put(pixels)?,
        (Encoding::RunLength, _) => match format.unit_bytes() {
            1 => run_length::encode::<1>(pixels, &mut room)?,
            2 => run_length::encode::<2>(pixels, &mut room)?,
            3 => run_length::encode::<3>(pixels, &mut room)?,
            _ => run_length::encode::<4>(pixels, &mut room)?,
        },
        (Encoding::Qoi, Format::RGB888) => qoi::encode(pixels, &mut room)?,
        (Encoding::Qoi, Format::GRAY8) => differences::encode::<1>(pixels, &mut room)?,
        (Encoding::Qoi, Format::Pixels(Pixels::Raw8)) => differences::encode::<2>(pixels, &mut room)?,
        (Encoding::Bits, Format::GRAY8) => bits::encode(pixels, &mut room)?,
        (Encoding::BitsRunLength, Format::GRAY8) => bits::encode_runs(pixels, &mut room)?,
        _ => return None,
    }
    Some(room.length())
}

/// Decodes a payload into `pixels`, and says how many bytes it gave.
///
/// `None` if it is malformed or gives more than there is room for. What is in `pixels` is then undefined.
pub fn decode(
    format: Format,
    encoding: Encoding,
    unused: u8,
    payload: &[u8],
    pixels: &mut [u8],
) -> Option<usize> {
    let mut room = Room::new(pixels);
    match (encoding, format) {
        (Encoding::Raw, _) => room.put(payload)?,
        (Encoding::RunLength, _) => match format.unit_bytes() {
            1 => run_length::decode::<1>(payload, &mut room)?,
            2 => run_length::decode::<2>(payload, &mut room)?,
            3 => run_length::decode::<3>(payload, &mut room)?,
            _ => run_length::decode::<4>(payload, &mut room)?,
        },
        (Encoding::Qoi, Format::RGB888) => qoi::decode(payload, &mut room)?,
        (Encoding::Qoi, Format::GRAY8) => differences::decode::<1>(payload, &mut room)?,
        (Encoding::Qoi, Format::Pixels(Pixels::Raw8)) => differences::decode::<2>(payload, &mut room)?,
        (Encoding::Bits, Format::GRAY8) => bits::decode(payload, unused, &mut room)?,
        (Encoding::BitsRunLength, Format::GRAY8) => bits::decode_runs(payload, &mut room)?,
        _ => return None,
    }
    let length = room.length();
    length.is_multiple_of(format.unit_bytes()).then_some(length)
}

#[cfg(test)]
mod tests;
