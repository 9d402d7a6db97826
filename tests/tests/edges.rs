//! Edges: the fast code against the definitions.

use algos_nostd::edges::gradient::{CentralDifference, Prewitt, Roberts, Scharr, Sobel};
use algos_nostd::edges::measure::{Components, L1, L2, Saturated, Sector4, Sector8};
use algos_nostd::edges::smooth::{Gaussian3, Gaussian5, NoSmoothing, Smoothing};
use algos_nostd::edges::{
    self, BitMap, BitMapMut, CannyConfig, CannySmoothing, Gradient, GradientFilter, Measure, Norm, Operator,
    Point, Thinning, Thresholds, ZeroCrossings,
};
use algos_nostd::image::{Error, Image};
use algos_nostd::lines::LineFilter;
use camif_tests::oracle::edges::{self as oracle, Plane};
use proptest::prelude::*;

/// Odd sizes, and such that a line ends within, at and just past a word.
const SIZES: [(usize, usize); 12] =
    [(1, 1), (1, 2), (2, 1), (2, 2), (1, 9), (9, 1), (3, 3), (31, 5), (32, 4), (33, 6), (65, 3), (100, 40)];

fn random(seed: u64) -> impl FnMut() -> u32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as u32
    }
}

fn noise(width: usize, height: usize, seed: u64) -> Plane<u8> {
    let mut random = random(seed);
    Plane { pixels: (0..width * height).map(|_| (random() >> 7) as u8).collect(), width }
}

/// A picture with the statistics of a photograph: leaves of all sizes that hide one another, shaded, out of focus a little,
/// under noise.
fn photograph(width: usize, height: usize, seed: u64) -> Plane<u8> {
    let mut random = random(seed);
    let mut level = vec![f64::NAN; width * height];
    let mut empty = level.len();
    // From the front backwards, until nothing is bare.
    while empty > 0 {
        let size = 4.0 / (0.02 + f64::from(random() % 1000) / 1000.0);
        let (cx, cy) = (f64::from(random() % width as u32), f64::from(random() % height as u32));
        let (gray, tilt, turn) =
            (random() % 200, f64::from(random() % 100) / 100.0, f64::from(random() % 314) / 100.0);
        let (from, to) = ((cy - size).max(0.0) as usize, (cy + size + 1.0).min(height as f64) as usize);
        for y in from..to {
            for x in (cx - size).max(0.0) as usize..(cx + size + 1.0).min(width as f64) as usize {
                let (dx, dy) = (x as f64 - cx, y as f64 - cy);
                let (u, v) = (dx * turn.cos() + dy * turn.sin(), dy * turn.cos() - dx * turn.sin());
                let pixel = &mut level[y * width + x];
                if pixel.is_nan() && u * u + v * v * (1.0 + 3.0 * tilt) < size * size {
                    *pixel = 25.0 + f64::from(gray) + 25.0 * tilt * u / size;
                    empty -= 1;
                }
            }
        }
    }
    let blurred = oracle::correlate(&Plane { pixels: level, width }, &oracle::GAUSSIAN_3);
    let pixels = blurred.pixels.iter().map(|sum| {
        let noise = f64::from((random() >> 3) % 64 + random() % 64) / 16.0 - 4.0;
        (sum / 16.0 + noise).round().clamp(0.0, 255.0) as u8
    });
    Plane { pixels: pixels.collect(), width }
}

fn bits(plane: &Plane<bool>) -> Vec<u32> {
    let mut words = vec![0; edges::words_a_map(plane.width, plane.height())];
    let mut map = BitMapMut::new(&mut words, plane.width, plane.height()).unwrap();
    for (i, &set) in plane.pixels.iter().enumerate() {
        map.set(i % plane.width, i / plane.width, set);
    }
    words
}

