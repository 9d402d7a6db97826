//! Drawing against its definitions.

use algos_nostd::draw::{
    Edge, FillRule, Operator, PendingRun, Point, Premultiplied, Rgba, Walk, Window, draw_circle,
    draw_ellipse, draw_line, draw_line_gupta_sproull, draw_line_runs, draw_line_thick, draw_line_wu,
    fill_ellipse, fill_polygon, flood_fill, flood_fill_queue, flood_fill_stack, flood_fill_walk, fuzzy_fill,
    polygon_edges,
};
use algos_nostd::image::{Image, ImageMut};
use camif_tests::oracle::{clip::line, draw as oracle};
use proptest::prelude::*;
use std::sync::LazyLock;

/// What drawing leaves of zeros.
fn drawn(width: usize, height: usize, drawing: impl FnOnce(&mut ImageMut<'_, u8>)) -> Vec<u8> {
    let mut pixels = vec![0; width * height];
    drawing(&mut ImageMut::new(&mut pixels, width, height).unwrap());
    pixels
}

fn point() -> impl Strategy<Value = Point> {
    (-60i16..120, -60i16..120).prop_map(|(x, y)| Point::new(x, y))
}

/// Mostly near, now and then at the ends of the coordinates.
fn wild_point() -> impl Strategy<Value = Point> {
    prop_oneof![
        3 => point(),
        1 => any::<(i16, i16)>().prop_map(|(x, y)| Point::new(x, y)),
        1 => prop::sample::select(vec![i16::MIN, -1, 0, i16::MAX])
            .prop_flat_map(|x| prop::sample::select(vec![i16::MIN, 0, i16::MAX]).prop_map(move |y| Point::new(x, y))),
    ]
}

/// The cone over a line, of 255, at distances in 1/32 pixels.
static STRENGTHS: LazyLock<Vec<f64>> =
    LazyLock::new(|| (0..=96).map(|d| oracle::cone_over_strip(f64::from(d) / 32.0) * 255.0).collect());

const SIDE: usize = 48;

fn each_pixel() -> impl Iterator<Item = (usize, i64, i64)> {
    (0..SIDE * SIDE).map(|index| (index, (index % SIDE) as i64, (index / SIDE) as i64))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn lines_light_the_rounded_rationals_in_the_picture(from in wild_point(), to in wild_point()) {
        let fast = drawn(SIDE, SIDE, |image| draw_line(image, from, to, 1));
        let runs = drawn(SIDE, SIDE, |image| draw_line_runs(image, from, to, 1));
        let naive = drawn(SIDE, SIDE, |image| {
            for point in line(from, to) {
                if Window::of_mut(image).contains(point) {
                    *image.pixel_mut(point.x as usize, point.y as usize).unwrap() = 1;
                }
            }
        });
        prop_assert!(fast == naive && runs == naive);
    }

    /// Padding between the lines is not drawn on.
    #[test]
    fn nothing_is_drawn_outside(from in wild_point(), to in wild_point(), radius in 0u16..90, width in 0u8..40) {
        let mut pixels = vec![0u8; 40 * 30];
        let mut image = ImageMut::with_stride(&mut pixels, 32, 30, 40).unwrap();
        draw_line(&mut image, from, to, 1);
        draw_line_runs(&mut image, from, to, 1);
        draw_line_thick(&mut image, from, to, width, 1);
        draw_line_wu(&mut image, from, to, 1);
        draw_line_gupta_sproull(&mut image, from, to, 1);
        draw_circle(&mut image, from, radius, 1);
        fill_ellipse(&mut image, to, (radius, 20), 1);
        flood_fill(&mut image, Point::new(31, 29), 2, &mut []);
        prop_assert!(pixels.chunks(40).all(|row| row[32..].iter().all(|&pixel| pixel == 0)));
    }

    #[test]
    fn thick_lines_are_what_is_near_enough(from in point(), to in point(), width in 1u8..30) {
        prop_assume!(from != to);
        let pixels = drawn(SIDE, SIDE, |image| draw_line_thick(image, from, to, width, 1));
        let half = f64::from(width) / 2.0;
        let (_, length) = oracle::from_line(from, to, f64::from(to.x), f64::from(to.y));
        for (index, x, y) in each_pixel() {
            let (distance, along) = oracle::from_line(from, to, x as f64, y as f64);
            let lit = pixels[index] == 1;
            // The ends are square but for the staircase of a line at a right angle.
            if distance.abs() < half - 1e-9 && (1.0..length - 1.0).contains(&along) {
                prop_assert!(lit, "({x}, {y}) is missing");
            }
            if distance.abs() > half + 1e-9 || along < -1.0 || along > length + 1.0 {
                prop_assert!(!lit, "({x}, {y}) is too much");
            }
        }
    }

    #[test]
    fn wu_shares_a_step_between_two_pixels(from in point(), to in point()) {
        let pixels = drawn(SIDE, SIDE, |image| draw_line_wu(image, from, to, 255));
        let (dx, dy) = (f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y));
        let steps = dx.abs().max(dy.abs());
        for (index, x, y) in each_pixel() {
            let (x, y) = (x as f64 - f64::from(from.x), y as f64 - f64::from(from.y));
            let (along, across, slope) =
                if dx.abs() >= dy.abs() { (x * dx.signum(), y, dy) } else { (y * dy.signum(), x, dx) };
            let apart = if steps == 0.0 { across.abs() } else { (across - along * slope / steps).abs() };
            let weight = if (0.0..=steps).contains(&along) { (1.0 - apart).max(0.0) * 255.0 } else { 0.0 };
            prop_assert!((f64::from(pixels[index]) - weight).abs() <= 1.01, "{} for {weight}", pixels[index]);
        }
    }

    #[test]
    fn gupta_sproull_is_a_cone_over_the_line(from in point(), to in point()) {
        prop_assume!(from != to);
        let pixels = drawn(SIDE, SIDE, |image| draw_line_gupta_sproull(image, from, to, 255));
        let level = (i32::from(to.x) - i32::from(from.x)).abs() >= (i32::from(to.y) - i32::from(from.y)).abs();
        for (index, x, y) in each_pixel() {
            let (at, a, b) = if level { (x, from.x, to.x) } else { (y, from.y, to.y) };
            let (distance, _) = oracle::from_line(from, to, x as f64, y as f64);
            // Rounded to 1/32 of a pixel either way; the steepest part of the cone falls by 8 in that.
            let expected = STRENGTHS.get((distance.abs() * 32.0).round() as usize).copied().unwrap_or(0.0);
            let in_range = (i64::from(a.min(b))..=i64::from(a.max(b))).contains(&at);
            let got = f64::from(pixels[index]);
            prop_assert!((got - if in_range { expected } else { 0.0 }).abs() <= 9.0, "{got} for {expected}");
        }
    }

    #[test]
    fn polygons_are_the_points_inside(
        contours in prop::collection::vec(prop::collection::vec(wild_point(), 0..7), 1..4),
    ) {
        let contours: Vec<&[Point]> = contours.iter().map(Vec::as_slice).collect();
        let mut edges = [Edge::default(); polygon_edges(18)];
        for rule in [FillRule::EvenOdd, FillRule::NonZero] {
            let pixels = drawn(SIDE, SIDE, |image| {
                fill_polygon(image, &contours, rule, 1, &mut edges).unwrap();
            });
            for (index, x, y) in each_pixel() {
                let (count, winding) = oracle::crossings(&contours, x, y);
                let inside = match rule {
                    FillRule::EvenOdd => count % 2 != 0,
                    FillRule::NonZero => winding != 0,
                };
                prop_assert_eq!(pixels[index] == 1, inside, "({}, {}) by {:?}", x, y, rule);
            }
        }
    }

    /// Every pixel of the outline is nearest to the curve in its column or in its line, but for one of a quarter where
    /// both parts join; no column or line is left out, and it is symmetric.
    #[test]
    fn ellipses_are_the_nearest_pixels(a in 0u16..23, b in 0u16..23) {
        let pixels = drawn(SIDE, SIDE, |image| draw_ellipse(image, Point::new(23, 23), (a, b), 1));
        let lit = |x: i64, y: i64| pixels[(y + 23) as usize * SIDE + (x + 23) as usize] == 1;
        let (wide, high) = (i64::from(a), i64::from(b));
        // Four times b²x² + a²y² − a²b², from doubled coordinates.
        let outside = |x2: i64, y2: i64| high * high * x2 * x2 + wide * wide * y2 * y2 - 4 * wide * wide * high * high;
        let mut beside = 0;
        for (x, y) in (-22..23).flat_map(|x| (-22..23).map(move |y| (x, y))).filter(|&(x, y)| lit(x, y)) {
            prop_assert!(lit(-x, y) && lit(x, -y));
            let (x2, y2) = (2 * x.abs(), 2 * y.abs());
            let in_column = outside(x2, (y2 - 1).max(0)) <= 0 && outside(x2, y2 + 1) >= 0;
            let in_line = outside((x2 - 1).max(0), y2) <= 0 && outside(x2 + 1, y2) >= 0;
            let tip = y == 0 && x.abs() <= wide;
            if !(in_column || in_line || tip) && x >= 0 && y >= 0 {
                beside += 1;
            }
        }
        prop_assert!(beside <= 1, "{beside} pixels of a quarter are not nearest");
        for x in 0..=wide {
            prop_assert!((0..=high).any(|y| lit(x, y)), "column {x}");
        }
        for y in 0..=high {
            prop_assert!((0..=wide).any(|x| lit(x, y)), "line {y}");
        }
        prop_assert!(lit(wide, 0) && lit(0, high));
    }

    #[test]
    fn fills_are_what_is_joined(
        pixels in prop::collection::vec(prop::bool::weighted(0.38), 24 * 17),
        seed in (0usize..24, 0usize..17),
        memory in 0usize..40,
    ) {
        let pixels: Vec<u8> = pixels.into_iter().map(u8::from).collect();
        let joined = oracle::joined(&pixels, 24, seed);
        let expected: Vec<u8> = pixels.iter().zip(&joined).map(|(&old, &new)| if new { 9 } else { old }).collect();
        let count = joined.iter().filter(|&&joined| joined).count();
        let at = Point::new(seed.0 as i16, seed.1 as i16);
        let mut runs = vec![PendingRun::default(); memory];
        let mut points = vec![Point::default(); memory];
        let filled = |fill: &mut dyn FnMut(&mut ImageMut<'_, u8>) -> usize| {
            let mut pixels = pixels.clone();
            let count = fill(&mut ImageMut::new(&mut pixels, 24, 17).unwrap());
            (pixels, count)
        };
        let expected = (expected, count);
        prop_assert_eq!(&filled(&mut |image| flood_fill(image, at, 9, &mut runs)), &expected);
        prop_assert_eq!(&filled(&mut |image| flood_fill_stack(image, at, 9, &mut points)), &expected);
        prop_assert_eq!(&filled(&mut |image| flood_fill_queue(image, at, 9, &mut points)), &expected);
        prop_assert_eq!(&filled(&mut |image| flood_fill_walk(image, at, 9)), &expected);
    }

    #[test]
    fn fuzzy_fills_are_what_is_joined_and_similar(
        pixels in prop::collection::vec(0u8..60, 20 * 15),
        seed in (0usize..20, 0usize..15),
        (tolerance, softness) in (0u8..30, 0u8..12),
    ) {
        let color = pixels[seed.1 * 20 + seed.0];
        let apart = |pixel: u8| f64::from(pixel.abs_diff(color)) - f64::from(tolerance);
        let alpha = |pixel| 255.0 * (1.0 - apart(pixel) / (f64::from(softness) + 1.0)).clamp(0.0, 1.0);
        let similar: Vec<bool> = pixels.iter().map(|&pixel| alpha(pixel) > 0.0).collect();
        let joined = oracle::joined(&similar, 20, seed);
        let mut mask = vec![0; 20 * 15];
        let mut view = ImageMut::new(&mut mask, 20, 15).unwrap();
        let at = Point::new(seed.0 as i16, seed.1 as i16);
        let mut runs = [PendingRun::default(); 3];
        fuzzy_fill(Image::new(&pixels, 20, 15).unwrap(), at, (tolerance, softness), &mut view, &mut runs).unwrap();
        for (index, &got) in mask.iter().enumerate() {
            let expected = if joined[index] { alpha(pixels[index]) } else { 0.0 };
            prop_assert!((f64::from(got) - expected).abs() <= 0.5 + 1e-9);
        }
    }

    #[test]
    fn straight_compositing_is_the_rounded_quotient(
        source in any::<[u8; 4]>(),
        destination in any::<[u8; 4]>(),
        operator in prop::sample::select(Operator::ALL.to_vec()),
    ) {
        let part = |value: u8| f64::from(value) / 255.0;
        let rgba = |[r, g, b, a]: [u8; 4]| Rgba { r, g, b, a };
        let got = operator.straight(rgba(source), rgba(destination));
        for (channel, got_color) in [got.r, got.g, got.b].into_iter().enumerate() {
            let multiplied = |pixel: [u8; 4]| (part(pixel[channel]) * part(pixel[3]), part(pixel[3]));
            let (color, alpha) = oracle::premultiplied(operator, multiplied(source), multiplied(destination));
            prop_assert!((f64::from(got.a) - alpha * 255.0).abs() <= 0.5 + 1e-9);
            let expected = if got.a == 0 { 0.0 } else { color / alpha * 255.0 };
            prop_assert!((f64::from(got_color) - expected).abs() <= 0.5 + 1e-6, "{got:?} for {expected}");
        }
    }
}

