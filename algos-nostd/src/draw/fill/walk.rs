use super::{Area, OneColor};
use crate::clip::Point;
use crate::image::ImageMut;

/// Fills the pixels of the seed's colour that are joined to it without any memory: a painter walks with the right hand
/// on the wall and never paints himself into a corner. Returns how many were filled. Equals
/// [`flood_fill`](super::flood_fill).
///
/// ```text
/// █ █ █ █ █ █     A pixel is painted when what is left stays joined without it. Its eight
/// █ 1 2 3 4 █     neighbours mostly tell (2, 3 …). In a corridor (c) they do not: he walks on,
/// █ ·   █ 5 █     and comes to the corridor's dead end, which can be painted; if he comes back
/// █ · c c 6 █     to where he started instead, the corridors run in a ring, and he looks for a
/// █ █ █ █ █ █     pixel at which to open it.
/// ```
///
/// To see whether a pixel is part of a ring, take it for a wall: if its neighbours are then met on one walk along that
/// wall, they are joined, because the wall's side in an area is one closed curve. On the outermost wall there always is
/// such a pixel; if a whole round finds none, the wall was that of an island, and he goes straight up from its
/// top to the next wall.
///
/// Reference: D. Henrich, "Space-efficient region filling in raster graphics", The Visual Computer 10, 1994. We
/// deviate in opening rings by the test above instead of by marks.
///
/// Cost: some 20 look-ups a pixel in open areas; a ring of *n* pixels costs up to *n* rounds. Memory: none.
pub fn flood_fill_walk<P: Copy + PartialEq>(image: &mut ImageMut<'_, P>, seed: Point, color: P) -> usize {
    OneColor::at(image, seed, color)
        .map_or(0, |mut area| fill_by_walking(&mut area, i32::from(seed.x), i32::from(seed.y)))
}

/// The same for the part of any area that is joined to a pixel it has.
pub(super) fn fill_by_walking(area: &mut impl Area, x: i32, y: i32) -> usize {
    if !area.has(x, y) {
        return 0;
    }
    let mut filled = 0;
    let mut round = Round::from_wall_above(area, Cell { x, y });
    loop {
        let at = round.at;
        let may_paint = stays_joined_nearby(area, at.cell)
            || (round.look_for_rings && stays_joined_all_around(area, at.cell));
        if may_paint {
            area.paint(at.cell.x, at.cell.x + 1, at.cell.y);
            filled += 1;
            // Straight on, if he can. The pixel just painted is the wall at his back.
            let ahead = at.wall + 3;
            let Some(way) = (ahead..ahead + 4).find(|&way| area.has_cell(at.cell.next(way))) else {
                return filled;
            };
            round = Round::new(Side { cell: at.cell.next(way), wall: (way + 2) % 4 });
        } else {
            round.at = at.along_the_wall(|cell| area.has_cell(cell));
            round.top = if round.at.cell.y < round.top.y { round.at.cell } else { round.top };
            if round.at == round.start {
                if round.look_for_rings {
                    round = Round::from_wall_above(area, round.top);
                } else {
                    round.look_for_rings = true;
                }
            }
        }
    }
}

/// A pixel's place; may be outside of the picture.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Cell {
    x: i32,
    y: i32,
}

impl Cell {
    /// The neighbour on the right (0), below (1), on the left (2) or above (3); more turns are taken off.
    fn next(self, way: u8) -> Self {
        match way % 4 {
            0 => Self { x: self.x + 1, y: self.y },
            1 => Self { x: self.x, y: self.y + 1 },
            2 => Self { x: self.x - 1, y: self.y },
            _ => Self { x: self.x, y: self.y - 1 },
        }
    }
}

/// A side of a pixel of the area, behind which there is a wall.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Side {
    cell: Cell,
    /// Which way the wall is: on the right hand of who walks along it.
    wall: u8,
}

