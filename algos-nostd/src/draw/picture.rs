//! Small pictures of letters for the tests of this folder.

use crate::image::ImageMut;

/// Lines of letters; a dot is an untouched pixel.
pub(super) type Picture<const W: usize, const H: usize> = [[u8; W]; H];

/// What drawing makes of a picture of dots.
pub(super) fn draw<const W: usize, const H: usize>(
    drawing: impl FnOnce(&mut ImageMut<'_, u8>),
) -> Picture<W, H> {
    draw_over([[b'.'; W]; H], drawing)
}

/// What drawing makes of a picture.
pub(super) fn draw_over<const W: usize, const H: usize>(
    mut picture: Picture<W, H>,
    drawing: impl FnOnce(&mut ImageMut<'_, u8>),
) -> Picture<W, H> {
    let pixels = picture.as_flattened_mut();
    drawing(&mut ImageMut::new(pixels, W, H).expect("a picture has pixels"));
    picture
}
