//! Single pixels and horizontal spans at coordinates that may lie anywhere.

use crate::image::ImageMut;

/// Writes a pixel, if it is in the picture.
#[inline]
pub(super) fn put<P: Copy>(image: &mut ImageMut<'_, P>, x: i32, y: i32, color: P) {
    change(image, x, y, |_| color);
}

/// Changes a pixel, if it is in the picture.
#[inline]
pub(super) fn change<P: Copy>(image: &mut ImageMut<'_, P>, x: i32, y: i32, to: impl FnOnce(P) -> P) {
    if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y))
        && let Some(pixel) = image.pixel_mut(x, y)
    {
        *pixel = to(*pixel);
    }
}

/// Writes the part of a line that is in the picture, from column `first` to column `last`, both included.
#[inline]
pub(super) fn fill_span<P: Copy>(image: &mut ImageMut<'_, P>, (first, last): (i32, i32), y: i32, color: P) {
    let width = image.width();
    if let (Ok(y), Ok(last)) = (usize::try_from(y), usize::try_from(last))
        && let Some(row) = image.row_mut(y)
        && let Some(span) = row.get_mut(first.max(0) as usize..(last + 1).min(width))
    {
        span.fill(color);
    }
}