impl Side {
    /// The next side of the same wall.
    fn along_the_wall(self, has: impl Fn(Cell) -> bool) -> Self {
        let heading = (self.wall + 3) % 4;
        let front = self.cell.next(heading);
        if !has(front) {
            return Self { cell: self.cell, wall: heading };
        }
        let around = front.next(self.wall);
        if has(around) {
            Self { cell: around, wall: (heading + 2) % 4 }
        } else {
            Self { cell: front, ..self }
        }
    }
}

/// One way around a wall.
struct Round {
    start: Side,
    at: Side,
    /// The highest pixel passed.
    top: Cell,
    /// The second time around.
    look_for_rings: bool,
}

impl Round {
    fn new(start: Side) -> Self {
        Self { start, at: start, top: start.cell, look_for_rings: false }
    }

    fn from_wall_above(area: &impl Area, mut cell: Cell) -> Self {
        while area.has_cell(cell.next(3)) {
            cell = cell.next(3);
        }
        Self::new(Side { cell, wall: 3 })
    }
}

trait HasCell: Area {
    fn has_cell(&self, cell: Cell) -> bool {
        self.has(cell.x, cell.y)
    }
}

impl<A: Area> HasCell for A {}

/// Whether the pixels next to one are joined by those around it.
fn stays_joined_nearby(area: &impl Area, cell: Cell) -> bool {
    let sides: [bool; 4] = core::array::from_fn(|way| area.has_cell(cell.next(way as u8)));
    let neighbours = sides.iter().filter(|&&has| has).count();
    let links = (0..4u8)
        .filter(|&way| {
            let turn = (way + 1) % 4;
            sides[usize::from(way)] && sides[usize::from(turn)] && area.has_cell(cell.next(way).next(turn))
        })
        .count();
    neighbours <= links + 1
}

/// Whether the pixels next to one are joined at all without it.
fn stays_joined_all_around(area: &impl Area, cell: Cell) -> bool {
    let has = |other: Cell| other != cell && area.has_cell(other);
    let neighbours = (0..4).filter(|&way| has(cell.next(way)));
    let Some(first) = neighbours.clone().next() else { return true };
    let start = Side { cell: cell.next(first), wall: (first + 2) % 4 };
    let mut at = start;
    let mut met = 0;
    loop {
        if at.cell.next(at.wall) == cell {
            met += 1;
        }
        at = at.along_the_wall(has);
        if at == start {
            return met == neighbours.count();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::picture::{Picture, draw_over};
    use super::*;

    #[test]
    fn rings_islands_and_dead_ends() {
        let plan: Picture<11, 7> = [
            *b"...........", //
            *b".#########.",
            *b".#.......#.",
            *b".#.#####.#.",
            *b".#.#...#.#.",
            *b".#.##.##...",
            *b".#.........",
        ];
        let open = plan.as_flattened().iter().filter(|&&pixel| pixel == b'.').count();
        for (index, _) in plan.as_flattened().iter().enumerate().filter(|(_, pixel)| **pixel == b'.') {
            let filled = draw_over(plan, |image| {
                let seed = Point::new((index % 11) as i16, (index / 11) as i16);
                assert_eq!(flood_fill_walk(image, seed, b'~'), open);
            });
            assert!(!filled.as_flattened().contains(&b'.'));
        }
    }

    #[test]
    fn a_ring_with_spurs_on_its_inner_side_only() {
        let plan: Picture<9, 9> = [
            *b"#########", //
            *b"#.......#",
            *b"#.#.#.#.#",
            *b"#..###..#",
            *b"#.##.##.#",
            *b"#..###..#",
            *b"#.#.#.#.#",
            *b"#.......#",
            *b"#########",
        ];
        let filled = draw_over(plan, |image| {
            flood_fill_walk(image, Point::new(3, 6), b'~');
        });
        assert_eq!(filled[4], *b"#~##.##~#", "the chamber in the middle is closed");
        assert_eq!(filled.as_flattened().iter().filter(|&&pixel| pixel == b'.').count(), 1);
    }
}
