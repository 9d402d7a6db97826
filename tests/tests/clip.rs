//! The clippers against pixels left out of whole lines, and against one another.

use algos_nostd::clip::{
    ConvexWindow, Point, Walk, Window, clip_line, clip_lines, clipped_polygon_capacity, cohen_sutherland,
    cyrus_beck, liang_barsky, nicholl_lee_nicholl, nine_regions, sutherland_hodgman,
};
use camif_tests::oracle::clip as oracle;
use proptest::prelude::*;

type Clipper = fn(Point, Point, &Window) -> Option<Walk>;

const CLIPPERS: [(&str, Clipper); 6] = [
    ("clip_line", clip_line),
    ("cohen_sutherland", cohen_sutherland),
    ("liang_barsky", liang_barsky),
    ("cyrus_beck", cyrus_beck_of_rectangle),
    ("nicholl_lee_nicholl", nicholl_lee_nicholl),
    ("nine_regions", nine_regions),
];

fn cyrus_beck_of_rectangle(from: Point, to: Point, window: &Window) -> Option<Walk> {
    let (a, c) = (window.top_left(), window.bottom_right());
    let corners = [a, Point::new(c.x, a.y), c, Point::new(a.x, c.y)];
    match ConvexWindow::new(&corners) {
        Ok(convex) => cyrus_beck(from, to, &convex),
        // A rectangle of one pixel's width has no corners that differ: nothing to compare.
        Err(_) => clip_line(from, to, window),
    }
}

/// The same numbers each time (Knuth's MMIX constants).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (((self.0 >> 32) * u64::from(limit)) >> 32) as u32
    }

    fn between(&mut self, low: i16, high: i16) -> i16 {
        let span = (i32::from(high) - i32::from(low) + 1) as u32;
        (i32::from(low) + self.below(span) as i32) as i16
    }

    fn point(&mut self, low: i16, high: i16) -> Point {
        Point::new(self.between(low, high), self.between(low, high))
    }

    fn window(&mut self, low: i16, high: i16) -> Window {
        let (a, b) = (self.point(low, high), self.point(low, high));
        let (left, right) = (a.x.min(b.x), a.x.max(b.x));
        let (top, bottom) = (a.y.min(b.y), a.y.max(b.y));
        Window::new(Point::new(left, top), Point::new(right, bottom)).unwrap()
    }
}

fn all_agree(from: Point, to: Point, window: &Window) -> Option<Walk> {
    let expected = clip_line(from, to, window);
    for (name, clip) in CLIPPERS {
        assert_eq!(clip(from, to, window), expected, "{name}: {from:?} to {to:?} in {window:?}");
    }
    expected
}

fn is_exact(from: Point, to: Point, window: &Window) {
    let walk = all_agree(from, to, window);
    let pixels: Vec<_> = walk.clone().into_iter().flatten().collect();
    assert_eq!(pixels, oracle::clipped(from, to, window), "{from:?} to {to:?} in {window:?}");
    assert_eq!(walk.map_or(0, |walk| walk.pixels_left() as usize), pixels.len());
}

#[test]
fn whole_lines_are_rounded_rationals() {
    let mut random = Random(1);
    for _ in 0..20_000 {
        let (from, to) = (random.point(-40, 40), random.point(-40, 40));
        assert!(Walk::new(from, to).eq(oracle::line(from, to)), "{from:?} to {to:?}");
    }
    for _ in 0..20 {
        let (from, to) = (random.point(i16::MIN, i16::MAX), random.point(i16::MIN, i16::MAX));
        assert!(Walk::new(from, to).eq(oracle::line(from, to)), "{from:?} to {to:?}");
    }
}

/// Every segment of a small grid against every window of it: points, parallels, touching corners and all.
#[test]
fn every_small_segment_in_every_small_window() {
    let grid = |size: i16| (0..size).flat_map(move |y| (0..size).map(move |x| Point::new(x, y)));
    for top_left in grid(3) {
        for size in grid(3) {
            let bottom_right = Point::new(top_left.x + size.x + 1, top_left.y + size.y + 1);
            let window = Window::new(top_left, bottom_right).unwrap();
            for from in grid(7) {
                for to in grid(7) {
                    is_exact(from, to, &window);
                }
            }
        }
    }
}

#[test]
fn clipped_lines_are_whole_lines_less_the_pixels_outside() {
    let mut random = Random(2);
    for _ in 0..60_000 {
        let window = random.window(-30, 30);
        is_exact(random.point(-60, 60), random.point(-60, 60), &window);
    }
}

#[test]
fn the_ends_of_the_coordinates() {
    let values = [i16::MIN, i16::MIN + 1, -16_384, -1, 0, 1, 16_383, i16::MAX - 1, i16::MAX];
    let points: Vec<_> = values.iter().flat_map(|&x| values.map(|y| Point::new(x, y))).collect();
    let windows = [
        Window::new(Point::new(0, 0), Point::new(639, 479)).unwrap(),
        Window::new(Point::new(i16::MIN, i16::MIN), Point::new(i16::MAX, i16::MAX)).unwrap(),
        Window::new(Point::new(i16::MAX - 1, i16::MIN), Point::new(i16::MAX, i16::MAX)).unwrap(),
        Window::new(Point::new(-2, i16::MIN), Point::new(1, i16::MIN + 1)).unwrap(),
        Window::new(Point::new(i16::MAX, i16::MAX), Point::new(i16::MAX, i16::MAX)).unwrap(),
    ];
    for window in &windows {
        for &from in &points {
            for &to in &points {
                let walk = all_agree(from, to, window);
                // The naive line is long; where little of it is outside, the first and the last pixel tell.
                let Some(mut walk) = walk else { continue };
                let whole = Walk::new(from, to);
                if whole.len() - walk.len() < 700 {
                    let mut inside = whole.filter(|&point| window.contains(point));
                    assert_eq!(inside.next(), walk.next());
                    assert_eq!(inside.last(), walk.last());
                }
            }
        }
    }
}

