//! Scaling against integration and interpolation in floating point.

use algos_nostd::filter::scale::Sizes;
use algos_nostd::filter::scale::bilinear::{self, BilinearScale};
use algos_nostd::filter::scale::box_area::{self, BoxScale};
use algos_nostd::image::{Image, ImageMut, Rgb};
use algos_nostd::lines::run;
use algos_nostd::pixel::rgb888;
use camif_tests::oracle::scale as oracle;

const CASES: [((usize, usize), (usize, usize)); 10] = [
    ((1, 1), (5, 3)),
    ((7, 5), (7, 5)),
    ((8, 6), (4, 3)),
    ((9, 7), (4, 3)),
    ((13, 11), (1, 1)),
    ((5, 4), (11, 9)),
    ((16, 2), (3, 9)),
    ((2, 16), (9, 3)),
    ((31, 3), (30, 3)),
    ((3, 29), (3, 2)),
];

fn picture(length: usize) -> Vec<u8> {
    let mut state = 99u32;
    (0..length)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Ends of the range often, where overflow would show.
            match state >> 30 {
                0 => 255,
                1 => 0,
                _ => (state >> 16) as u8,
            }
        })
        .collect()
}

#[test]
fn boxes_are_exact_means_of_areas() {
    for (from, to) in CASES {
        let pixels = picture(from.0 * from.1);
        let (mut work, mut line) = (vec![0; box_area::sums(to.0, 1)], vec![0u8; to.0]);
        let mut filter = BoxScale::new(Sizes { from, to }, &mut work, &mut line).unwrap();
        let mut out = vec![0; to.0 * to.1];
        for _ in 0..2 {
            run(
                &mut filter,
                Image::new(&pixels, from.0, from.1).unwrap(),
                &mut ImageMut::new(&mut out, to.0, to.1).unwrap(),
            )
            .unwrap();
        }
        for (at, &got) in out.iter().enumerate() {
            let exact = oracle::area(&pixels, from, to, at % to.0, at / to.0);
            assert!(
                (f64::from(got) - exact).abs() <= 0.5 + 1e-9,
                "{from:?} to {to:?} at {at}: {got} for {exact}"
            );
        }
    }
}

#[test]
fn bilinear_is_within_a_code_of_the_mixture() {
    for (from, to) in CASES {
        let pixels = picture(from.0 * from.1);
        let (mut work, mut line) = (vec![0; bilinear::values(to.0, 1)], vec![0u8; to.0]);
        let mut filter = BilinearScale::new(Sizes { from, to }, &mut work, &mut line).unwrap();
        let mut out = vec![0; to.0 * to.1];
        run(
            &mut filter,
            Image::new(&pixels, from.0, from.1).unwrap(),
            &mut ImageMut::new(&mut out, to.0, to.1).unwrap(),
        )
        .unwrap();
        for (at, &got) in out.iter().enumerate() {
            let exact = oracle::bilinear(&pixels, from, to, at % to.0, at / to.0);
            // Half a code of rounding; each of two fractions is off by up to 1/512 of a step of up to 255.
            let bound = 0.5 + 2.0 * 255.0 / 512.0;
            assert!((f64::from(got) - exact).abs() <= bound, "{from:?} to {to:?} at {at}: {got} for {exact}");
        }
    }
}

#[test]
fn channels_are_scaled_each_by_itself() {
    let (from, to) = ((9, 7), (4, 10));
    let planes: [Vec<u8>; 3] = [picture(63), picture(64)[1..].to_vec(), picture(65)[2..].to_vec()];
    let pixels: Vec<Rgb> = (0..63).map(|at| Rgb::new(planes[0][at], planes[1][at], planes[2][at])).collect();
    let (mut gray, mut color) = (vec![0u8; 40], vec![Rgb::default(); 40]);
    let (mut sums, mut values) = (vec![0; box_area::sums(4, 3)], vec![0; bilinear::values(4, 3)]);
    let (mut gray_line, mut line) = ([0u8; 4], [Rgb::default(); 4]);
    let sizes = Sizes { from, to };
    for boxed in [true, false] {
        let image = Image::new(&pixels, 9, 7).unwrap();
        let mut out = ImageMut::new(&mut color, 4, 10).unwrap();
        if boxed {
            run(&mut BoxScale::new(sizes, &mut sums, &mut line).unwrap(), image, &mut out).unwrap();
        } else {
            run(&mut BilinearScale::new(sizes, &mut values, &mut line).unwrap(), image, &mut out).unwrap();
        }
        for (channel, plane) in planes.iter().enumerate() {
            let image = Image::new(plane, 9, 7).unwrap();
            let mut out = ImageMut::new(&mut gray, 4, 10).unwrap();
            if boxed {
                run(&mut BoxScale::new(sizes, &mut sums, &mut gray_line).unwrap(), image, &mut out).unwrap();
            } else {
                run(&mut BilinearScale::new(sizes, &mut values, &mut gray_line).unwrap(), image, &mut out)
                    .unwrap();
            }
            let of_color: Vec<u8> =
                rgb888::as_bytes(&color).iter().skip(channel).step_by(3).copied().collect();
            assert_eq!(of_color, gray);
        }
    }
}
