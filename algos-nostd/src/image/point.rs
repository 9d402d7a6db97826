/// A pixel by its column and line. `y` grows downwards; either may lie outside of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Point {
    /// Column, in pixels.
    pub x: i16,
    /// Line, in pixels.
    pub y: i16,
}

impl Point {
    /// The pixel in column `x` of line `y`.
    #[must_use]
    pub const fn new(x: i16, y: i16) -> Self {
        Self { x, y }
    }
}
