use image::RgbImage;
use rgb::FromSlice;

use super::SizeError;
use crate::profile::Profile;

/// The bytes of a frame as DMA would write them: line after line without a gap, samples of buses wider than 8 bits
/// zero-extended to 16 bits, low byte first.
///
/// The profile must have passed [`Profile::check`].
///
/// # Errors
/// [`SizeError`] if the picture is not of the profile's size.
pub fn encode(picture: &RgbImage, profile: &Profile) -> Result<Vec<u8>, SizeError> {
    let frame = &profile.frame;
    let size_error = SizeError { picture: picture.dimensions(), frame: (frame.width, frame.height) };
    if size_error.picture != size_error.frame {
        return Err(size_error);
    }
    let (width, line) = (frame.width as usize, profile.bytes_per_line() as usize);
    let mut bytes = vec![0; line * frame.height as usize];
    let meaning = frame.meaning();
    let rows = picture.as_raw().as_rgb().chunks(width.max(1));
    for (y, (pixels, bytes)) in rows.zip(bytes.chunks_mut(line.max(1))).enumerate() {
        // Refused are wrong lengths and odd YUV lines, which a checked profile does not have.
        frame.format.encode_line(pixels, bytes, y, &meaning).map_err(|_| size_error)?;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_wide_bus_take_two_bytes() {
        let mut profile = Profile::built_in("vga-raw12").unwrap();
        (profile.frame.width, profile.frame.height) = (2, 2);
        let picture =
            RgbImage::from_fn(2, 2, |x, y| image::Rgb([0, 255, if (x, y) == (0, 1) { 128 } else { 1 }]));
        // Green and red over blue and green; 8 bits spread over 12.
        let bytes = encode(&picture, &profile).unwrap();
        assert_eq!(bytes, [0xFF, 0x0F, 0, 0, 0x08, 0x08, 0xFF, 0x0F]);
    }

    #[test]
    fn another_size_is_refused() {
        let error = encode(&RgbImage::new(3, 2), &Profile::default()).unwrap_err();
        assert_eq!(error, SizeError { picture: (3, 2), frame: (640, 480) });
    }
}
