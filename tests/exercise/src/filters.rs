//! Neighbourhoods: smoothing, medians, morphology, scaling.

use algos_nostd::filter::scale::Sizes;
use algos_nostd::filter::scale::bilinear::BilinearScale;
use algos_nostd::filter::scale::box_area::BoxScale;
use algos_nostd::filter::{
    Bilateral, Channels, Convolution, Difference, Gaussian, Gaussian3, Gaussian5, Mask, Mean, Median3,
    Median3Filter, Median5, Morphology, Neighbourhood, Operation, Order, RowKernel, Separable, Unsharp,
    close, open,
};
use algos_nostd::image::{Error, Image, ImageMut, Rgb};
use algos_nostd::lines::{LineFilter, run};
use algos_nostd::pixel::rgb888;

use crate::over::{over, over_bytes};
use crate::report::{Clock, Done, Exercise, Unit::Pixel};
use crate::space::{HEIGHT, PIXELS, WIDTH, Workspace, gray_view, view};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise { name: "gaussian 3x3", unit: Pixel, run: |s, c| gray(s, c, Ok(Gaussian3)) },
    Exercise { name: "gaussian 5x5", unit: Pixel, run: |s, c| gray(s, c, Ok(Gaussian5)) },
    Exercise { name: "gaussian 7x7", unit: Pixel, run: |s, c| gray(s, c, Ok(Gaussian::SEVEN)) },
    Exercise { name: "gaussian 15x15", unit: Pixel, run: |s, c| gray(s, c, Gaussian::<15>::new(2500)) },
    Exercise { name: "mean 3x3", unit: Pixel, run: mean::<3> },
    Exercise { name: "mean 15x15", unit: Pixel, run: mean::<15> },
    Exercise {
        name: "convolution 3x3",
        unit: Pixel,
        run: |s, c| gray(s, c, Convolution::new([[1, 2, 1], [2, 4, 2], [-1, -2, -1]], 8, 0)),
    },
    Exercise {
        name: "separable 5x5",
        unit: Pixel,
        run: |s, c| gray(s, c, Separable::new([1, 4, 6, 4, 1], [1, 4, 6, 4, 1], 256, 0)),
    },
    Exercise { name: "median 3x3", unit: Pixel, run: |s, c| gray(s, c, Ok(Median3)) },
    Exercise { name: "median 5x5", unit: Pixel, run: |s, c| gray(s, c, Ok(Median5)) },
    Exercise { name: "median 3x3 of rgb", unit: Pixel, run: median_rgb },
    Exercise { name: "bilateral 5x5", unit: Pixel, run: bilateral },
    Exercise { name: "erosion 3x3", unit: Pixel, run: |s, c| gray(s, c, erosion::<3>()) },
    Exercise { name: "erosion 15x15", unit: Pixel, run: |s, c| gray(s, c, erosion::<15>()) },
    Exercise {
        name: "morphological gradient, cross",
        unit: Pixel,
        run: |s, c| gray(s, c, Morphology::<3, 3>::new(Operation::Gradient, Mask::Cross)),
    },
    Exercise { name: "opening 3x3", unit: Pixel, run: opening },
    Exercise { name: "closing 3x3", unit: Pixel, run: closing },
    Exercise { name: "top hat 3x3", unit: Pixel, run: top_hat },
    Exercise { name: "unsharp 5x5", unit: Pixel, run: |s, c| gray(s, c, Unsharp::<5>::new(150, 1400, 3)) },
    Exercise { name: "scale to half, box", unit: Pixel, run: halve },
    Exercise { name: "scale to half, box, rgb", unit: Pixel, run: halve_rgb },
    Exercise { name: "scale up, bilinear", unit: Pixel, run: enlarge },
];

