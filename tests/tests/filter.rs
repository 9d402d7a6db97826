//! Every filter against its oracle, on random pictures of awkward sizes.

use algos_nostd::filter::{
    Bilateral, Convolution, Difference, Gaussian, Gaussian3, Gaussian5, Mask, Mean, Median3, Median5,
    Morphology, MorphologyFilter, MorphologyPair, Neighbourhood, Operation, Order, RowKernel, Separable,
    Unsharp, close, open,
};
use algos_nostd::image::{Image, ImageMut};
use algos_nostd::lines::{LineFilter, run};
use camif_tests::oracle::filter::{self as oracle, Gray};
use proptest::prelude::*;

/// Pictures of one pixel, narrower than any kernel, and about as wide as the strips that filters work in.
fn pictures() -> impl Strategy<Value = Gray> {
    let width = prop_oneof![4 => 1usize..12, 1 => 62usize..67, 1 => 125usize..133, 1 => 157usize..167, 1 => 250usize..260, 1 => 318usize..330];
    (width, 1usize..9, 0..3).prop_flat_map(|(width, height, kind)| {
        let pixel = match kind {
            0 => any::<u8>().boxed(),
            1 => prop_oneof![Just(0u8), Just(255)].boxed(),
            _ => (100u8..130).boxed(),
        };
        prop::collection::vec(pixel, width * height).prop_map(move |pixels| Gray { pixels, width, height })
    })
}

/// Runs a filter over a picture, twice, so that the second frame shows what the first has left behind.
fn run_over(filter: &mut impl LineFilter<Input = u8, Output = u8>, picture: &Gray) -> Gray {
    let (width, height) = (picture.width, picture.height);
    let inverted: Vec<u8> = picture.pixels.iter().map(|pixel| !pixel).collect();
    let mut made = Gray { pixels: vec![0; width * height], ..*picture };
    for pixels in [&inverted, &picture.pixels] {
        let input = Image::new(pixels, width, height).unwrap();
        run(filter, input, &mut ImageMut::new(&mut made.pixels, width, height).unwrap()).unwrap();
    }
    made
}

fn apply<K: RowKernel<N>, const N: usize>(kernel: K, picture: &Gray) -> Gray {
    let mut memory = vec![0; Neighbourhood::<K, N>::memory(picture.width)];
    run_over(&mut Neighbourhood::new(kernel, picture.width, &mut memory).unwrap(), picture)
}

fn wide<const N: usize>(weights: [i16; N]) -> Vec<i64> {
    weights.map(i64::from).to_vec()
}

fn mean<const N: usize>(picture: &Gray) -> Gray {
    let mut columns = vec![0; Mean::<N>::columns(picture.width)];
    apply(Mean::<N>::new(picture.width, &mut columns).unwrap(), picture)
}

/// The places of a mask as the oracle takes them.
fn places<const C: usize, const L: usize>(mask: &Mask<C, L>) -> Vec<Vec<bool>> {
    let place = |x: usize, y: usize| match mask {
        Mask::Rectangle => true,
        Mask::Cross => x == C / 2 || y == L / 2,
        Mask::Any(places) => places[y][x],
    };
    (0..L).map(|y| (0..C).map(|x| place(x, y)).collect()).collect()
}

