use super::stack::neighbours;
use super::walk::fill_by_walking;
use super::{Area, OneColor};
use crate::clip::Point;
use crate::image::ImageMut;

/// Fills the pixels of the seed's colour that are joined to it, pixel by pixel, the nearest to the seed first. Returns
/// how many were filled. Equals [`flood_fill`](super::flood_fill).
///
/// ```text
///     2
///   2 1 2        a ring around the seed waits in the queue,
/// 2 1 s 1 2      which is far shorter than a stack
///   2 1 2
///     2
/// ```
///
/// Reference: breadth-first search (E. F. Moore, 1959). What the queue cannot hold is filled by
/// [walking](super::flood_fill_walk).
///
/// Cost: four look-ups a pixel. Memory: `pending`, in open areas as many points as the area's width and height
/// together.
pub fn flood_fill_queue<P: Copy + PartialEq>(
    image: &mut ImageMut<'_, P>,
    seed: Point,
    color: P,
    pending: &mut [Point],
) -> usize {
    let Some(mut area) = OneColor::at(image, seed, color) else { return 0 };
    // A ring buffer: `length` points from `first` on.
    let (mut first, mut length, mut filled) = (0, 0, 0);
    let capacity = pending.len();
    let around = |index: usize| if index >= capacity { index - capacity } else { index };
    let mut found = [(i32::from(seed.x), i32::from(seed.y)); 4];
    loop {
        for (x, y) in found {
            if !area.has(x, y) {
                continue;
            }
            if length < capacity
                && let Some(place) = pending.get_mut(around(first + length))
            {
                area.paint(x, x + 1, y);
                filled += 1;
                *place = Point::new(x as i16, y as i16);
                length += 1;
            } else {
                filled += fill_by_walking(&mut area, x, y);
            }
        }
        if length == 0 {
            return filled;
        }
        found = pending.get(first).map_or(found, |&point| neighbours(point));
        first = around(first + 1);
        length -= 1;
    }
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
                assert_eq!(flood_fill_queue(image, Point::new(4, 3), b'~', pending), 18);
            });
            assert_eq!(filled, expected, "with memory for {memory} points");
        }
    }
}