fn gray<K: RowKernel<N>, const N: usize>(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    kernel: Result<K, Error>,
) -> Result<Done, Error> {
    let filter = kernel.and_then(|kernel| Neighbourhood::new(kernel, WIDTH, &mut space.memory));
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

fn erosion<const SIZE: usize>() -> Result<Morphology<SIZE, SIZE>, Error> {
    Morphology::new(Operation::Erode, Mask::Rectangle)
}

fn mean<const SIZE: usize>(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let kernel = Mean::<SIZE>::new(WIDTH, &mut space.half_memory);
    let filter = kernel.and_then(|kernel| Neighbourhood::new(kernel, WIDTH, &mut space.memory));
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

fn median_rgb(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let (red, rest) = space.memory.split_at_mut(Median3Filter::memory(WIDTH));
    let (green, blue) = rest.split_at_mut(Median3Filter::memory(WIDTH));
    let filters = [
        Neighbourhood::new(Median3, WIDTH, red)?,
        Neighbourhood::new(Median3, WIDTH, green)?,
        Neighbourhood::new(Median3, WIDTH, blue)?,
    ];
    let filter = Channels::new(filters, WIDTH, &mut space.line);
    over(filter, view(&space.picture)?, &mut space.pixels, clock)?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn bilateral(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let kernel = Bilateral::<5>::new(2000, 25_000, &mut space.long_memory);
    let filter = kernel.and_then(|kernel| Neighbourhood::new(kernel, WIDTH, &mut space.memory));
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

fn opening(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let filter = open::<3, 3>(Mask::Rectangle, WIDTH, &mut space.memory);
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

fn closing(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let filter = close::<3, 3>(Mask::Rectangle, WIDTH, &mut space.memory);
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

/// The picture less its opening.
fn top_hat(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let (first, second) = space.memory.split_at_mut(32 * WIDTH);
    let filter = open::<3, 3>(Mask::Rectangle, WIDTH, first)
        .and_then(|opening| Difference::new(opening, Order::InputMinusOutput, WIDTH, second));
    over_bytes(filter, gray_view(&space.gray)?, &mut space.bytes, clock)
}

const HALF: Sizes = Sizes { from: (WIDTH, HEIGHT), to: (WIDTH / 2, HEIGHT / 2) };

/// Runs a filter that changes the size, and counts in pixels that go in.
fn resize<P: Copy, F: LineFilter<Input = P, Output = P>>(
    filter: Result<F, Error>,
    input: Image<'_, P>,
    output: &mut ImageMut<'_, P>,
    clock: &mut dyn Clock,
) -> Result<(), Error> {
    let mut filter = filter?;
    clock.start();
    let result = run(&mut filter, input, output);
    clock.stop();
    result
}

fn halve(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let out = &mut space.bytes[..PIXELS / 4];
    let filter = BoxScale::new(HALF, &mut space.word_memory, &mut space.byte_line);
    resize(filter, gray_view(&space.gray)?, &mut ImageMut::new(out, HALF.to.0, HALF.to.1)?, clock)?;
    Ok(Done::new(PIXELS, out))
}

fn halve_rgb(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let out: &mut [Rgb] = &mut space.pixels[..PIXELS / 4];
    let filter = BoxScale::new(HALF, &mut space.word_memory, &mut space.line);
    resize(filter, view(&space.picture)?, &mut ImageMut::new(out, HALF.to.0, HALF.to.1)?, clock)?;
    Ok(Done::new(PIXELS, rgb888::as_bytes(out)))
}

fn enlarge(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    let sizes = Sizes { from: (WIDTH, HEIGHT), to: (WIDTH * 3 / 2, HEIGHT * 3 / 2) };
    let pixels = sizes.to.0 * sizes.to.1;
    let out = &mut space.bytes[..pixels];
    let filter = BilinearScale::new(sizes, &mut space.half_memory, &mut space.byte_line);
    resize(filter, gray_view(&space.gray)?, &mut ImageMut::new(out, sizes.to.0, sizes.to.1)?, clock)?;
    Ok(Done::new(pixels, out))
}
