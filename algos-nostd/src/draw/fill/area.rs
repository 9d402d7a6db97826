use crate::clip::{Point, Window};
use crate::image::ImageMut;

/// An area to be filled: pixels that are in it until they are painted.
///
/// Columns and lines run from 0 to 32,767 at most.
pub(super) trait Area {
    /// Columns and lines.
    fn size(&self) -> (i32, i32);

    /// Whether the pixel exists, belongs to the area and is not painted yet.
    fn has(&self, x: i32, y: i32) -> bool;

    /// From `x` on, the first column that [`has`](Self::has) not, at most the width. `x` may be the width.
    fn run_end(&self, x: i32, y: i32) -> i32;

    /// Before `x`, the first column of the pixels that it has without a gap; `x` if there is none.
    fn run_start(&self, x: i32, y: i32) -> i32;

    /// Paints the columns from `start` to before `end`, which it has.
    fn paint(&mut self, start: i32, end: i32, y: i32);
}

/// The pixels of one colour, painted in another one.
pub(super) struct OneColor<'a, 'b, P> {
    image: &'a mut ImageMut<'b, P>,
    size: (i32, i32),
    old: P,
    new: P,
}

impl<'a, 'b, P: Copy + PartialEq> OneColor<'a, 'b, P> {
    /// The pixels of the seed's colour; `None` if the seed is outside or there is nothing to change.
    pub(super) fn at(image: &'a mut ImageMut<'b, P>, seed: Point, new: P) -> Option<Self> {
        let window = Window::of_mut(image);
        if !window.contains(seed) {
            return None;
        }
        let old = *image.pixel_mut(seed.x as usize, seed.y as usize)?;
        let last = window.bottom_right();
        let size = (i32::from(last.x) + 1, i32::from(last.y) + 1);
        (old != new).then_some(Self { image, size, old, new })
    }

    fn row(&self, y: i32) -> &[P] {
        self.image.as_image().row(y as usize).and_then(|row| row.get(..self.size.0 as usize)).unwrap_or(&[])
    }
}

impl<P: Copy + PartialEq> Area for OneColor<'_, '_, P> {
    fn size(&self) -> (i32, i32) {
        self.size
    }

    #[inline]
    fn has(&self, x: i32, y: i32) -> bool {
        // A negative coordinate is a huge unsigned one.
        self.row(y).get(x as usize).is_some_and(|pixel| *pixel == self.old)
    }

    #[inline]
    fn run_end(&self, x: i32, y: i32) -> i32 {
        let row = self.row(y).get(x as usize..).unwrap_or(&[]);
        x + equal_ahead(row, self.old) as i32
    }

    #[inline]
    fn run_start(&self, x: i32, y: i32) -> i32 {
        let row = self.row(y).get(..x as usize).unwrap_or(&[]);
        x - row.iter().rev().take_while(|pixel| **pixel == self.old).count() as i32
    }

    #[inline]
    fn paint(&mut self, start: i32, end: i32, y: i32) {
        let new = self.new;
        if let Some(run) =
            self.image.row_mut(y as usize).and_then(|row| row.get_mut(start as usize..end as usize))
        {
            run.fill(new);
        }
    }
}

/// Pixels at the front that equal a value. Whole blocks are compared without a branch in between, which the compiler
/// turns into vector comparisons.
fn equal_ahead<P: Copy + PartialEq>(pixels: &[P], value: P) -> usize {
    const BLOCK: usize = 64;
    let (blocks, _) = pixels.as_chunks::<BLOCK>();
    let whole =
        blocks.iter().take_while(|block| block.iter().fold(true, |all, pixel| all & (*pixel == value)));
    let start = whole.count() * BLOCK;
    let rest = pixels.get(start..).unwrap_or(&[]);
    start + rest.iter().take_while(|pixel| **pixel == value).count()
}