fn plane(words: &[u32], width: usize, height: usize) -> Plane<bool> {
    let map = BitMap::new(words, width, height).unwrap();
    Plane { pixels: (0..width * height).map(|i| map.get(i % width, i / width)).collect(), width }
}

fn canny(picture: &Plane<u8>, smoothing: CannySmoothing, norm: Norm, low: u16, high: u16) -> Plane<bool> {
    let (width, height) = (picture.width, picture.height());
    let config = CannyConfig { smoothing, thresholds: Thresholds { low, high, norm } };
    let mut memory = vec![u32::MAX; edges::canny_memory(width, height, smoothing)];
    let mut words = vec![u32::MAX; edges::words_a_map(width, height)];
    let image = Image::new(&picture.pixels, width, height).unwrap();
    edges::canny(image, &config, &mut memory, &mut BitMapMut::new(&mut words, width, height).unwrap())
        .unwrap();
    plane(&words, width, height)
}

#[test]
fn canny_agrees_with_the_textbook() {
    for seed in 1..=4 {
        let picture = photograph(640, 480, seed);
        let expected = oracle::canny(&picture, &oracle::GAUSSIAN_5, true, 50.0, 150.0);
        let made = canny(&picture, CannySmoothing::Gaussian5, Norm::L2, 50, 150);
        let edges = expected.pixels.iter().filter(|&&edge| edge).count();
        assert!((5_000..60_000).contains(&edges), "{edges} edge pixels are not a photograph's");
        let f1 = oracle::agreement(&made, &expected);
        println!("picture {seed}: {edges} edge pixels, F1 {f1:.4}");
        assert!(f1 >= 0.98, "picture {seed}: F1 {f1:.4}");
    }
}

#[test]
fn canny_agrees_with_the_textbook_on_photographs() {
    for name in ["astronaut", "chelsea", "coffee", "rocket"] {
        let path = format!("{}/data/photographs/{name}.png", env!("CARGO_MANIFEST_DIR"));
        let photograph = image::open(path).unwrap().into_luma8();
        let picture = Plane { width: photograph.width() as usize, pixels: photograph.into_raw() };
        let expected = oracle::canny(&picture, &oracle::GAUSSIAN_5, true, 50.0, 150.0);
        let f1 = oracle::agreement(&canny(&picture, CannySmoothing::Gaussian5, Norm::L2, 50, 150), &expected);
        println!("{name}: F1 {f1:.4}");
        assert!(f1 >= 0.98, "{name}: F1 {f1:.4}");
    }
}

