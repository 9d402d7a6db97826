//! Quantization against its oracles.

use algos_nostd::image::{Image, ImageMut, Rgb};
use algos_nostd::lines::{LineFilter, run};
use algos_nostd::quantize::*;
use camif_tests::oracle::quantize as oracle;
use camif_tests::oracle::quantize::{Color, Weighted};
use proptest::collection::vec;
use proptest::prelude::*;

const WIDTH: usize = 48;
const HEIGHT: usize = 36;

fn rgb([r, g, b]: Color) -> Rgb {
    Rgb { r, g, b }
}

fn color(rgb: Rgb) -> Color {
    [rgb.r, rgb.g, rgb.b]
}

fn colors(palette: &[Rgb]) -> Vec<Color> {
    palette.iter().copied().map(color).collect()
}

/// A picture with gradients, an edge, and some noise: a few hundred colours.
fn picture() -> Vec<Rgb> {
    let mut random = 7u32;
    let pixel = |at: usize| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y, noise) = (at % WIDTH, at / WIDTH, (random >> 28) as usize);
        let sky = [90 + y * 2 + noise, 120 + y + noise, 255 - noise - y];
        let ground = [40 + x * 4 + noise, 200 - y * 3 - noise, x + noise * 2];
        let level = if x + y > 40 { ground } else { sky };
        rgb(level.map(|level| level as u8))
    };
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

/// The picture's weighted colours at 5 bits, and the same for the oracle.
fn weighted() -> (Vec<WeightedColor>, Vec<Weighted>) {
    let mut bins = vec![Bin::EMPTY; Histogram::<5>::bins()];
    let mut histogram = Histogram::<5>::new(&mut bins).unwrap();
    picture().chunks(WIDTH).for_each(|line| histogram.add(line).unwrap());
    let mut list = vec![WeightedColor::EMPTY; histogram.occupied()];
    histogram.weighted_colors(&mut list).unwrap();
    // Whole levels, which the oracles understand.
    let plain: Vec<Weighted> =
        list.iter().map(|weighted| (color(weighted.rounded()), weighted.count())).collect();
    (plain.iter().map(|(color, count)| WeightedColor::new(rgb(*color), *count)).collect(), plain)
}

fn wu(list: &[WeightedColor], palette: &mut [Rgb]) -> usize {
    let mut moments = vec![Moment::EMPTY; Wu::<5>::moments()];
    let mut cuboids = vec![Cuboid::EMPTY; palette.len()];
    Wu::<5>::new(&mut moments, &mut cuboids).unwrap().palette(list, palette).unwrap()
}

fn map(colors: impl ColorIndex) -> Vec<u8> {
    let (pixels, mut line, mut indices) = (picture(), vec![0; WIDTH], vec![0; WIDTH * HEIGHT]);
    let mut filter = ApplyPalette::new(WIDTH, colors, &mut line).unwrap();
    let output = &mut ImageMut::new(&mut indices, WIDTH, HEIGHT).unwrap();
    run(&mut filter, Image::new(&pixels, WIDTH, HEIGHT).unwrap(), output).unwrap();
    indices
}

fn close(got: Color, expected: [f64; 3], tolerance: f64) -> bool {
    got.iter().zip(expected).all(|(got, expected)| (f64::from(*got) - expected).abs() <= tolerance)
}

fn any_palette() -> impl Strategy<Value = Vec<Color>> {
    prop_oneof![
        vec(any::<Color>(), 1..20),
        vec(any::<Color>(), 200..257),
        vec([120..136u8, 0..9u8, 0..9u8], 1..99)
    ]
}

fn any_colors() -> impl Strategy<Value = Vec<Weighted>> {
    let few = [0..4u8, 0..4u8, 0..4u8].prop_map(|color| color.map(|level| level * 85));
    vec((prop_oneof![any::<Color>(), few], 0..50u32), 1..40)
        .prop_filter("no pixel", |list| list.iter().any(|c| c.1 > 0))
}

