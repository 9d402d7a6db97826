//! Flips, quarter turns and cropping.
//!
//! ```text
//!  a b    flip       b a   flip       c d   turned   c a   turned   d c   turned   b d
//!  c d    horizontal d c   vertical   a b   90°      d b   180°     b a   270°     a c       (clockwise)
//! ```
//!
//! What keeps to its line can be done to lines as they come ([`MirrorLines`], [`CropLines`]); what does not needs the frame. A crop of
//! a frame is a view: [`Image::crop`].
//!
//! **Cost.** One move a pixel. Quarter turns go tile by tile, so that reading down a column meets lines that are still in
//! the cache.

use super::{Error, Image, ImageMut};
use crate::lines::{LineFilter, LineSink, check_width};

/// Reverses every line in place.
pub fn flip_horizontal<P>(image: &mut ImageMut<'_, P>) {
    image.rows_mut().for_each(<[P]>::reverse);
}

/// Reverses the order of the lines in place.
pub fn flip_vertical<P>(image: &mut ImageMut<'_, P>) {
    let mut rows = image.rows_mut();
    while let (Some(top), Some(bottom)) = (rows.next(), rows.next_back()) {
        top.swap_with_slice(bottom);
    }
}

/// Turns by 180° in place.
pub fn rotate_180<P>(image: &mut ImageMut<'_, P>) {
    flip_vertical(image);
    flip_horizontal(image);
}

/// Turns by 90° clockwise: `to` is as wide as `from` is high.
///
/// # Errors
/// [`Error::SizeMismatch`] if it is not; nothing is then written.
pub fn rotate_90<P: Copy>(from: Image<'_, P>, to: &mut ImageMut<'_, P>) -> Result<(), Error> {
    let last = from.height() - 1;
    turn(from, to, |x, y| (y, last - x))
}

/// Turns by 270° clockwise, or 90° the other way: `to` is as wide as `from` is high.
///
/// # Errors
/// [`Error::SizeMismatch`] if it is not; nothing is then written.
pub fn rotate_270<P: Copy>(from: Image<'_, P>, to: &mut ImageMut<'_, P>) -> Result<(), Error> {
    let last = from.width() - 1;
    turn(from, to, |x, y| (last - y, x))
}

/// Pixels of a tile's side.
const TILE: usize = 32;

/// Fills `to` from the pixel that `source` names for each of its places.
fn turn<P: Copy>(
    from: Image<'_, P>,
    to: &mut ImageMut<'_, P>,
    source: impl Fn(usize, usize) -> (usize, usize),
) -> Result<(), Error> {
    let (width, height) = (from.height(), from.width());
    if (to.width(), to.height()) != (width, height) {
        return Err(Error::SizeMismatch { expected: (width, height), got: (to.width(), to.height()) });
    }
    for top in (0..height).step_by(TILE) {
        for left in (0..width).step_by(TILE) {
            for y in top..height.min(top + TILE) {
                let Some(row) = to.row_mut(y) else { continue };
                for (x, place) in row.iter_mut().enumerate().skip(left).take(TILE) {
                    let (column, line) = source(x, y);
                    if let Some(&pixel) = from.pixel(column, line) {
                        *place = pixel;
                    }
                }
            }
        }
    }
    Ok(())
}

/// Reverses lines as they come. Memory: one line, lent.
#[derive(Debug)]
pub struct MirrorLines<'a, P> {
    line: &'a mut [P],
}

impl<'a, P: Copy> MirrorLines<'a, P> {
    /// For lines as long as the lent one.
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if that is empty.
    pub fn new(line: &'a mut [P]) -> Result<Self, Error> {
        if line.is_empty() { Err(Error::ZeroSize { width: 0, height: 1 }) } else { Ok(Self { line }) }
    }
}

impl<P: Copy> LineFilter for MirrorLines<'_, P> {
    type Input = P;
    type Output = P;

    const LATENCY: usize = 0;

    fn push(&mut self, line: &[P], sink: &mut impl LineSink<P>) -> Result<(), Error> {
        check_width(self.line.len(), line.len())?;
        self.line.iter_mut().zip(line.iter().rev()).for_each(|(to, &from)| *to = from);
        sink.line(self.line);
        Ok(())
    }

    fn finish(&mut self, _: &mut impl LineSink<P>) {}
}

/// Hands on a window of the picture; the other lines are swallowed. Memory: none.
#[derive(Clone, Copy, Debug)]
pub struct CropLines<P> {
    width: usize,
    columns: (usize, usize),
    lines: (usize, usize),
    y: usize,
    pixel: core::marker::PhantomData<P>,
}

