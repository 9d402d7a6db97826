//! The line seen from its own octant.
//!
//! ```text
//! across
//!   2 │         ■ ■        step     0 1 2 3 4 5 6
//!   1 │     ■ ■            across   0 0 1 1 2 2 …
//!   0 │ ■ ■                the ideal line is at step × minor / major
//!     └──────────── along = step
//! ```
//!
//! Turned and mirrored such that it runs from (0, 0) to (`major`, `minor`), 0 ≤ `minor` ≤ `major`, a line takes one
//! step along for each pixel and is, at step *s*, `ceil(s·minor/major − ½)` pixels across: the nearest pixel, and of
//! two equally near ones that on the start's side. Hence *k* across is reached when 2·*s*·`minor` > (2*k* − 1)·`major`.
//! The window is turned and mirrored with the line. All clipping is arithmetic on these two lines of text.

use super::{Direction, Point, Walk, Window};

/// A line and a window in the line's own octant. Lengths in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Staircase {
    pub(super) start: Point,
    /// Steps from the first pixel to the last, 0 to 65,535.
    pub(super) major: i32,
    /// Pixels across from the first to the last, 0 to `major`.
    pub(super) minor: i32,
    /// Whether along is up or down.
    steep: bool,
    /// +1 or −1: to the right or left, down or up.
    sign_x: i32,
    sign_y: i32,
    /// First and last step whose pixel's coordinate along is in the window.
    pub(super) along_range: (i32, i32),
    /// The least and the most pixels across that are in the window.
    pub(super) across_range: (i32, i32),
}

/// A pixel of the staircase: its step, and its pixels across.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stair {
    pub(super) step: i32,
    pub(super) across: i32,
}

impl Staircase {
    #[inline]
    pub(super) fn new(from: Point, to: Point, window: &Window) -> Self {
        use core::hint::select_unpredictable as select;
        let (x, y) = (i32::from(from.x), i32::from(from.y));
        let (dx, dy) = (i32::from(to.x) - x, i32::from(to.y) - y);
        let (left, right) = (i32::from(window.left) - x, i32::from(window.right) - x);
        let (top, bottom) = (i32::from(window.top) - y, i32::from(window.bottom) - y);
        // Mirrored for lines to the left and upwards, turned for steep ones; directions are coin tosses to a
        // branch predictor, so nothing here branches.
        let (leftwards, upwards) = (dx < 0, dy < 0);
        let columns = (select(leftwards, -right, left), select(leftwards, -left, right));
        let lines = (select(upwards, -bottom, top), select(upwards, -top, bottom));
        let (dx_size, dy_size) = (dx.abs(), dy.abs());
        let steep = dy_size > dx_size;
        Self {
            start: from,
            major: dx_size.max(dy_size),
            minor: dx_size.min(dy_size),
            steep,
            sign_x: 1 - 2 * i32::from(leftwards),
            sign_y: 1 - 2 * i32::from(upwards),
            along_range: (select(steep, lines.0, columns.0), select(steep, lines.1, columns.1)),
            across_range: (select(steep, columns.0, lines.0), select(steep, columns.1, lines.1)),
        }
    }

    /// Whether both ends are beyond the same side of the window; see [`Window::misses`].
    #[inline]
    pub(super) fn misses(&self) -> bool {
        // One sign of four differences: a single branch.
        (self.along_range.1
            | self.across_range.1
            | (self.major - self.along_range.0)
            | (self.minor - self.across_range.0))
            < 0
    }

    /// Whether the line is `across` pixels across, or more, at a step. Takes 0 ≤ `step`, `across` ≤ 65,536.
    #[inline]
    pub(super) fn reaches(&self, step: i32, across: i32) -> bool {
        // 2·step·minor > (2·across − 1)·major, halved; 2³² is out of reach of neither product nor of their difference
        // in 64 bits, which a Cortex-M multiplies in one instruction.
        i64::from(step) * i64::from(self.minor)
            > i64::from(across) * i64::from(self.major) - i64::from(self.half_up())
    }

    /// Pixels across at a step between 0 and `major`.
    #[inline]
    pub(super) fn across_at(&self, step: i32) -> i32 {
        // At most 65,535² + 32,767: fits 32 bits.
        let doubled_half = step as u32 * self.minor as u32 + (self.major.max(1) as u32 - 1) / 2;
        doubled_half.checked_div(self.major as u32).unwrap_or(0) as i32
    }

    /// The last step that is less than `across` pixels across, 1 ≤ `across` ≤ `minor` + 1; `major` if none is more.
    #[inline]
    pub(super) fn last_before(&self, across: i32) -> i32 {
        // At most 65,536 × 65,535: fits 32 bits.
        let reach = (across as u32 * self.major as u32).wrapping_sub(self.half_up() as u32);
        reach.checked_div(self.minor as u32).map_or(self.major, |step| (step as i32).min(self.major))
    }

    /// The pixel at a step between 0 and `major`.
    #[inline]
    pub(super) fn stair_at(&self, step: i32) -> Stair {
        Stair { step, across: self.across_at(step) }
    }

    /// The first pixel that is `across` pixels across, 0 ≤ `across` ≤ `minor`.
    #[inline]
    pub(super) fn first_on(&self, across: i32) -> Stair {
        Stair { step: if across <= 0 { 0 } else { self.last_before(across) + 1 }, across }
    }

    #[inline]
    pub(super) fn half_up(&self) -> i32 {
        (self.major + 1) / 2
    }

    /// Where a pixel of the line is: within the line's bounding box, so within `i16`.
    #[inline]
    fn pixel(&self, stair: Stair) -> Point {
        let columns = core::hint::select_unpredictable(self.steep, stair.across, stair.step);
        let lines = stair.step + stair.across - columns;
        Point::new(
            (i32::from(self.start.x) + self.sign_x * columns) as i16,
            (i32::from(self.start.y) + self.sign_y * lines) as i16,
        )
    }

    /// What one step along and one across adds to a pixel's coordinates.
    #[inline]
    pub(super) fn directions(&self) -> (Direction, Direction) {
        let horizontal = Direction { x: self.sign_x as i16, y: 0 };
        let vertical = Direction { x: 0, y: self.sign_y as i16 };
        (
            core::hint::select_unpredictable(self.steep, vertical, horizontal),
            core::hint::select_unpredictable(self.steep, horizontal, vertical),
        )
    }

    /// The walk from a pixel to the last step given, which must not be before it.
    #[inline]
    pub(super) fn walk(&self, entry: Stair, last_step: i32) -> Walk {
        // Both products may wrap; the difference is less than ±2¹⁸, so what is left of it is right.
        let error = (2 * self.minor)
            .wrapping_mul(entry.step + 1)
            .wrapping_sub(self.major.wrapping_mul(2 * entry.across + 1));
        let (along, across) = self.directions();
        Walk {
            next: self.pixel(entry),
            left: (last_step - entry.step + 1) as u32,
            error,
            major: self.major,
            minor: self.minor,
            along,
            across,
        }
    }
}