#[test]
fn long_lines_are_exact() {
    let mut random = Random(3);
    let window = Window::new(Point::new(0, 0), Point::new(639, 479)).unwrap();
    let mut seen = 0;
    for _ in 0..400 {
        let (from, to) = (random.point(i16::MIN, i16::MAX), random.point(i16::MIN, i16::MAX));
        is_exact(from, to, &window);
        // Through the window, which random ends rarely do.
        let (from, to) = (Point::new(from.x, -from.y.saturating_abs()), Point::new(319 - from.x / 2, 20_000));
        is_exact(from, to, &window);
        seen += usize::from(clip_line(from, to, &window).is_some());
    }
    assert!(seen > 10, "only {seen} of the lines were seen");
}

#[test]
fn all_agree_on_random_segments() {
    let mut random = Random(4);
    let mut seen = 0;
    for round in 0..2_000_000 {
        let (low, high) = [(-100, 100), (-2_000, 2_000), (i16::MIN, i16::MAX)][round % 3];
        let window = random.window(low, high);
        let (from, mut to) = (random.point(low, high), random.point(low, high));
        match random.below(8) {
            0 => to.x = from.x,
            1 => to.y = from.y,
            2 => to = Point::new(window.bottom_right().x, window.top_left().y),
            _ => {}
        }
        seen += usize::from(all_agree(from, to, &window).is_some());
    }
    assert!(seen > 400_000, "only {seen} of the lines were seen");
}

#[test]
fn many_at_once_are_one_by_one() {
    let mut random = Random(5);
    let window = Window::new(Point::new(-50, -20), Point::new(60, 70)).unwrap();
    for count in [0, 1, 63, 64, 65, 1000] {
        let lines: Vec<_> = (0..count).map(|_| (random.point(-200, 200), random.point(-200, 200))).collect();
        let mut many = Vec::new();
        clip_lines(&lines, &window, |index, walk| many.push((index, walk)));
        let single = lines.iter().map(|&(from, to)| clip_line(from, to, &window)).enumerate();
        let single: Vec<_> = single.filter_map(|(index, walk)| Some((index, walk?))).collect();
        assert_eq!(many, single);
    }
}

#[test]
fn convex_windows_of_any_shape() {
    let mut random = Random(6);
    let mut tried = 0;
    while tried < 20_000 {
        let count = 3 + random.below(3) as usize;
        let corners: Vec<_> = (0..count).map(|_| random.point(-20, 20)).collect();
        let Ok(window) = ConvexWindow::new(&corners) else { continue };
        tried += 1;
        let (from, to) = (random.point(-40, 40), random.point(-40, 40));
        let pixels: Vec<_> = cyrus_beck(from, to, &window).into_iter().flatten().collect();
        assert_eq!(pixels, oracle::clipped_convex(from, to, &corners), "{from:?} to {to:?} in {corners:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// The parts of a line in the four quarters of a window are together the line's part in the window.
    #[test]
    fn parts_meet(
        ends in any::<[i16; 4]>(),
        (left, width, right) in (-500i16..500, 0i16..300, 1i16..300),
        (top, height, bottom) in (-500i16..500, 0i16..300, 1i16..300),
    ) {
        let (from, to) = (Point::new(ends[0], ends[1]), Point::new(ends[2], ends[3]));
        let columns = [(left, left + width), (left + width + 1, left + width + right)];
        let lines = [(top, top + height), (top + height + 1, top + height + bottom)];
        let pixels = |(left, right), (top, bottom)| {
            let window = Window::new(Point::new(left, top), Point::new(right, bottom)).unwrap();
            clip_line(from, to, &window).map_or(0, |walk| walk.len())
        };
        let parts: usize = columns.iter().flat_map(|&c| lines.map(|l| pixels(c, l))).sum();
        prop_assert_eq!(parts, pixels((columns[0].0, columns[1].1), (lines[0].0, lines[1].1)));
    }

    /// A convex polygon's area is shared out between the two halves of a window, up to rounded corners; all corners
    /// are in the window; and twice is as good as once.
    #[test]
    fn polygons_keep_their_area(corners in prop::collection::vec(any::<[i8; 2]>(), 3..8), split in -60i16..60) {
        let corners: Vec<_> =
            corners.iter().map(|&[x, y]| Point::new(i16::from(x), i16::from(y))).collect();
        let mut area = 0;
        for (left, right) in [(-200, split), (split, 200)] {
            let window = Window::new(Point::new(left, -200), Point::new(right, 200)).unwrap();
            let mut memory = vec![Point::default(); clipped_polygon_capacity(corners.len())];
            let part = sutherland_hodgman(&corners, &window, &mut memory).unwrap();
            prop_assert!(part.iter().all(|&point| window.contains(point)));
            let mut again = vec![Point::default(); clipped_polygon_capacity(part.len())];
            prop_assert_eq!(sutherland_hodgman(part, &window, &mut again).unwrap(), part);
            area += oracle::doubled_area(part);
        }
        let whole = oracle::doubled_area(&corners);
        // Each corner may move by half a pixel along a window's side, and sides are at most 256 long.
        prop_assert!((area - whole).abs() <= 256 * corners.len() as i64, "{} against {}", area, whole);
    }
}
