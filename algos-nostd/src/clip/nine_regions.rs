use super::staircase::{Stair, Staircase};
use super::{Point, Walk, Window};

/// Clips a line to a window by the pair of regions of its ends. Equals [`clip_line`](super::clip_line).
///
/// ```text
///   6 │ 7 │ 8        from 3 to 8: in by the left side, out by the top or the right side
///  ───┼───┼───       from 4 to 4: accept
///   3 │ 4 │ 5        from 0 to 6: reject
///  ───┼───┼───       … 81 pairs, each with its own short way
///   0 │ 1 │ 2
/// ```
///
/// Reference: M. S. Sobkow, P. Pospisil and Y.-H. Yang, "A fast two-dimensional line clipping algorithm via line
/// encoding", Computers & Graphics 11 (4), 1987. We deviate in keeping the 81 cases as a table of the sides that may
/// be crossed, worked out at compile time, rather than as 81 pieces of code; and in the line's own octant, where
/// only 16 pairs are not rejected.
///
/// Cost: a look-up, then one division a side crossed. Memory: 81 bytes of constants.
#[must_use]
pub fn nine_regions(from: Point, to: Point, window: &Window) -> Option<Walk> {
    let line = Staircase::new(from, to, window);
    let region = |step: i32, across: i32| {
        let column = usize::from(step >= line.along_range.0) + usize::from(step > line.along_range.1);
        let row = usize::from(across >= line.across_range.0) + usize::from(across > line.across_range.1);
        row * 3 + column
    };
    let sides = SIDES[region(0, 0)][region(line.major, line.minor)];
    let (near, far) = (line.along_range.0, line.along_range.1);
    let (low, high) = (line.across_range.0, line.across_range.1);
    let entry = match sides & (IN | REJECT) {
        0 => Stair { step: 0, across: 0 },
        IN_LEFT => line.stair_at(near),
        IN_UNDER => line.first_on(low),
        IN => {
            if line.reaches(near, low) {
                line.stair_at(near)
            } else {
                line.first_on(low)
            }
        }
        _ => return None,
    };
    let last = match sides & OUT {
        0 => line.major,
        OUT_RIGHT => far,
        OUT_OVER => line.last_before(high + 1),
        _ => far.min(line.last_before(high + 1)),
    };
    (entry.step <= last).then(|| line.walk(entry, last))
}

const IN_LEFT: u8 = 1;
const IN_UNDER: u8 = 2;
const OUT_RIGHT: u8 = 4;
const OUT_OVER: u8 = 8;
const REJECT: u8 = 16;
/// The bits that tell how a line comes in.
const IN: u8 = IN_LEFT | IN_UNDER;
const OUT: u8 = OUT_RIGHT | OUT_OVER;

/// For the start's and the end's region, the sides that the line may cross.
const SIDES: [[u8; 9]; 9] = {
    let mut sides = [[0; 9]; 9];
    let mut pair = 0;
    while pair < 81 {
        let (from, to) = (pair / 9, pair % 9);
        let ((from_column, from_row), (to_column, to_row)) = ((from % 3, from / 3), (to % 3, to / 3));
        let mut bits = 0;
        if from_column == 0 {
            bits |= IN_LEFT;
        }
        if from_row == 0 {
            bits |= IN_UNDER;
        }
        if to_column == 2 {
            bits |= OUT_RIGHT;
        }
        if to_row == 2 {
            bits |= OUT_OVER;
        }
        // Beyond one side with both ends, or a pair that a line to the right and upwards does not have.
        if to_column == 0 || to_row == 0 || from_column == 2 || from_row == 2 {
            bits = REJECT;
        }
        sides[from][to] = bits;
        pair += 1;
    }
    sides
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_the_cases_of_the_paper() {
        assert_eq!(SIDES[4][4], 0);
        assert_eq!(SIDES[3][8], IN_LEFT | OUT_RIGHT | OUT_OVER);
        assert_eq!(SIDES[0][6], REJECT);
        let crossing = SIDES.as_flattened().iter().filter(|&&sides| sides & REJECT == 0).count();
        assert_eq!(crossing, 16);
    }

    #[test]
    fn a_line_through_two_corners_regions() {
        let window = Window::new(Point::new(5, 5), Point::new(9, 9)).unwrap();
        let (from, to) = (Point::new(1, 14), Point::new(14, 1));
        let clipped = nine_regions(from, to, &window).unwrap();
        assert!(clipped.eq(Walk::new(from, to).filter(|&point| window.contains(point))));
    }
}