fn lend(list: &[Weighted]) -> Vec<WeightedColor> {
    list.iter().map(|(color, count)| WeightedColor::new(rgb(*color), *count)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn searches_find_the_nearest(palette in any_palette(), pixels in vec(any::<Color>(), 100), memory in 0..300usize) {
        let list: Vec<Rgb> = palette.iter().copied().map(rgb).collect();
        let mut probes = vec![Probe::EMPTY; list.len()];
        let mut nearest = Nearest::new(&list, &mut probes).unwrap();
        let mut cells = vec![Cell::EMPTY; ExactMap::<4>::cells()];
        let mut groups = vec![Group::EMPTY; ExactMap::<4>::groups(list.len()) + memory];
        let mut exact = ExactMap::<4>::new(&list, &mut cells, &mut groups).unwrap();
        let mut table = vec![0; InverseMap::<4>::cells()];
        let mut inverse = InverseMap::<4>::new(nearest, &mut table).unwrap();
        // Colours of the palette and their neighbours besides any.
        let pixels: Vec<Color> = pixels.into_iter().chain(palette.iter().map(|c| c.map(|l| l.saturating_add(3)))).collect();
        let line: Vec<Rgb> = pixels.iter().copied().map(rgb).collect();
        let (mut one, mut other) = (vec![0; line.len()], vec![0; line.len()]);
        nearest.indices(&line, &mut one);
        exact.indices(&line, &mut other);
        for ((&pixel, one), other) in pixels.iter().zip(one).zip(other) {
            let expected = oracle::nearest(&palette, pixel);
            prop_assert_eq!(usize::from(nearest.index(rgb(pixel))), expected);
            prop_assert_eq!(usize::from(one), expected);
            prop_assert_eq!(usize::from(other), expected);
            let distance = |index: usize| f64::from(oracle::squared_distance(palette[index], pixel)).sqrt();
            let error = distance(usize::from(inverse.index(rgb(pixel)))) - distance(expected);
            prop_assert!(error <= 15.0 * 3f64.sqrt() + 1e-9, "{error}");
        }
    }

    #[test]
    fn floyd_steinberg_is_the_definition(palette in any_palette(), pixels in vec(any::<Color>(), 60), width in 1..13usize) {
        let list: Vec<Rgb> = palette.iter().copied().map(rgb).collect();
        let mut probes = vec![Probe::EMPTY; list.len()];
        let nearest = Nearest::new(&list, &mut probes).unwrap();
        let pixels = &pixels[..60 / width * width];
        let line: Vec<Rgb> = pixels.iter().copied().map(rgb).collect();
        let (mut indices, mut errors) = (vec![0; width], vec![[0; 3]; width]);
        let mut filter = FloydSteinberg::new(width, nearest, &mut indices, &mut errors).unwrap();
        let expected = oracle::floyd_steinberg(pixels, width, &palette);
        for _ in 0..2 {
            let mut got = Vec::new();
            line.chunks(width).for_each(|line| filter.push(line, &mut |line: &[u8]| got.extend_from_slice(line)).unwrap());
            filter.finish(&mut |_: &[u8]| unreachable!("no line is held back"));
            prop_assert_eq!(&got, &expected, "and the next frame starts afresh");
        }
    }

    #[test]
    fn median_cut_is_the_definition(list in any_colors(), most in 1..20usize) {
        let expected = oracle::median_cut(&list, most);
        let (mut spans, mut palette) = (vec![Span::EMPTY; most], vec![Rgb::default(); most]);
        let made = median_cut(&mut lend(&list), &mut spans, &mut palette).unwrap();
        prop_assert_eq!(made, expected.len());
        for (got, expected) in palette.iter().zip(expected) {
            // Once to quarters, once to levels.
            prop_assert!(close(color(*got), expected, 0.626), "{got:?} {expected:?}");
        }
    }

    #[test]
    fn wu_leaves_the_error_of_the_definition(list in any_colors(), most in 1..9usize) {
        let list: Vec<_> = list.into_iter().filter(|color| color.1 > 0).collect();
        let expected = oracle::wu_error(&list, 3, most);
        let (mut moments, mut cuboids) = (vec![Moment::EMPTY; Wu::<3>::moments()], vec![Cuboid::EMPTY; most]);
        let mut palette = vec![Rgb::default(); most];
        let made = Wu::<3>::new(&mut moments, &mut cuboids).unwrap().palette(&lend(&list), &mut palette).unwrap();
        // The nearest colour is at most as far as the own box's; rounding a mean adds at most 3/4 a pixel.
        let pixels: u32 = list.iter().map(|color| color.1).sum();
        let got = oracle::squared_error(&list, &colors(&palette[..made])) as f64;
        prop_assert!(got <= expected * 1.0001 + 0.76 * f64::from(pixels), "{got} {expected}");
    }

    #[test]
    fn kmeans_is_lloyd(list in any_colors(), palette in vec(any::<Color>(), 1..9)) {
        let mut probes = vec![Probe::EMPTY; palette.len()];
        let mut clusters = vec![Cluster::EMPTY; palette.len()];
        let mut kmeans = KMeans::new(&mut clusters, &mut probes);
        let list: Vec<_> = list.into_iter().filter(|color| color.1 > 0).collect();
        let mut got: Vec<Rgb> = palette.iter().copied().map(rgb).collect();
        kmeans.refine(&lend(&list), &mut got, 1).unwrap();
        for (got, expected) in got.iter().zip(oracle::kmeans_step(&list, &palette)) {
            prop_assert!(close(color(*got), expected, 0.626), "{got:?} {expected:?}");
        }
        let started = oracle::squared_error(&list, &palette);
        kmeans.refine(&lend(&list), &mut got, 50).unwrap();
        let pixels: u32 = list.iter().map(|color| color.1).sum();
        prop_assert!(oracle::squared_error(&list, &colors(&got)) <= started + u64::from(pixels));
    }

    #[test]
    fn octree_is_the_definition(pixels in vec(any::<Color>(), 1..80), most in 1..20usize, depth in 1..9u32) {
        // Half of them close together, so that deep levels have something to merge.
        let pixels: Vec<Color> = (0..).zip(pixels).map(|(n, c)| if n % 2 == 0 { c } else { c.map(|l| l & 15) }).collect();
        let mut nodes = vec![Node::EMPTY; Octree::nodes(most, depth as usize)];
        let mut tree = Octree::new(most, depth as usize, &mut nodes).unwrap();
        let mut palette = vec![Rgb::default(); most];
        for _ in 0..2 {
            tree.clear();
            tree.add(&pixels.iter().copied().map(rgb).collect::<Vec<_>>()).unwrap();
            let made = tree.palette(&mut palette).unwrap();
            let expected = oracle::octree(&pixels, most, depth);
            prop_assert_eq!(made, expected.len());
            for expected in expected {
                prop_assert!(palette[..made].iter().any(|got| close(color(*got), expected, 0.626)), "{expected:?}");
            }
        }
    }

    #[test]
    fn popularity_is_the_definition(list in any_colors(), most in 1..20usize) {
        let mut sorted: Vec<_> = list.iter().copied().filter(|color| color.1 > 0).collect();
        sorted.sort_by_key(|(color, count)| (u32::MAX - count, *color));
        let mut palette = vec![Rgb::default(); most];
        let made = popularity(&mut lend(&list), &mut palette).unwrap();
        let expected: Vec<Color> = sorted.iter().take(most).map(|color| color.0).collect();
        prop_assert_eq!(colors(&palette[..made]), expected);
    }

    #[test]
    fn uniform_is_nearest(levels in [1..7u8, 1..7u8, 1..7u8], pixel in any::<Color>()) {
        let mut palette = vec![Rgb::default(); 256];
        let mut uniform = Uniform::new(levels, &mut palette).unwrap();
        let given = color(uniform.palette()[usize::from(uniform.clone().index(rgb(pixel)))]);
        let palette = colors(uniform.palette());
        let nearest = oracle::squared_distance(palette[oracle::nearest(&palette, pixel)], pixel);
        prop_assert_eq!(oracle::squared_distance(given, pixel), nearest);
        prop_assert_eq!(usize::from(uniform.index(rgb(pixel))), palette.iter().position(|c| *c == given).unwrap());
    }
}

#[test]
fn tiles_are_made_by_their_methods() {
    for tile in [BAYER_2, BAYER_4, BAYER_8] {
        let cells = (tile.side() * tile.side()) as u32;
        let ranks = oracle::bayer(tile.side()).concat();
        let thresholds: Vec<u8> = ranks.iter().map(|rank| ((rank * 256 + 128) / cells) as u8).collect();
        assert_eq!(tile.thresholds(), thresholds);
    }
    let thresholds: Vec<u8> =
        oracle::void_and_cluster(BLUE_NOISE.side()).iter().map(|rank| (rank / 4) as u8).collect();
    assert_eq!(BLUE_NOISE.thresholds(), thresholds);
}

#[test]
fn blue_noise_keeps_dots_apart() {
    // The first 64 of 1024 dots: at least 3 pixels apart, where dots at random would touch.
    let tile = BLUE_NOISE.thresholds();
    let dots: Vec<usize> = (0..1024).filter(|cell| tile[*cell] < 16).collect();
    let torus = |a: usize, b: usize| a.abs_diff(b).min(32 - a.abs_diff(b)).pow(2);
    for (number, one) in dots.iter().enumerate() {
        for other in &dots[..number] {
            assert!(torus(one % 32, other % 32) + torus(one / 32, other / 32) >= 5, "{one} {other}");
        }
    }
}

#[test]
fn makers_compare_as_they_should() {
    let (list, plain) = weighted();
    let error = |palette: &[Rgb]| oracle::squared_error(&plain, &colors(palette));
    let mut start = [Rgb::default(); 16];
    assert_eq!(wu(&list, &mut start), 16);
    let by_wu = error(&start);
    let mut palette = start;
    let (mut clusters, mut probes) = ([Cluster::EMPTY; 16], [Probe::EMPTY; 16]);
    KMeans::new(&mut clusters, &mut probes).refine(&list, &mut palette, 30).unwrap();
    let by_kmeans = error(&palette);
    assert!(by_kmeans < by_wu, "{by_kmeans} {by_wu}");
    let mut uniform = [Rgb::default(); 16];
    Uniform::new([2, 4, 2], &mut uniform).unwrap();
    let by_uniform = error(&uniform);
    let mut cumulative = vec![0; list.len()];
    let learning = Learning { samples: 2048, rounds: 8, reserved: 0 };
    palette = uniform;
    local_kmeans(&list, learning, &mut cumulative, &mut [[0; 3]; 16], &mut palette).unwrap();
    let by_local = error(&palette);
    neuquant(&list, 8192, &mut cumulative, &mut [Neuron::EMPTY; 16], &mut palette).unwrap();
    let by_neuquant = error(&palette);
    let mut nodes = vec![Node::EMPTY; Octree::nodes(16, 6)];
    let mut tree = Octree::new(16, 6, &mut nodes).unwrap();
    tree.add_weighted(&list).unwrap();
    let made = tree.palette(&mut palette).unwrap();
    let by_octree = error(&palette[..made]);
    median_cut(&mut list.clone(), &mut [Span::EMPTY; 16], &mut palette).unwrap();
    let by_median = error(&palette);
    println!(
        "kmeans {by_kmeans} wu {by_wu} local {by_local} neuquant {by_neuquant} octree {by_octree} median {by_median} uniform {by_uniform}"
    );
    for (name, other) in
        [("local", by_local), ("neuquant", by_neuquant), ("octree", by_octree), ("median", by_median)]
    {
        assert!(other < by_uniform / 2, "{name} {other} {by_uniform}");
        assert!(other > by_kmeans * 9 / 10, "{name} {other} {by_kmeans}");
    }
}

#[test]
fn local_kmeans_ends_at_a_minimum() {
    let (list, plain) = weighted();
    let mut palette: Vec<Rgb> = (0..8)
        .map(|corner| rgb([0, 1, 2].map(|bit| if corner >> bit & 1 == 1 { 192 } else { 64 })))
        .collect();
    let reserved = palette.clone();
    let learning = Learning { samples: 8192, rounds: 8, reserved: 2 };
    local_kmeans(&list, learning, &mut vec![0; list.len()], &mut [[0; 3]; 8], &mut palette).unwrap();
    assert_eq!(palette[..2], reserved[..2]);
    // Lloyd's means of the colours' own pixels are where they are, but for the last step's noise.
    let used: Vec<Color> = colors(&palette);
    for (index, mean) in oracle::kmeans_step(&plain, &used).into_iter().enumerate().skip(2) {
        assert!(close(used[index], mean, 6.0), "{index}: {:?} {mean:?}", used[index]);
    }
}

#[test]
fn maps_agree_on_a_picture() {
    let (list, _) = weighted();
    let mut palette = [Rgb::default(); 64];
    let made = wu(&list, &mut palette);
    let palette = &palette[..made];
    let plain = colors(palette);
    let expected: Vec<u8> =
        picture().iter().map(|pixel| oracle::nearest(&plain, color(*pixel)) as u8).collect();
    let mut probes = [Probe::EMPTY; 64];
    let nearest = Nearest::new(palette, &mut probes).unwrap();
    assert_eq!(map(nearest), expected);
    let mut cells = vec![Cell::EMPTY; ExactMap::<5>::cells()];
    let mut groups = [Group::EMPTY; 300];
    assert_eq!(map(ExactMap::<5>::new(palette, &mut cells, &mut groups).unwrap()), expected);
    let mut table = vec![0; InverseMap::<5>::cells()];
    let fast = map(InverseMap::<5>::new(nearest, &mut table).unwrap());
    let error = |indices: &[u8]| -> u32 {
        picture()
            .iter()
            .zip(indices)
            .map(|(pixel, index)| oracle::squared_distance(color(*pixel), plain[usize::from(*index)]))
            .sum()
    };
    assert!(error(&fast) < error(&expected) * 12 / 10, "{} {}", error(&fast), error(&expected));
}

#[test]
fn spatial_lowers_what_the_eye_sees() {
    let pixels = picture();
    let plain = colors(&pixels);
    let (list, _) = weighted();
    let mut start = [Rgb::default(); 6];
    wu(&list, &mut start);
    let seen =
        |palette: &[Rgb], indices: &[u8]| oracle::blurred_error(&plain, WIDTH, &colors(palette), indices);
    let mut probes = [Probe::EMPTY; 6];
    let flat = seen(&start, &map(Nearest::new(&start, &mut probes).unwrap()));
    let diffused = seen(&start, &oracle::floyd_steinberg(&plain, WIDTH, &colors(&start)));
    let mut errors = vec![[0; 3]; WIDTH * HEIGHT];
    let mut anneal = |annealing, palette: &mut [Rgb]| {
        let mut indices = vec![0; WIDTH * HEIGHT];
        let output = &mut ImageMut::new(&mut indices, WIDTH, HEIGHT).unwrap();
        spatial(Image::new(&pixels, WIDTH, HEIGHT).unwrap(), annealing, &mut errors, palette, output)
            .unwrap();
        seen(palette, &indices)
    };
    let mut palette = start;
    let fixed = anneal(Annealing { fixed: true, ..Annealing::default() }, &mut palette);
    assert_eq!(palette, start);
    let free = anneal(Annealing::default(), &mut palette);
    println!("flat {flat:.0}, Floyd–Steinberg {diffused:.0}, fixed palette {fixed:.0}, free {free:.0}");
    assert!(diffused < flat);
    assert!(fixed < diffused, "{fixed} {diffused}");
    assert!(free < fixed, "{free} {fixed}");
}

#[test]
fn spatial_refuses_bad_parameters() {
    let pixels = [Rgb::default(); 6];
    let picture = Image::new(&pixels, 3, 2).unwrap();
    let run = |annealing, errors: usize, palette: usize, width: usize| {
        let (mut errors, mut palette, mut indices) =
            (vec![[0; 3]; errors], vec![Rgb::default(); palette], [0; 6]);
        let output = &mut ImageMut::new(&mut indices, width, 2).unwrap();
        spatial(picture, annealing, &mut errors, &mut palette, output).map(|()| palette)
    };
    let annealing = Annealing::default();
    assert!(run(annealing, 6, 2, 3).is_ok());
    assert!(run(annealing, 5, 2, 3).is_err());
    assert!(run(annealing, 6, 0, 3).is_err());
    assert!(run(annealing, 6, 257, 3).is_err());
    assert!(run(annealing, 6, 2, 2).is_err());
    assert!(run(Annealing { temperature: 0, ..annealing }, 6, 2, 3).is_err());
    assert!(run(Annealing { sweeps: 33, ..annealing }, 6, 2, 3).is_err());
}
