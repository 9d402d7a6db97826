use core::hint::select_unpredictable as select;

use super::staircase::{Stair, Staircase};
use super::{Point, Walk, Window};

/// Clips a line to a window: the state of Bresenham's algorithm at the first pixel inside, or `None`.
///
/// ```text
///   ╱│          │       misses: both ends beyond one side     no division
///    ┌──────────┐       fits: both ends inside                no division
///    │    ╱     │       enters by the side along: one division finds how far across
///  ──┼─╱        │       enters across:            one division finds the step
///    └──────────┘
/// ```
///
/// Where the line enters, one comparison of products tells which of the two near sides it crosses; one division then
/// gives the pixel, whichever it is. Another one gives the last step. Ends, octants and sides are selected, not
/// branched upon: random lines would make the branch predictor miss, which costs more than a division.
///
/// Reference: Y. P. Kuzmin, "Bresenham's line generation algorithm with built-in clipping", Computer Graphics Forum
/// 14 (5), 1995. We deviate in the selection instead of branches, and in treating all sides in one octant.
///
/// Cost: no division for a line that misses or fits, else two of 32 bits. Memory: none.
#[must_use]
#[inline]
pub fn clip_line(from: Point, to: Point, window: &Window) -> Option<Walk> {
    if window.misses(from, to) {
        return None;
    }
    clip_near(from, to, window)
}

/// Clips many lines: hands on the index and the walk of each that is seen in the window, in order.
///
/// Equals [`clip_line`] one by one, but the lines that miss are sorted out beforehand, 64 at a time and without a branch,
/// so that the processor does not guess wrongly at every other one of them.
///
/// Cost: as [`clip_line`]. Memory: 64 bytes of stack.
pub fn clip_lines(lines: &[(Point, Point)], window: &Window, mut seen: impl FnMut(usize, Walk)) {
    for (block, start) in lines.chunks(BLOCK).zip((0..).step_by(BLOCK)) {
        let mut near = [0u8; BLOCK];
        let mut count = 0;
        for (&(from, to), index) in block.iter().zip(0..) {
            near[count % BLOCK] = index;
            count += usize::from(!window.misses(from, to));
        }
        for &index in near.iter().take(count) {
            if let Some(&(from, to)) = block.get(usize::from(index))
                && let Some(walk) = clip_near(from, to, window)
            {
                seen(start + usize::from(index), walk);
            }
        }
    }
}

const BLOCK: usize = 64;

/// For lines that do not lie beyond one side with both ends.
#[inline]
fn clip_near(from: Point, to: Point, window: &Window) -> Option<Walk> {
    if window.contains_both(from, to) {
        return Some(Walk::new(from, to));
    }
    let line = Staircase::new(from, to, window);
    // From here on the line is longer than a pixel, for a single pixel either misses or fits.
    let (major, minor) = (i64::from(line.major), i64::from(line.minor));
    let (near_along, near_across) = (line.along_range.0.max(0), line.across_range.0.max(0));
    let (far_along, far_across) = (line.along_range.1.min(line.major), line.across_range.1.min(line.minor));
    // `Staircase::reaches` for the four corners is a comparison of two of these.
    let (near_rise, far_rise) = (i64::from(near_along) * minor, i64::from(far_along) * minor);
    let half = i64::from(line.half_up());
    let low = i64::from(near_across) * major - half;
    let high = i64::from(far_across + 1) * major - half;
    // Above the window when it comes, or below it still when it goes: past a corner.
    if ((high - near_rise) | (far_rise - low - 1)) < 0 {
        return None;
    }
    // Comes in over the near side if it is far enough across there; else when it is far enough across. All the
    // dividends are from 0 to below 2³² here; see `across_at` and `last_before`.
    let by_side = near_rise > low;
    let dividend = select(by_side, near_rise as u32 + (line.major as u32 - 1) / 2, low as u32);
    let divisor = select(by_side, line.major, line.minor) as u32;
    let quotient = dividend.checked_div(divisor)? as i32;
    let entry = Stair {
        step: select(by_side, near_along, quotient + 1),
        across: select(by_side, quotient, near_across),
    };
    let last =
        (high as u32).checked_div(line.minor as u32).map_or(far_along, |step| (step as i32).min(far_along));
    // Fails only between the pixels of a corner.
    (entry.step <= last).then(|| line.walk(entry, last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipped_line_goes_on_as_the_whole_one() {
        // . . . . . . . . .     the whole line, and in the window (3, 1) to (6, 3) the part that is asked for
        // ■ ■ ┌───────┐
        //     ■ ■ ■   │
        //     │     ■ ■ ■
        let (from, to) = (Point::new(0, 0), Point::new(9, 3));
        let window = Window::new(Point::new(3, 1), Point::new(6, 3)).unwrap();
        let clipped = clip_line(from, to, &window).unwrap();
        let whole = Walk::new(from, to).filter(|&point| window.contains(point));
        assert!(clipped.eq(whole));
    }

    #[test]
    fn a_line_between_the_pixels_of_a_corner_misses() {
        // The ideal line crosses the corner of the pixel (1, 1), yet lights only (0, 1), (1, 2) beside it.
        let window = Window::new(Point::new(1, 1), Point::new(1, 1)).unwrap();
        assert_eq!(clip_line(Point::new(0, 1), Point::new(3, 4), &window), None);
    }
}
