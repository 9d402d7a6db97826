use super::walk::fill_by_walking;
use super::{Area, OneColor};
use crate::clip::Point;
use crate::image::ImageMut;

/// Fills the pixels of the seed's colour that are joined to it, pixel by pixel, the latest found first. Returns how
/// many were filled. Equals [`flood_fill`](super::flood_fill).
///
/// ```text
///   4            a pixel is painted when it is found and then waits
/// 3 s 1   ···    on the stack until its neighbours are looked at
///   2
/// ```
///
/// Reference: the textbook's recursive fill with its stack made explicit (Foley, van Dam et al., "Computer Graphics",
/// 19.5). What the stack cannot hold is filled by [walking](super::flood_fill_walk).
///
/// Cost: four look-ups a pixel. Memory: `pending`, one point a pixel of the area at worst.
pub fn flood_fill_stack<P: Copy + PartialEq>(
    image: &mut ImageMut<'_, P>,
    seed: Point,
    color: P,
    pending: &mut [Point],
) -> usize {
    let Some(mut area) = OneColor::at(image, seed, color) else { return 0 };
    let (mut length, mut filled) = (0, 0);
    let mut found = [(i32::from(seed.x), i32::from(seed.y)); 4];
    loop {
        for (x, y) in found {
            if !area.has(x, y) {
                continue;
            }
            if let Some(place) = pending.get_mut(length) {
                area.paint(x, x + 1, y);
                filled += 1;
                *place = Point::new(x as i16, y as i16);
                length += 1;
            } else {
                filled += fill_by_walking(&mut area, x, y);
            }
        }
        let Some(last) = length.checked_sub(1) else { return filled };
        length = last;
        found = pending.get(last).map_or(found, |&point| neighbours(point));
    }
}

/// Right, below, left and above.
pub(super) fn neighbours(point: Point) -> [(i32, i32); 4] {
    let (x, y) = (i32::from(point.x), i32::from(point.y));
    [(x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)]
}

#[cfg(test)]
mod tests {
    use super::super::super::picture::{Picture, draw_over};
    use super::*;

    #[test]
    fn any_memory_will_do() {
        let plan: Picture<6, 4> = [*b"..#...", *b".#..#.", *b"...##.", *b".#...."];
        let expected = [*b"~~#~~~", *b"~#~~#~", *b"~~~##~", *b"~#~~~~"];
        for memory in 0..18 {
            let filled = draw_over(plan, |image| {
                let pending = &mut [Point::default(); 18][..memory];
                assert_eq!(flood_fill_stack(image, Point::new(4, 3), b'~', pending), 18);
            });
            assert_eq!(filled, expected, "with memory for {memory} points");
        }
    }
}
