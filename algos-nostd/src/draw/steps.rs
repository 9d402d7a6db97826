//! A line's steps along its longer side, for lines that light several pixels a step.

use crate::clip::{Direction, Point, Walk};
use crate::image::ImageMut;

/// The steps of a line that are in the picture's columns (or lines, if it is steep). Across is not clipped here.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    start: (i32, i32),
    /// Lengths of the sides; the longer one is 1 at least, so that it can be divided by.
    pub(super) major: u32,
    pub(super) minor: u32,
    along: Direction,
    across: Direction,
    /// First step, and the one behind the last.
    pub(super) first: u32,
    pub(super) end: u32,
}

impl Steps {
    pub(super) fn new<P>(from: Point, to: Point, image: &ImageMut<'_, P>) -> Self {
        let walk = Walk::new(from, to);
        let (major, minor) = walk.sides();
        let (along, across) = walk.directions();
        let start = (i32::from(from.x), i32::from(from.y));
        let size = |length: usize| i32::try_from(length).unwrap_or(i32::MAX);
        let (at, limit, forwards) = if along.x != 0 {
            (start.0, size(image.width()), along.x > 0)
        } else {
            (start.1, size(image.height()), along.y > 0)
        };
        // Coordinates 0 to limit − 1, as steps.
        let (first, last) = if forwards { (-at, limit - 1 - at) } else { (at - (limit - 1), at) };
        Self {
            start,
            major: major.max(1) as u32,
            minor: minor as u32,
            along,
            across,
            first: first.max(0) as u32,
            end: (last.min(major) + 1).max(0) as u32,
        }
    }

    /// Where the pixel is that is so many steps along and so many pixels across.
    #[inline]
    pub(super) fn pixel(&self, step: i32, across: i32) -> (i32, i32) {
        let wide = |direction: Direction| (i32::from(direction.x), i32::from(direction.y));
        let (along, sideways) = (wide(self.along), wide(self.across));
        (
            self.start.0 + step * along.0 + across * sideways.0,
            self.start.1 + step * along.1 + across * sideways.1,
        )
    }

    /// Whether along is to the right or left.
    pub(super) fn is_level(&self) -> bool {
        self.along.x != 0
    }
}
