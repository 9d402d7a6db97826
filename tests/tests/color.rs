//! Demosaic and curves against their definitions.

use algos_nostd::color::curve::Curve;
use algos_nostd::color::demosaic::{bilinear, bilinear::Bilinear, malvar, malvar::Malvar};
use algos_nostd::image::Rgb;
use algos_nostd::lines::LineFilter;
use algos_nostd::pixel::BitDepth;
use algos_nostd::pixel::bayer::{BayerOrder, mosaic_line_deep};
use camif_tests::oracle::demosaic::Mosaic;

/// A stream of even numbers from a seed.
fn noise(seed: u32) -> impl FnMut() -> u32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 8
    }
}

fn collect<F: LineFilter<Input = u16, Output = Rgb>>(
    filter: &mut F,
    samples: &[u16],
    width: usize,
) -> Vec<Rgb> {
    let mut out = Vec::new();
    let mut sink = |line: &[Rgb]| out.extend_from_slice(line);
    samples.chunks(width).for_each(|line| filter.push(line, &mut sink).unwrap());
    filter.finish(&mut sink);
    out
}

#[test]
fn demosaic_is_its_figure() {
    let mut random = noise(7);
    for order in BayerOrder::ALL {
        for depth in [BitDepth::Bits8, BitDepth::Bits10, BitDepth::Bits12, BitDepth::Bits14] {
            for (width, height) in [(3, 3), (4, 3), (7, 5), (16, 9), (131, 4)] {
                let samples: Vec<u16> =
                    (0..width * height).map(|_| (random() as u16) & depth.max()).collect();
                let mut line = vec![Rgb::default(); width];
                let mut window = vec![0; malvar::window(width)];
                let flat = collect(
                    &mut Bilinear::new(order, depth, &mut window[..bilinear::window(width)], &mut line)
                        .unwrap(),
                    &samples,
                    width,
                );
                let corrected =
                    collect(&mut Malvar::new(order, depth, &mut window, &mut line).unwrap(), &samples, width);
                let mosaic = Mosaic { samples: &samples, width: width as i64, name: order.name() };
                for at in 0..width * height {
                    let (x, y) = ((at % width) as i64, (at / width) as i64);
                    let code = |sample: f64| {
                        (((sample + 0.5).floor() as i64) >> (depth.bits() - 8)).clamp(0, 255) as u8
                    };
                    let expected = [0, 1, 2].map(|channel| code(mosaic.bilinear(x, y, channel)));
                    assert_eq!(flat[at], Rgb::from(expected), "bilinear {order:?} {depth:?} ({x}, {y})");
                    let expected = [0, 1, 2].map(|channel| code(mosaic.malvar(x, y, channel)));
                    assert_eq!(corrected[at], Rgb::from(expected), "Malvar {order:?} {depth:?} ({x}, {y})");
                }
            }
        }
    }
}

#[test]
fn the_correction_is_worth_its_lines() {
    let (width, height) = (96, 96);
    // Textures whose channels move together, as those of photographs do.
    let picture: Vec<Rgb> = (0..width * height)
        .map(|at| {
            let (x, y) = ((at % width) as f64, (at / width) as f64);
            let light = 0.55 + 0.3 * (x * x / 260.0).sin() * (y / 5.0).cos();
            Rgb::from([230.0, 200.0, 150.0].map(|color: f64| (color * light) as u8))
        })
        .collect();
    let mut samples = vec![0; picture.len()];
    for (y, (pixels, samples)) in picture.chunks(width).zip(samples.chunks_mut(width)).enumerate() {
        mosaic_line_deep(pixels, samples, BayerOrder::Grbg, y, BitDepth::Bits10).unwrap();
    }
    let (mut line, mut window) = (vec![Rgb::default(); width], vec![0; malvar::window(width)]);
    let depth = BitDepth::Bits10;
    let psnr = |out: &[Rgb]| {
        let squares: f64 = out
            .iter()
            .zip(&picture)
            .flat_map(|(a, b)| [a.r.abs_diff(b.r), a.g.abs_diff(b.g), a.b.abs_diff(b.b)])
            .map(|difference| f64::from(difference).powi(2))
            .sum();
        10.0 * (255.0f64.powi(2) * 3.0 * picture.len() as f64 / squares).log10()
    };
    let flat = psnr(&collect(
        &mut Bilinear::new(BayerOrder::Grbg, depth, &mut window, &mut line).unwrap(),
        &samples,
        width,
    ));
    let corrected = psnr(&collect(
        &mut Malvar::new(BayerOrder::Grbg, depth, &mut window, &mut line).unwrap(),
        &samples,
        width,
    ));
    println!("demosaic: bilinear {flat:.2} dB, Malvar–He–Cutler {corrected:.2} dB");
    assert!(corrected > flat + 4.0, "bilinear {flat:.2} dB, Malvar–He–Cutler {corrected:.2} dB");
}

#[test]
fn curves_are_their_formulas() {
    let code = |fraction: f64| (255.0 * fraction + 0.5).floor() as u8;
    for thousandths in [10, 333, 455, 1000, 1800, 2200, 2400, 10_000] {
        let curve = Curve::gamma(thousandths).unwrap();
        for value in 0..=255 {
            let exact = (f64::from(value) / 255.0).powf(f64::from(thousandths) / 1000.0);
            assert_eq!(curve.apply(value), code(exact), "{value} to the power of {thousandths} / 1000");
        }
    }
    let (to_linear, to_srgb) = (Curve::srgb_to_linear(), Curve::linear_to_srgb());
    for value in 0..=255 {
        let v = f64::from(value) / 255.0;
        let linear = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
        let encoded = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        assert_eq!(to_linear.apply(value), code(linear));
        assert_eq!(to_srgb.apply(value), code(encoded));
        let back = to_linear.apply(to_srgb.apply(value));
        assert!(back.abs_diff(value) <= 1, "{value} there and back is {back}");
    }
}
