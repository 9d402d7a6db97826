//! Colour balance against colour science in floating point: `docs/color-balance.md` shows the tables.

use algos_nostd::color::balance::adaptation::{self, Space};
use algos_nostd::color::balance::exact::Exact3;
use algos_nostd::color::balance::gray_edge::{GrayEdge, Norm};
use algos_nostd::color::balance::gray_world;
use algos_nostd::color::balance::white_patch::WhitePatch;
use algos_nostd::color::balance::{Gains, White};
use algos_nostd::image::{Image, Rgb};
use camif_tests::oracle::balance as oracle;
use camif_tests::page::same_page;
use std::fmt::Write;

/// Reflectances of 30 smooth surfaces: long-pass, short-pass and band-pass edges over three grounds, as pigments have them.
fn surfaces() -> Vec<impl Fn(f64) -> f64> {
    let mut surfaces = Vec::new();
    for (ground, top) in [(0.05, 0.8), (0.15, 0.6)] {
        for center in [460.0, 500.0, 540.0, 580.0, 620.0] {
            for kind in 0..3 {
                surfaces.push(move |nanometers: f64| {
                    let t = (nanometers - center) / 22.0;
                    let shape = match kind {
                        0 => 1.0 / (1.0 + (-t).exp()),
                        1 => 1.0 / (1.0 + t.exp()),
                        _ => (-0.5 * (t / 1.8) * (t / 1.8)).exp(),
                    };
                    ground + (top - ground) * shape
                });
            }
        }
    }
    surfaces
}

fn to_q32(vector: oracle::Vector) -> [i64; 3] {
    vector.map(|value| (value * Exact3::ONE as f64).round() as i64)
}

#[test]
fn the_page_shows_what_is_measured() {
    let page = format!(
        "# Colour balance, measured\n\n\
         `cargo test -p camif-tests --test balance` makes this page (`BLESS=1` writes it) and holds each figure against colour\n\
         science in floating point (`tests/src/oracle/balance.rs`), written from the definitions.\n\n\
         ## Chromatic adaptation\n\
         Thirty smooth reflectances seen under illuminant A, adapted to D65, against what they are under D65: ΔE\\*ab of CIE 1976.\n\
         Integers (Q32) and floating point differ by less than 10⁻⁵ ΔE everywhere.\n\n{}\n\
         The 3 × 3 matrix that a line of pixels goes through has 12 bits after the point: at most 0.6 of a code from floating\n\
         point before clipping, over 65,536 colours and three lights.\n\n\
         ## Estimates of the light\n\
         A scene of random patches under one light: the angle, in degrees, between the estimate and the light. Ours and the\n\
         reference's estimate differ by less than 0.01°.\n\n{}",
        adaptation_table(),
        estimate_table()
    );
    same_page("color-balance.md", &page, "the_page_shows");
}

/// Adapts by every space, checks it against the reference, and tells of it.
fn adaptation_table() -> String {
    let [white_a, white_d65] = [oracle::illuminant_a as fn(f64) -> f64, oracle::illuminant_d65]
        .map(|light| oracle::xyz(light, |_| 1.0));
    let unchanged = mean_and_most(|under_a| under_a, white_d65);
    let mut table = String::from("| space | mean | most |\n|---|---:|---:|\n");
    _ = writeln!(table, "| none | {:.2} | {:.2} |", unchanged.0, unchanged.1);
    let mut means = Vec::new();
    for space in Space::ALL {
        let matrix = adaptation::in_xyz(space, to_q32(white_a), to_q32(white_d65)).unwrap();
        let ours = |xyz: oracle::Vector| {
            matrix.times_vector(to_q32(xyz)).unwrap().map(|value| value as f64 / Exact3::ONE as f64)
        };
        let difference = surfaces()
            .iter()
            .map(|surface| oracle::xyz(oracle::illuminant_a, surface))
            .map(|xyz| {
                let reference = oracle::adapt(space.name(), xyz, white_a, white_d65);
                oracle::distance(oracle::lab(ours(xyz), white_d65), oracle::lab(reference, white_d65))
            })
            .fold(0.0, f64::max);
        let (mean, most) = mean_and_most(ours, white_d65);
        _ = writeln!(table, "| {} | {mean:.2} | {most:.2} |", space.name());
        assert!(difference < 1e-5, "{}: {difference} from the reference", space.name());
        // Scaling sRGB's own primaries fails on colours outside their triangle; the others do well.
        let bound = if space == Space::Rgb { 1.0 } else { 0.5 };
        assert!(mean < bound * unchanged.0, "{}: {mean} of {}", space.name(), unchanged.0);
        means.push((space, mean));
    }
    let of = |wanted| means.iter().find(|(space, _)| *space == wanted).map_or(f64::NAN, |(_, mean)| *mean);
    assert!(of(Space::Bradford) < of(Space::Xyz), "sharpened cones do better than XYZ scaling");
    assert!(of(Space::Sharp) < of(Space::Xyz) && of(Space::Cat02) < of(Space::Xyz));
    table
}

