//! Lines and polygons cut at a window.

use algos_nostd::clip::{
    ConvexWindow, Point, Walk, Window, clip_line, clip_lines, cohen_sutherland, cyrus_beck, liang_barsky,
    nicholl_lee_nicholl, nine_regions, sutherland_hodgman,
};
use algos_nostd::image::Error;

use crate::report::{Clock, Done, Exercise, Unit, Unit::Segment};
use crate::space::{SEGMENTS, WIDTH, Workspace};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise {
        name: "clip kuzmin",
        unit: Segment,
        run: |s, c| clipped(s, c, |a, b| clip_line(a, b, &WINDOW)),
    },
    Exercise { name: "clip kuzmin, many at once", unit: Segment, run: many },
    Exercise {
        name: "clip cohen-sutherland",
        unit: Segment,
        run: |s, c| clipped(s, c, |a, b| cohen_sutherland(a, b, &WINDOW)),
    },
    Exercise {
        name: "clip liang-barsky",
        unit: Segment,
        run: |s, c| clipped(s, c, |a, b| liang_barsky(a, b, &WINDOW)),
    },
    Exercise {
        name: "clip nicholl-lee-nicholl",
        unit: Segment,
        run: |s, c| clipped(s, c, |a, b| nicholl_lee_nicholl(a, b, &WINDOW)),
    },
    Exercise {
        name: "clip nine regions",
        unit: Segment,
        run: |s, c| clipped(s, c, |a, b| nine_regions(a, b, &WINDOW)),
    },
    Exercise { name: "clip cyrus-beck, hexagon", unit: Segment, run: hexagon },
    Exercise { name: "clip sutherland-hodgman", unit: Unit::Point, run: polygon },
];

const WINDOW: Window = match Window::new(Point::new(0, 0), Point::new(WIDTH as i16 - 1, 239)) {
    Ok(window) => window,
    Err(_) => panic!("the window's corners are in order"),
};

/// Where a walk begins, and how long it is.
fn tell(walk: Option<Walk>) -> [i64; 3] {
    walk.map_or([-1; 3], |walk| {
        let at = walk.position();
        [i64::from(at.x), i64::from(at.y), i64::from(walk.pixels_left())]
    })
}

fn clipped(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    clip: impl Fn(Point, Point) -> Option<Walk>,
) -> Result<Done, Error> {
    let mut sum = [0_i64; 3];
    clock.start();
    for (index, &(from, to)) in space.segments.iter().enumerate() {
        for (sum, value) in sum.iter_mut().zip(tell(clip(from, to))) {
            *sum += value * (index as i64 + 1);
        }
    }
    clock.stop();
    Ok(Done::of(SEGMENTS, |results| results.numbers(sum)))
}

fn many(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let mut sum = [0_i64; 3];
    clock.start();
    clip_lines(&space.segments, &WINDOW, |index, walk| {
        for (sum, value) in sum.iter_mut().zip(tell(Some(walk))) {
            *sum += value * (index as i64 + 1);
        }
    });
    clock.stop();
    Ok(Done::of(SEGMENTS, |results| results.numbers(sum)))
}

fn hexagon(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let corners = [(160, 10), (280, 60), (280, 180), (160, 230), (40, 180), (40, 60)];
    let corners = corners.map(|(x, y)| Point::new(x, y));
    let window = ConvexWindow::new(&corners)?;
    clipped(space, clock, |from, to| cyrus_beck(from, to, &window))
}

/// The ends of segments as corners of a polygon that crosses itself.
fn polygon(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    const CORNERS: usize = 128;
    let (corners, room) = space.points.split_at_mut(CORNERS);
    for (corner, segment) in corners.iter_mut().zip(&space.segments) {
        *corner = segment.0;
    }
    clock.start();
    let clipped = sutherland_hodgman(corners, &WINDOW, room)?;
    clock.stop();
    let numbers = clipped.iter().flat_map(|point| [i64::from(point.x), i64::from(point.y)]);
    Ok(Done::of(CORNERS, |results| results.numbers(numbers)))
}
