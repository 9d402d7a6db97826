//! Pictures in colour, changed in place as a line of a camera is. The copy of the picture that is changed is made while
//! the clock stands.

use crate::stopwatch::Stopwatch;
use crate::{HEIGHT, WIDTH, rgb_pixels};
use algos_nostd::color::balance::matrix::Matrix3;
use algos_nostd::color::balance::{Gains, gray_world as gray};
use algos_nostd::color::pointwise::PixelMap;
use algos_nostd::image::{Error, Image, Rgb};
use algos_nostd::pixel::rgb888;
use anyhow::Result;

/// The estimate, then the gains, over the same frame.
pub(crate) fn gray_world(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    in_place(bytes, stopwatch, |pixels| {
        let white = gray::estimate(Image::new(pixels, WIDTH, HEIGHT)?);
        Gains::neutralizing(white)?.apply_line(pixels);
        Ok(())
    })
}

/// A camera's colour correction.
pub(crate) fn matrix(bytes: &[u8], stopwatch: &mut Stopwatch) -> Result<Vec<u8>> {
    let matrix = Matrix3::from_ten_thousandths([
        [17_000, -5_000, -2_000],
        [-2_500, 15_000, -2_500],
        [-500, -5_500, 16_000],
    ])?;
    in_place(bytes, stopwatch, |pixels| {
        matrix.apply_line(pixels);
        Ok(())
    })
}

fn in_place(
    bytes: &[u8],
    stopwatch: &mut Stopwatch,
    mut change: impl FnMut(&mut [Rgb]) -> Result<(), Error>,
) -> Result<Vec<u8>> {
    let source = rgb_pixels(bytes)?;
    let mut made = source.to_vec();
    let mut done = Ok(());
    stopwatch.time_prepared(
        &mut made,
        |made| made.copy_from_slice(source),
        |made| done = done.and(change(made)),
    );
    done?;
    Ok(rgb888::as_bytes(&made).to_vec())
}