/// Mean and largest ΔE*ab of the surfaces, taken from light A by `adapt`, from what they are in daylight.
fn mean_and_most(adapt: impl Fn(oracle::Vector) -> oracle::Vector, white: oracle::Vector) -> (f64, f64) {
    let surfaces = surfaces();
    let errors: Vec<f64> = surfaces
        .iter()
        .map(|surface| {
            let adapted = adapt(oracle::xyz(oracle::illuminant_a, surface));
            let daylight = oracle::xyz(oracle::illuminant_d65, surface);
            oracle::distance(oracle::lab(adapted, white), oracle::lab(daylight, white))
        })
        .collect();
    (errors.iter().sum::<f64>() / errors.len() as f64, errors.iter().copied().fold(0.0, f64::max))
}

#[test]
fn matrices_for_rgb_are_within_a_code_of_the_reference() {
    for light in [Rgb::new(255, 190, 110), Rgb::new(140, 180, 255), Rgb::new(200, 230, 190)] {
        let white = White::of(light);
        for space in Space::ALL {
            let matrix = adaptation::in_rgb(space, white, white.gray()).unwrap();
            let rgb = |white: White| [white.r, white.g, white.b].map(|channel| f64::from(channel) / 256.0);
            let [from, to] =
                [white, white.gray()].map(|white| oracle::times(&oracle::RGB_TO_XYZ, rgb(white)));
            let mut worst = 0.0f64;
            for index in 0..=u16::MAX {
                let pixel =
                    Rgb::from([index >> 11, index >> 5 & 63, index & 31].map(|step| (step * 8) as u8));
                let xyz = oracle::times(&oracle::RGB_TO_XYZ, [pixel.r, pixel.g, pixel.b].map(f64::from));
                let adapted = oracle::adapt(space.name(), xyz, from, to);
                let exact = oracle::times(&oracle::inverse(&oracle::RGB_TO_XYZ), adapted);
                let ours = matrix.apply(pixel);
                for (ours, exact) in [ours.r, ours.g, ours.b].into_iter().zip(exact) {
                    worst = worst.max((f64::from(ours) - exact.clamp(0.0, 255.0)).abs());
                }
            }
            // Half a code of rounding, and three coefficients that are each off by up to 2⁻¹³.
            assert!(worst <= 0.5 + 3.0 * 255.0 / 8192.0, "{} under {light}: {worst}", space.name());
        }
    }
}

/// A scene of gray on the mean with one light upon it, and grain.
fn scene(light: [f64; 3], width: usize, height: usize) -> Vec<Rgb> {
    let mut state = 5u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let patches: Vec<[f64; 3]> = (0..48).map(|_| [random(), random(), random()]).collect();
    (0..width * height)
        .map(|at| {
            let (x, y) = (at % width, at / width);
            let patch = if at % 97 == 0 { [1.0; 3] } else { patches[(x / 9 + 7 * (y / 8)) % patches.len()] };
            Rgb::from([0, 1, 2].map(|channel: usize| {
                (255.0 * light[channel] * (patch[channel] * 0.9 + 0.05 * random())).min(255.0) as u8
            }))
        })
        .collect()
}

/// Estimates lights by every method, checks them against the reference, and tells of it.
fn estimate_table() -> String {
    let (width, height) = (120, 90);
    let mut table = String::from(
        "| light | gray-world | white-patch | gray-edge | gray-edge² |\n|---|---:|---:|---:|---:|\n",
    );
    for light in [[1.0, 0.75, 0.45], [0.6, 0.8, 1.0], [1.0, 1.0, 1.0]] {
        let pixels = scene(light, width, height);
        let floats: Vec<oracle::Vector> =
            pixels.iter().map(|pixel| [pixel.r, pixel.g, pixel.b].map(f64::from)).collect();
        let mut patch = WhitePatch::new(990).unwrap();
        patch.push(&pixels);
        let edge = |norm| {
            let mut line = vec![Rgb::default(); width];
            let mut edges = GrayEdge::new(norm, &mut line).unwrap();
            pixels.chunks(width).for_each(|line| edges.push(line).unwrap());
            edges.finish().unwrap()
        };
        _ = write!(table, "| {light:?} ");
        let world = gray_world::estimate(Image::new(&pixels, width, height).unwrap());
        for (name, ours, reference) in [
            ("gray-world", world, oracle::gray_world(&floats)),
            ("white-patch", patch.finish().unwrap(), oracle::white_patch(&floats, 990)),
            ("gray-edge", edge(Norm::L1), oracle::gray_edge(&floats, width, 1)),
            ("gray-edge²", edge(Norm::L2), oracle::gray_edge(&floats, width, 2)),
        ] {
            let ours = [ours.r, ours.g, ours.b].map(f64::from);
            let (error, difference) = (oracle::angle(ours, light), oracle::angle(ours, reference));
            _ = write!(table, "| {error:.2} ");
            assert!(difference < 0.01, "{name} under {light:?}: {difference}° from the reference");
            assert!(error < 6.0, "{name} under {light:?}: {error}° from the light");
        }
        table.push_str("|\n");
        // Gray-world's promise: after its gains the mean is gray.
        let gains = Gains::neutralizing(world).unwrap();
        let balanced: Vec<oracle::Vector> = pixels
            .iter()
            .map(|&pixel| gains.apply(pixel))
            .map(|pixel| [pixel.r, pixel.g, pixel.b].map(f64::from))
            .collect();
        let left = oracle::angle(oracle::gray_world(&balanced), [1.0; 3]);
        assert!(left < 1.5, "{left}° of colour left, by saturation");
    }
    table
}