impl<P> CropLines<P> {
    /// Of lines of `width` pixels, the window of `size` whose top left corner is `corner`, as (across, down).
    ///
    /// # Errors
    /// [`Error::ZeroSize`] for an empty window, [`Error::SizeMismatch`] if it reaches beyond the line.
    pub fn new(width: usize, corner: (usize, usize), size: (usize, usize)) -> Result<Self, Error> {
        if size.0 == 0 || size.1 == 0 {
            return Err(Error::ZeroSize { width: size.0, height: size.1 });
        }
        let (right, bottom) = (corner.0.checked_add(size.0), corner.1.checked_add(size.1));
        match (right, bottom) {
            (Some(right), Some(bottom)) if right <= width => Ok(Self {
                width,
                columns: (corner.0, right),
                lines: (corner.1, bottom),
                y: 0,
                pixel: core::marker::PhantomData,
            }),
            _ => Err(Error::SizeMismatch { expected: (width.saturating_sub(corner.0), size.1), got: size }),
        }
    }
}

impl<P> LineFilter for CropLines<P> {
    type Input = P;
    type Output = P;

    const LATENCY: usize = 0;

    fn push(&mut self, line: &[P], sink: &mut impl LineSink<P>) -> Result<(), Error> {
        check_width(self.width, line.len())?;
        if (self.lines.0..self.lines.1).contains(&self.y) {
            sink.line(&line[self.columns.0..self.columns.1]);
        }
        self.y = self.y.saturating_add(1);
        Ok(())
    }

    fn finish(&mut self, _: &mut impl LineSink<P>) {
        self.y = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::run;

    const PICTURE: &[u8; 6] = b"abcdef";

    fn drawn(change: impl FnOnce(&mut ImageMut<'_, u8>)) -> [u8; 6] {
        let mut pixels = *PICTURE;
        change(&mut ImageMut::new(&mut pixels, 3, 2).unwrap());
        pixels
    }

    #[test]
    fn flips_and_half_turns() {
        assert_eq!(&drawn(flip_horizontal), b"cbafed");
        assert_eq!(&drawn(flip_vertical), b"defabc");
        assert_eq!(&drawn(rotate_180), b"fedcba");
    }

    #[test]
    fn quarter_turns() {
        let from = Image::new(PICTURE, 3, 2).unwrap();
        let mut pixels = [0; 6];
        rotate_90(from, &mut ImageMut::new(&mut pixels, 2, 3).unwrap()).unwrap();
        assert_eq!(&pixels, b"daebfc");
        rotate_270(from, &mut ImageMut::new(&mut pixels, 2, 3).unwrap()).unwrap();
        assert_eq!(&pixels, b"cfbead");
        assert_eq!(
            rotate_90(from, &mut ImageMut::new(&mut pixels, 3, 2).unwrap()),
            Err(Error::SizeMismatch { expected: (2, 3), got: (3, 2) })
        );
    }

    #[test]
    fn turns_larger_than_a_tile_undo_each_other() {
        let pixels: Vec<u16> = (0..70 * 45).collect();
        let from = Image::new(&pixels, 70, 45).unwrap();
        let (mut turned, mut back) = (vec![0; pixels.len()], vec![0; pixels.len()]);
        let mut turned = ImageMut::new(&mut turned, 45, 70).unwrap();
        rotate_90(from, &mut turned).unwrap();
        assert_eq!(turned.as_image().pixel(44 - 3, 5), from.pixel(5, 3));
        rotate_270(turned.as_image(), &mut ImageMut::new(&mut back, 70, 45).unwrap()).unwrap();
        assert_eq!(back, pixels);
    }

    #[test]
    fn lines_as_they_come() {
        let (mut line, mut out) = ([0; 3], [0; 6]);
        let from = Image::new(PICTURE, 3, 2).unwrap();
        run(&mut MirrorLines::new(&mut line).unwrap(), from, &mut ImageMut::new(&mut out, 3, 2).unwrap())
            .unwrap();
        assert_eq!(&out, b"cbafed");
        let mut crop = CropLines::new(3, (1, 1), (2, 1)).unwrap();
        for _ in 0..2 {
            run(&mut crop, from, &mut ImageMut::new(&mut out, 2, 1).unwrap()).unwrap();
            assert_eq!(&out[..2], b"ef");
        }
        assert!(CropLines::<u8>::new(3, (2, 0), (2, 1)).is_err());
        assert!(CropLines::<u8>::new(3, (usize::MAX, 0), (2, 1)).is_err());
        assert!(CropLines::<u8>::new(3, (0, 0), (0, 1)).is_err());
    }
}