#[test]
fn canny_is_the_definition_where_nothing_is_rounded() {
    for (case, (width, height)) in SIZES.into_iter().enumerate() {
        for (picture, name) in
            [(noise(width, height, case as u64), "noise"), (photograph(width, height, 9), "leaves")]
        {
            for norm in [Norm::L1, Norm::L2] {
                for (low, high) in [(0, 0), (40, 90), (100, 300), (65535, 65535)] {
                    let kernels: [(CannySmoothing, &[&[i32]]); 2] =
                        [(CannySmoothing::None, &[&[1]]), (CannySmoothing::Gaussian3, &oracle::GAUSSIAN_3)];
                    for (smoothing, kernel) in kernels {
                        let expected = oracle::canny(
                            &picture,
                            kernel,
                            norm == Norm::L2,
                            f64::from(low),
                            f64::from(high),
                        );
                        let made = canny(&picture, smoothing, norm, low, high);
                        assert!(
                            made == expected,
                            "{name} {width} × {height} {smoothing:?} {norm:?} {low} {high}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn canny_takes_a_part_of_a_picture() {
    let picture = photograph(90, 50, 3);
    let whole = Image::new(&picture.pixels, 90, 50).unwrap();
    let part = whole.crop(7, 3, 70, 40).unwrap();
    let copy = Plane { pixels: part.rows().flatten().copied().collect(), width: 70 };
    let config = CannyConfig::default();
    let mut memory = vec![0; edges::canny_memory(70, 40, config.smoothing)];
    let mut words = vec![0; edges::words_a_map(70, 40)];
    edges::canny(part, &config, &mut memory, &mut BitMapMut::new(&mut words, 70, 40).unwrap()).unwrap();
    assert_eq!(plane(&words, 70, 40), canny(&copy, config.smoothing, Norm::L2, 50, 150));
}

#[test]
fn canny_at_vga_fits_128_kib() {
    let words = edges::canny_memory(640, 480, CannySmoothing::Gaussian5) + edges::words_a_map(640, 480);
    assert!(words * 4 <= 128 * 1024, "{} bytes", words * 4);
    println!("{} bytes", words * 4);
}

#[test]
fn canny_refuses_bad_parameters() {
    let pixels = [0; 12];
    let image = Image::new(&pixels, 4, 3).unwrap();
    let try_canny = |low, high, memory: usize, (width, height): (usize, usize)| {
        let thresholds = Thresholds { low, high, norm: Norm::L1 };
        let config = CannyConfig { smoothing: CannySmoothing::Gaussian5, thresholds };
        let mut words = vec![7; edges::words_a_map(width, height)];
        let mut map = BitMapMut::new(&mut words, width, height).unwrap();
        let error = edges::canny(image, &config, &mut vec![0; memory], &mut map).unwrap_err();
        assert!(words.iter().all(|&word| word == 7), "the map is as it was");
        error
    };
    let enough = edges::canny_memory(4, 3, CannySmoothing::Gaussian5);
    assert_eq!(
        try_canny(9, 8, enough, (4, 3)),
        Error::Parameter { name: "low", got: 9, allowed: "at most `high`" }
    );
    assert_eq!(try_canny(8, 9, enough, (3, 4)), Error::SizeMismatch { expected: (4, 3), got: (3, 4) });
    let short = Error::BufferLength { name: "memory", expected: enough, got: enough - 1 };
    assert_eq!(try_canny(8, 9, enough - 1, (4, 3)), short);
}

fn filtered<F: LineFilter>(mut filter: F, picture: &Plane<F::Input>) -> Vec<F::Output>
where
    F::Output: Copy,
{
    let mut made = Vec::new();
    let mut sink = |line: &[F::Output]| made.extend_from_slice(line);
    for row in picture.pixels.chunks(picture.width) {
        filter.push(row, &mut sink).unwrap();
    }
    filter.finish(&mut sink);
    made
}

fn measured<O: Operator, M: Measure>(picture: &Plane<u8>) -> Vec<M::Output>
where
    M::Output: Default,
{
    let mut memory = vec![0; GradientFilter::<O, M>::memory(picture.width)];
    let mut line = vec![M::Output::default(); picture.width];
    filtered(GradientFilter::<O, M>::new(picture.width, &mut memory, &mut line).unwrap(), picture)
}

fn check_operator<O: Operator>(picture: &Plane<u8>, x: [&[i32]; 3], y: [&[i32]; 3]) {
    let float = oracle::float(picture);
    let (x, y) = (oracle::correlate(&float, &x), oracle::correlate(&float, &y));
    let expected: Vec<(f64, f64)> = x.pixels.iter().copied().zip(y.pixels.iter().copied()).collect();
    let pairs: Vec<Gradient> = measured::<O, Components>(picture);
    assert!(pairs.iter().map(|pair| (f64::from(pair.x), f64::from(pair.y))).eq(expected.iter().copied()));
    let l1 = measured::<O, L1>(picture);
    assert!(l1.iter().map(|&sum| f64::from(sum)).eq(expected.iter().map(|(x, y)| x.abs() + y.abs())));
    let l2 = measured::<O, L2>(picture);
    assert!(
        l2.iter()
            .map(|&root| f64::from(root))
            .eq(expected.iter().map(|(x, y)| (x * x + y * y).sqrt().floor()))
    );
    let saturated = measured::<O, Saturated<L1>>(picture);
    assert!(saturated.iter().zip(&l1).all(|(&byte, &sum)| u16::from(byte) == sum.min(255)));
    let sector = |sectors: i64| {
        expected
            .iter()
            .map(move |(x, y)| (y.atan2(*x).to_degrees() / 45.0).round().rem_euclid(sectors as f64) as u8)
    };
    assert!(measured::<O, Sector8>(picture).into_iter().eq(sector(8)));
    assert!(measured::<O, Sector4>(picture).into_iter().eq(sector(4)));
}

#[test]
fn gradients_are_the_kernels() {
    for (case, (width, height)) in SIZES.into_iter().enumerate() {
        let picture = noise(width, height, 77 + case as u64);
        check_operator::<CentralDifference>(
            &picture,
            [&[0, 0, 0], &[-1, 0, 1], &[0, 0, 0]],
            [&[0, -1, 0], &[0, 0, 0], &[0, 1, 0]],
        );
        check_operator::<Roberts>(
            &picture,
            [&[0, 0, 0], &[0, -1, 0], &[0, 0, 1]],
            [&[0, 0, 0], &[0, 0, -1], &[0, 1, 0]],
        );
        check_operator::<Prewitt>(
            &picture,
            [&[-1, 0, 1], &[-1, 0, 1], &[-1, 0, 1]],
            [&[-1, -1, -1], &[0, 0, 0], &[1, 1, 1]],
        );
        check_operator::<Sobel>(&picture, oracle::SOBEL_X, oracle::SOBEL_Y);
        check_operator::<Scharr>(
            &picture,
            [&[-3, 0, 3], &[-10, 0, 10], &[-3, 0, 3]],
            [&[-3, -10, -3], &[0, 0, 0], &[3, 10, 3]],
        );
    }
}

#[test]
fn zero_crossings_are_the_definition() {
    fn check<S: Smoothing>(picture: &Plane<u8>, kernel: &[&[i32]], threshold: u16) {
        let (width, height) = (picture.width, picture.height());
        let mut memory = vec![u32::MAX; ZeroCrossings::<S>::memory(width)];
        let words = filtered(ZeroCrossings::<S>::new(width, threshold, &mut memory).unwrap(), picture);
        // The smoothing's own scale, its fraction cut off there.
        let weight = f64::from(kernel.iter().flat_map(|row| row.iter()).sum::<i32>());
        let scale = f64::from(S::SCALE.0) / f64::from(S::SCALE.1);
        let sums = oracle::correlate(&oracle::float(picture), kernel);
        let smooth = sums.map(|x, y| (sums.nearest(x, y) * scale / weight).floor());
        let expected = oracle::zero_crossings(&smooth, scale, f64::from(threshold));
        assert!(plane(&words, width, height) == expected, "{width} × {height}, {threshold}");
    }
    for (case, (width, height)) in SIZES.into_iter().enumerate() {
        for picture in [noise(width, height, case as u64), photograph(width, height, 5)] {
            for threshold in [0, 7, 100] {
                check::<NoSmoothing>(&picture, &[&[1]], threshold);
                check::<Gaussian3>(&picture, &oracle::GAUSSIAN_3, threshold);
                check::<Gaussian5>(&picture, &oracle::GAUSSIAN_5, threshold);
            }
        }
    }
}

/// A definition of thinning.
type Rule = fn(&Plane<bool>) -> Plane<bool>;

/// Blots: noise, more or less of it set.
fn blots(width: usize, height: usize, seed: u64, per_cent: u32) -> Plane<bool> {
    let mut random = random(seed);
    Plane { pixels: (0..width * height).map(|_| (random() >> 8) % 100 < per_cent).collect(), width }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn hysteresis_is_the_flood(
        (width, height) in (1usize..120, 1usize..60), seed in any::<u64>(), dense in 20u32..80, sparse in 0u32..5,
    ) {
        let candidates = blots(width, height, seed, dense);
        let mut strong = blots(width, height, !seed, sparse);
        strong.pixels.iter_mut().zip(&candidates.pixels).for_each(|(strong, candidate)| *strong &= candidate);
        let mut words = bits(&strong);
        let candidate_words = bits(&candidates);
        let map = BitMap::new(&candidate_words, width, height).unwrap();
        edges::grow(map, &mut BitMapMut::new(&mut words, width, height).unwrap()).unwrap();
        prop_assert!(plane(&words, width, height) == oracle::hysteresis(&candidates, &strong));
    }

    #[test]
    fn thinning_is_the_definition(
        (width, height) in (1usize..80, 1usize..40), seed in any::<u64>(), dense in 30u32..95,
    ) {
        let map = blots(width, height, seed, dense);
        let rules: [(Thinning, Rule); 3] = [
            (Thinning::ZhangSuen, oracle::zhang_suen),
            (Thinning::GuoHall, oracle::guo_hall),
            (Thinning::FourSides, oracle::four_sides),
        ];
        for (thinning, rule) in rules {
            let mut words = bits(&map);
            let mut memory = vec![u32::MAX; edges::thin_memory(width)];
            let mut made = BitMapMut::new(&mut words, width, height).unwrap();
            edges::thin(&mut made, thinning, &mut memory).unwrap();
            prop_assert!(plane(&words, width, height) == rule(&map), "{:?}", thinning);
        }
    }

    #[test]
    fn every_edge_pixel_is_on_a_curve(
        (width, height) in (1usize..80, 1usize..40), seed in any::<u64>(), dense in 1u32..60, room in 2usize..40,
    ) {
        let map = blots(width, height, seed, dense);
        let words = bits(&map);
        let mut rest = vec![0; words.len()];
        let mut room = vec![Point::default(); room];
        let mut reached = map.map(|_, _| false);
        let mut faults = 0;
        let mut last = None;
        let sink = &mut |curve: edges::Curve<'_>| {
            for pair in curve.points.windows(2) {
                let near = pair[0].x.abs_diff(pair[1].x).max(pair[0].y.abs_diff(pair[1].y)) == 1;
                faults += usize::from(!near);
            }
            faults += usize::from(curve.continued && Some(curve.points[0]) != last);
            last = curve.points.last().copied();
            for point in curve.points.iter() {
                reached.pixels[point.y as usize * width + point.x as usize] = true;
            }
        };
        let edges_map = BitMap::new(&words, width, height).unwrap();
        edges::trace(edges_map, &mut BitMapMut::new(&mut rest, width, height).unwrap(), &mut room, sink).unwrap();
        prop_assert_eq!(faults, 0, "points of a curve are neighbours");
        prop_assert!(reached == map);
    }

    #[test]
    fn simplification_is_the_recursion(
        points in prop_oneof![
            prop::collection::vec((-60i16..60, -60i16..60), 0..200),
            prop::collection::vec((any::<i16>(), any::<i16>()), 0..60),
            prop::collection::vec(((-1i16..2), (-1i16..2)), 0..400).prop_map(|steps| {
                steps.iter().scan((0, 0), |at, step| { *at = (at.0 + step.0, at.1 + step.1); Some(*at) }).collect()
            }),
        ],
        tolerance in prop_oneof![Just(0u32), 0u32..2000, any::<u32>()],
    ) {
        let expected: Vec<_> = oracle::simplify(&points, tolerance).into_iter().map(|i| points[i]).collect();
        let mut made: Vec<Point> = points.iter().map(|&(x, y)| Point { x, y }).collect();
        let mut memory = vec![u32::MAX; edges::simplify_memory(made.len())];
        let kept = edges::simplify(&mut made, tolerance, &mut memory).unwrap();
        prop_assert!(made[..kept].iter().map(|point| (point.x, point.y)).eq(expected));
    }
}
