//! Pixel formats against their standards.

use algos_nostd::image::Rgb;
use algos_nostd::pixel::yuv422::{self, Coefficients, Matrix, Packing, Range};
use algos_nostd::pixel::{gray8, rgb888};
use camif_tests::oracle::pixel::{BT601, BT709, rgb, yuv};

const SPACES: [(Matrix, (f64, f64)); 2] = [(Matrix::Bt601, BT601), (Matrix::Bt709, BT709)];
const RANGES: [(Range, bool); 2] = [(Range::Full, false), (Range::Limited, true)];

/// All 65,536 colours of one red.
fn plane(red: u8) -> Vec<Rgb> {
    (0..=u16::MAX).map(|low| Rgb::new(red, (low >> 8) as u8, low as u8)).collect()
}

#[test]
fn luma_is_exact_for_every_colour() {
    let mut gray = vec![0; 1 << 16];
    for red in 0..=255 {
        let pixels = plane(red);
        gray8::encode_line(&pixels, &mut gray).unwrap();
        for (pixel, &gray) in pixels.iter().zip(&gray) {
            let thousandths = 299 * u32::from(pixel.r) + 587 * u32::from(pixel.g) + 114 * u32::from(pixel.b);
            assert_eq!(u32::from(gray), (thousandths + 500) / 1000);
        }
    }
}

#[test]
fn yuv_codes_are_those_of_the_standards() {
    for (matrix, weights) in SPACES {
        for (range, limited) in RANGES {
            let coefficients = Coefficients::new(matrix, range);
            let (mut samples, mut off) = (0u32, 0u32);
            for red in (0..=255).step_by(17) {
                // Each pair of neighbours shares its chroma.
                let pixels: Vec<Rgb> = plane(red).into_iter().step_by(7).take(9362).collect();
                let mut bytes = vec![0; yuv422::line_bytes(pixels.len())];
                yuv422::encode_line(&pixels, &mut bytes, Packing::Yuyv, &coefficients).unwrap();
                let mut back = vec![Rgb::default(); pixels.len()];
                yuv422::decode_line(&bytes, &mut back, Packing::Yuyv, &coefficients).unwrap();
                for ((pair, back), codes) in
                    pixels.chunks(2).zip(back.chunks(2)).zip(bytes.as_chunks::<4>().0)
                {
                    let exact = [0, 1]
                        .map(|at| yuv([pair[at].r, pair[at].g, pair[at].b].map(f64::from), weights, limited));
                    let [cb, cr] = [1, 2].map(|at| (exact[0][at] + exact[1][at]) / 2.0);
                    for (&code, exact) in codes.iter().zip([exact[0][0], cb, exact[1][0], cr]) {
                        // Within rounding, and the error of coefficients in Q16.
                        let exact = exact.clamp(0.0, 255.0);
                        assert!((f64::from(code) - exact).abs() <= 0.51, "{pair:?}: {code} for {exact}");
                        samples += 1;
                        off += u32::from(f64::from(code) != (exact + 0.5).floor());
                    }
                    for at in 0..2 {
                        let exact = rgb([codes[2 * at], codes[1], codes[3]].map(f64::from), weights, limited);
                        for (got, exact) in rgb888::as_bytes(&back[at..=at]).iter().zip(exact) {
                            assert!((f64::from(*got) - exact.clamp(0.0, 255.0)).abs() <= 0.51);
                        }
                    }
                }
            }
            println!("{matrix:?} {range:?}: {off} of {samples} codes differ from the rounded float");
            assert!(off * 100 < samples, "{matrix:?} {range:?}: {off} of {samples}");
        }
    }
}

/// The largest change of a channel over all 2²⁴ colours in equal pairs, there and back.
fn worst_round_trip(matrix: Matrix, range: Range) -> u8 {
    let coefficients = Coefficients::new(matrix, range);
    let mut bytes = vec![0; 1 << 18];
    let mut back = vec![Rgb::default(); 1 << 17];
    let mut worst = 0;
    for red in 0..=255 {
        let pixels: Vec<Rgb> = plane(red).into_iter().flat_map(|pixel| [pixel; 2]).collect();
        yuv422::encode_line(&pixels, &mut bytes, Packing::Uyvy, &coefficients).unwrap();
        yuv422::decode_line(&bytes, &mut back, Packing::Uyvy, &coefficients).unwrap();
        let (given, got) = (rgb888::as_bytes(&pixels), rgb888::as_bytes(&back));
        worst = given.iter().zip(got).fold(worst, |worst, (a, b)| worst.max(a.abs_diff(*b)));
    }
    worst
}

#[test]
fn every_colour_comes_back_from_full_range_within_its_bound() {
    assert_eq!(worst_round_trip(Matrix::Bt601, Range::Full), 1);
    assert_eq!(worst_round_trip(Matrix::Bt709, Range::Full), 1);
}

#[test]
fn every_colour_comes_back_from_limited_range_within_its_bound() {
    assert_eq!(worst_round_trip(Matrix::Bt601, Range::Limited), 2);
    assert_eq!(worst_round_trip(Matrix::Bt709, Range::Limited), 2);
}
