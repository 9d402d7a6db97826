//! Runs a filter over the picture, with the clock around it.

use algos_nostd::image::{Error, Image, ImageMut};
use algos_nostd::lines::{LineFilter, run};

use crate::report::{Clock, Done};
use crate::space::{HEIGHT, PIXELS, WIDTH};

/// The lines of `input` through `filter` into `output`, of the picture's size.
pub(crate) fn over<F: LineFilter>(
    filter: Result<F, Error>,
    input: Image<'_, F::Input>,
    output: &mut [F::Output],
    clock: &mut dyn Clock,
) -> Result<(), Error>
where
    F::Output: Copy,
{
    let mut output = ImageMut::new(output, WIDTH, HEIGHT)?;
    let mut filter = filter?;
    clock.start();
    let result = run(&mut filter, input, &mut output);
    clock.stop();
    result
}

/// The same from bytes to bytes.
pub(crate) fn over_bytes<F: LineFilter<Output = u8>>(
    filter: Result<F, Error>,
    input: Image<'_, F::Input>,
    output: &mut [u8],
    clock: &mut dyn Clock,
) -> Result<Done, Error> {
    let output = &mut output[..PIXELS];
    over(filter, input, output, clock)?;
    Ok(Done::new(PIXELS, output))
}