fn check_morphology<const C: usize, const L: usize>(mask: Mask<C, L>, picture: &Gray) {
    let kernel = |operation| Morphology::new(operation, mask).unwrap();
    let places = places(&mask);
    let (eroded, dilated) = (oracle::erode(picture, &places), oracle::dilate(picture, &places));
    assert_eq!(apply(kernel(Operation::Erode), picture), eroded);
    assert_eq!(apply(kernel(Operation::Dilate), picture), dilated);
    assert_eq!(apply(kernel(Operation::Gradient), picture), oracle::combine(&dilated, &eroded, |a, b| a - b));

    let (opened, closed) = (oracle::dilate(&eroded, &places), oracle::erode(&dilated, &places));
    let width = picture.width;
    let mut memory = vec![0; 2 * MorphologyFilter::<C, L>::memory(width)];
    let mut lines = vec![0; Difference::<MorphologyPair<C, L>>::memory(width)];
    assert_eq!(run_over(&mut open(mask, width, &mut memory).unwrap(), picture), opened);
    assert_eq!(run_over(&mut close(mask, width, &mut memory).unwrap(), picture), closed);

    let filter = open(mask, width, &mut memory).unwrap();
    let mut top_hat = Difference::new(filter, Order::InputMinusOutput, width, &mut lines).unwrap();
    assert_eq!(run_over(&mut top_hat, picture), oracle::combine(picture, &opened, |a, b| a - b));
    let filter = close(mask, width, &mut memory).unwrap();
    let mut black_hat = Difference::new(filter, Order::OutputMinusInput, width, &mut lines).unwrap();
    assert_eq!(run_over(&mut black_hat, picture), oracle::combine(&closed, picture, |a, b| a - b));
}

fn check_gaussian<const N: usize>(kernel: Gaussian<N>, picture: &Gray) -> Gray {
    let weights: Vec<i64> = kernel.weights().iter().map(|&weight| i64::from(weight)).collect();
    let made = apply(kernel, picture);
    assert_eq!(made, oracle::correlation(picture, &oracle::product(&weights, &weights), 65_536, 0));
    made
}

fn check_unsharp<const N: usize>(percent: u32, radius_milli: u32, threshold: u8, picture: &Gray) {
    let made = apply(Unsharp::<N>::new(percent, radius_milli, threshold).unwrap(), picture);
    let smooth = check_gaussian(Gaussian::<N>::new(radius_milli).unwrap(), picture);
    let amount = (i64::from(percent) * 64 + 50) / 100;
    let expected = oracle::combine(picture, &smooth, |value, smooth| {
        let difference = value - smooth;
        if difference.abs() > i64::from(threshold) {
            value + (difference * amount + 32).div_euclid(64)
        } else {
            value
        }
    });
    assert_eq!(made, expected);
}

