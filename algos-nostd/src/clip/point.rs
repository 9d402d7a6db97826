use crate::image::{Error, Image, ImageMut, Point};

/// A rectangle of pixels, all four sides included; it holds one pixel at least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    pub(super) left: i16,
    pub(super) top: i16,
    pub(super) right: i16,
    pub(super) bottom: i16,
}

impl Window {
    /// From the top left pixel to the bottom right one, both included.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the bottom right pixel is left of or above the other.
    pub const fn new(top_left: Point, bottom_right: Point) -> Result<Self, Error> {
        if bottom_right.x < top_left.x {
            return Err(Error::Parameter {
                name: "bottom_right.x",
                got: bottom_right.x as i64,
                allowed: "not less than `top_left.x`",
            });
        }
        if bottom_right.y < top_left.y {
            return Err(Error::Parameter {
                name: "bottom_right.y",
                got: bottom_right.y as i64,
                allowed: "not less than `top_left.y`",
            });
        }
        Ok(Self { left: top_left.x, top: top_left.y, right: bottom_right.x, bottom: bottom_right.y })
    }

    /// All pixels of a picture that an `i16` reaches: columns and lines from 0 to 32,767 at most.
    #[must_use]
    pub fn of<P>(image: &Image<'_, P>) -> Self {
        Self::of_size(image.width(), image.height())
    }

    /// The same of a picture to be written to.
    #[must_use]
    pub fn of_mut<P>(image: &ImageMut<'_, P>) -> Self {
        Self::of_size(image.width(), image.height())
    }

    /// No side is zero: the views have seen to it.
    fn of_size(width: usize, height: usize) -> Self {
        let last = |size: usize| i16::try_from(size - 1).unwrap_or(i16::MAX);
        Self { left: 0, top: 0, right: last(width), bottom: last(height) }
    }

    /// The top left pixel.
    #[must_use]
    pub const fn top_left(&self) -> Point {
        Point::new(self.left, self.top)
    }

    /// The bottom right pixel, which still belongs to the window.
    #[must_use]
    pub const fn bottom_right(&self) -> Point {
        Point::new(self.right, self.bottom)
    }

    /// Whether the pixel is in the window.
    #[must_use]
    pub const fn contains(&self, point: Point) -> bool {
        self.left <= point.x && point.x <= self.right && self.top <= point.y && point.y <= self.bottom
    }

    /// Whether both points, and with them all between them, are in the window.
    #[inline]
    pub(super) fn contains_both(&self, a: Point, b: Point) -> bool {
        let wide = |value: i16| i32::from(value);
        ((wide(a.x.min(b.x)) - wide(self.left))
            | (wide(self.right) - wide(a.x.max(b.x)))
            | (wide(a.y.min(b.y)) - wide(self.top))
            | (wide(self.bottom) - wide(a.y.max(b.y))))
            >= 0
    }

    /// Whether both points are beyond the same side, so that nothing between them is in the window.
    #[inline]
    pub(super) fn misses(&self, a: Point, b: Point) -> bool {
        let wide = |value: i16| i32::from(value);
        // One sign of four differences: a single branch.
        ((wide(a.x.max(b.x)) - wide(self.left))
            | (wide(self.right) - wide(a.x.min(b.x)))
            | (wide(a.y.max(b.y)) - wide(self.top))
            | (wide(self.bottom) - wide(a.y.min(b.y))))
            < 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_holds_its_sides_and_is_never_empty() {
        let one = Window::new(Point::new(3, -4), Point::new(3, -4)).unwrap();
        assert!(one.contains(Point::new(3, -4)) && !one.contains(Point::new(4, -4)));
        assert!(Window::new(Point::new(3, 0), Point::new(2, 9)).is_err());
        assert!(Window::new(Point::new(3, 1), Point::new(5, 0)).is_err());
    }

    #[test]
    fn a_wide_picture_ends_where_coordinates_end() {
        let pixels = [0u8; 40_000];
        let window = Window::of(&Image::new(&pixels, 40_000, 1).unwrap());
        assert_eq!(window.bottom_right(), Point::new(i16::MAX, 0));
    }
}