/// Mazes with loops are the hard case for the walk.
#[test]
fn walking_through_mazes() {
    let mut state = 7u64;
    for openness in [2, 4, 10, 30] {
        let mut pixels = vec![1u8; 41 * 41];
        for y in 0..41 {
            for x in 0..41 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let gap = (state >> 33).is_multiple_of(openness);
                if (x % 2 == 0 && y % 2 == 0) || ((x + y) % 2 == 1 && !gap) {
                    pixels[y * 41 + x] = 0;
                }
            }
        }
        let joined = oracle::joined(&pixels, 41, (0, 0));
        let mut image = ImageMut::new(&mut pixels, 41, 41).unwrap();
        let count = flood_fill_walk(&mut image, Point::new(0, 0), 9);
        assert_eq!(count, joined.iter().filter(|&&joined| joined).count());
        assert!(pixels.iter().zip(&joined).all(|(&pixel, &joined)| joined == (pixel == 9)));
    }
}

#[test]
fn circles_are_the_nearest_pixels() {
    for radius in 0..60u16 {
        let pixels = drawn(128, 128, |image| draw_circle(image, Point::new(64, 64), radius, 1));
        for (index, &pixel) in pixels.iter().enumerate() {
            let (x, y) = ((index % 128) as i64 - 64, (index / 128) as i64 - 64);
            let (near, far) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
            // In the eighth: (far − ½)² ≤ radius² − near² < (far + ½)², four times.
            let left = 4 * (i64::from(radius).pow(2) - near * near);
            let nearest = (2 * far - 1).max(0).pow(2) <= left && left < (2 * far + 1).pow(2);
            // The eighth ends at the diagonal; its last pixel may be one beyond, seen from the other eighth.
            assert_eq!(pixel == 1, nearest, "({x}, {y}) at radius {radius}");
        }
    }
}