fn check_bilateral<const N: usize>(space_milli: u32, range_milli: u32, picture: &Gray) {
    let mut table = vec![0; Bilateral::<N>::table()];
    let made = apply(Bilateral::<N>::new(space_milli, range_milli, &mut table).unwrap(), picture);
    let exact = oracle::bilateral(
        picture,
        N as i64,
        f64::from(space_milli) / 1000.0,
        f64::from(range_milli) / 1000.0,
    );
    for (&made, exact) in made.pixels.iter().zip(exact) {
        // Rounded to nearest, but for weights of 2⁻¹⁶.
        assert!((f64::from(made) - exact).abs() <= 0.51, "{made}, but exactly {exact}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn gaussians_are_their_kernels(picture in pictures(), sigma_milli in 100u32..=16_000) {
        let binomial = oracle::product(&[1, 2, 1], &[1, 2, 1]);
        prop_assert_eq!(apply(Gaussian3, &picture), oracle::correlation(&picture, &binomial, 16, 0));
        prop_assert_eq!(apply(Gaussian5, &picture), oracle::correlation(&picture, &oracle::gaussian_159(), 159, 0));
        let seven = [2, 7, 14, 18, 14, 7, 2];
        let expected = oracle::correlation(&picture, &oracle::product(&seven, &seven), 4096, 0);
        prop_assert_eq!(apply(Gaussian::SEVEN, &picture), expected);
        check_gaussian(Gaussian::<1>::new(sigma_milli).unwrap(), &picture);
        check_gaussian(Gaussian::<3>::new(sigma_milli).unwrap(), &picture);
        check_gaussian(Gaussian::<9>::new(sigma_milli).unwrap(), &picture);
        check_gaussian(Gaussian::<33>::new(sigma_milli).unwrap(), &picture);
    }

    #[test]
    fn gaussians_are_near_the_real_one(picture in pictures(), sigma_milli in 400u32..=4_000) {
        let made = check_gaussian(Gaussian::<25>::new(sigma_milli).unwrap(), &picture);
        let exact = oracle::gaussian(&picture, 25, f64::from(sigma_milli) / 1000.0);
        for (&made, exact) in made.pixels.iter().zip(exact) {
            // Weights off by half a unit of 1/256, and the worst of pictures: black and white.
            prop_assert!((f64::from(made) - exact).abs() <= 7.0, "{} for {}", made, exact);
        }
    }

    #[test]
    fn means_are_means(picture in pictures()) {
        let ones = |size: usize| vec![vec![1; size]; size];
        prop_assert_eq!(mean::<1>(&picture), picture.clone());
        prop_assert_eq!(mean::<3>(&picture), oracle::correlation(&picture, &ones(3), 9, 0));
        prop_assert_eq!(mean::<5>(&picture), oracle::correlation(&picture, &ones(5), 25, 0));
        prop_assert_eq!(mean::<21>(&picture), oracle::correlation(&picture, &ones(21), 441, 0));
    }

    #[test]
    fn medians_are_medians(picture in pictures()) {
        prop_assert_eq!(apply(Median3, &picture), oracle::median(&picture, 3));
        prop_assert_eq!(apply(Median5, &picture), oracle::median(&picture, 5));
    }

    #[test]
    fn bilateral_is_the_definition(picture in pictures(), space in 300u32..20_000, range in 300u32..200_000) {
        check_bilateral::<3>(space, range, &picture);
        check_bilateral::<5>(space, range, &picture);
        check_bilateral::<11>(space, range, &picture);
    }

    #[test]
    fn morphology_is_least_and_greatest(picture in pictures(), bits in 1u32..1 << 15) {
        check_morphology(Mask::<3, 3>::Rectangle, &picture);
        check_morphology(Mask::<7, 1>::Rectangle, &picture);
        check_morphology(Mask::<1, 5>::Rectangle, &picture);
        check_morphology(Mask::<9, 11>::Rectangle, &picture);
        check_morphology(Mask::<3, 3>::Cross, &picture);
        check_morphology(Mask::<7, 5>::Cross, &picture);
        let places = core::array::from_fn(|y| core::array::from_fn(|x| bits >> (5 * y + x) & 1 == 1));
        check_morphology(Mask::<5, 3>::Any(places), &picture);
    }

    #[test]
    fn unsharp_is_the_definition(picture in pictures(), percent in 0u32..200, radius in 300u32..3000, threshold in 0u8..40) {
        check_unsharp::<3>(percent, radius, threshold, &picture);
        check_unsharp::<7>(percent, radius, threshold, &picture);
    }

    #[test]
    fn convolution_is_the_definition(
        picture in pictures(), weights: [[i8; 5]; 3], divisor in 1u32..3000, offset in -300i16..300
    ) {
        let weights = weights.map(|row| row.map(i16::from));
        let kernel: Vec<Vec<i64>> = weights.iter().map(|&row| wide(row)).collect();
        let (d, o) = (i64::from(divisor), i64::from(offset));
        let made = apply(Convolution::new(weights, divisor, offset).unwrap(), &picture);
        prop_assert_eq!(made, oracle::convolution(&picture, &kernel, d, o));
        let made = apply(Convolution::correlation(weights, divisor, offset).unwrap(), &picture);
        prop_assert_eq!(made, oracle::correlation(&picture, &kernel, d, o));

        let [across, [a, b, c, ..], _] = weights;
        let down = [a, b, c];
        let made = apply(Separable::new(across, down, divisor, offset).unwrap(), &picture);
        prop_assert_eq!(made, oracle::convolution(&picture, &oracle::product(&wide(down), &wide(across)), d, o));
    }
}