/// Every pair of colours and alphas of a premultiplied channel that matter, against fractions.
#[test]
fn premultiplied_compositing_is_rounded_once() {
    let levels: Vec<u8> = (0..=255).step_by(15).chain([1, 2, 127, 128, 254]).collect();
    let pixel = |color: u8, a: u8| Premultiplied::from_multiplied(Rgba { r: color, g: 0, b: 0, a });
    let part = |value: u8| f64::from(value) / 255.0;
    for operator in Operator::ALL {
        for (&sa, &da) in levels.iter().flat_map(|s| levels.iter().map(move |d| (s, d))) {
            for s in levels.iter().copied().filter(|&s| s <= sa) {
                for d in levels.iter().copied().filter(|&d| d <= da) {
                    let got = operator.premultiplied(pixel(s, sa), pixel(d, da)).multiplied();
                    let (color, alpha) =
                        oracle::premultiplied(operator, (part(s), part(sa)), (part(d), part(da)));
                    for (got, exact) in [(got.r, color), (got.a, alpha)] {
                        assert!(
                            (f64::from(got) - exact * 255.0).abs() <= 0.5 + 1e-9,
                            "{operator:?} {s} {sa} {d} {da}"
                        );
                    }
                }
            }
        }
    }
}

/// Three layers from the left and from the right: the same but for rounding, by two at most.
#[test]
fn associative_within_two() {
    let levels: Vec<u8> = (0..=255).step_by(17).chain([1, 85, 127, 128, 200, 254]).collect();
    let pixels: Vec<Premultiplied> = levels
        .iter()
        .flat_map(|&a| levels.iter().filter(move |&&r| r <= a).map(move |&r| Rgba { r, g: 0, b: a, a }))
        .map(Premultiplied::from_multiplied)
        .collect();
    let operators = [
        (Operator::SourceOver, 2),
        (Operator::DestinationOver, 2),
        (Operator::SourceIn, 2),
        (Operator::DestinationIn, 2),
        (Operator::Plus, 0),
        (Operator::Source, 0),
        (Operator::Destination, 0),
        (Operator::Clear, 0),
    ];
    for (operator, bound) in operators {
        let mut worst = 0;
        for &a in pixels.iter().step_by(3) {
            for &b in pixels.iter().step_by(2) {
                let ab = operator.premultiplied(a, b);
                for &c in pixels.iter().step_by(5) {
                    let left = operator.premultiplied(ab, c).multiplied();
                    let right = operator.premultiplied(a, operator.premultiplied(b, c)).multiplied();
                    worst = worst.max(left.r.abs_diff(right.r)).max(left.a.abs_diff(right.a));
                    if [a, b, c].iter().all(|pixel| matches!(pixel.multiplied().a, 0 | 255)) {
                        assert_eq!(left.a, right.a);
                    }
                }
            }
        }
        assert!(worst <= bound, "{operator:?} differs by {worst}");
    }
}

#[test]
fn the_whole_plane_in_one_stroke() {
    // Ends of the coordinates in everything at once; nothing may overflow.
    let far = [i16::MIN, 0, i16::MAX];
    let corners: Vec<Point> = far.iter().flat_map(|&x| far.map(|y| Point::new(x, y))).collect();
    let mut edges = [Edge::default(); 16];
    let _ = drawn(16, 16, |image| {
        for &from in &corners {
            for &to in &corners {
                draw_line_thick(image, from, to, 255, 1);
                draw_line_wu(image, from, to, 1);
                draw_line_gupta_sproull(image, from, to, 1);
                draw_line_runs(image, from, to, 1);
            }
            draw_circle(image, from, u16::MAX, 1);
            draw_ellipse(image, from, (u16::MAX, u16::MAX), 1);
            fill_ellipse(image, from, (u16::MAX, 1), 1);
        }
        fill_polygon(image, &[&corners], FillRule::NonZero, 1, &mut edges).unwrap();
    });
    assert_eq!(Walk::new(corners[0], corners[8]).len(), 65_536);
}
