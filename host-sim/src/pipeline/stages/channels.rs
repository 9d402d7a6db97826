use algos_nostd::filter::{Channels, Neighbourhood, RowKernel};
use algos_nostd::image::{Error, Rgb};
use algos_nostd::lines::LineFilter;

use crate::pipeline::picture::Picture;

/// A gray filter on gray, or one of the three on each channel.
pub(super) fn each_channel<F>(picture: &Picture, filters: [F; 3]) -> Result<Picture, Error>
where
    F: LineFilter<Input = u8, Output = u8>,
{
    let (width, height) = picture.size();
    match picture {
        Picture::Gray(frame) => {
            let [mut filter, ..] = filters;
            Ok(frame.through(&mut filter, (width, height))?.into())
        }
        Picture::Rgb(frame) => {
            let mut memory = vec![Rgb::default(); Channels::<F>::memory(width)];
            let mut filter = Channels::new(filters, width, &mut memory)?;
            Ok(frame.through(&mut filter, (width, height))?.into())
        }
    }
}

/// A neighbourhood's kernel on gray, or one of the three on each channel.
pub(super) fn neighbourhood<K, const LINES: usize>(
    picture: &Picture,
    kernels: [K; 3],
) -> Result<Picture, Error>
where
    K: RowKernel<LINES>,
{
    let width = picture.size().0;
    let length = Neighbourhood::<K, LINES>::memory(width);
    let mut memory = vec![0; 3 * length];
    let (red, rest) = memory.split_at_mut(length);
    let (green, blue) = rest.split_at_mut(length);
    let [a, b, c] = kernels;
    let filters = [
        Neighbourhood::new(a, width, red)?,
        Neighbourhood::new(b, width, green)?,
        Neighbourhood::new(c, width, blue)?,
    ];
    each_channel(picture, filters)
}

/// Work that is written for a size known when it is compiled.
pub(super) trait AnySize {
    /// Does it for that size.
    fn run<const SIZE: usize>(self) -> Result<Picture, Error>;
}

/// The sizes of [`with_size`].
pub(super) const SIZES: &[i64] = &[3, 5, 7, 9, 11, 15, 21, 31];

/// Does work for one of [`SIZES`].
pub(super) fn with_size(size: usize, work: impl AnySize) -> Result<Picture, Error> {
    match size {
        3 => work.run::<3>(),
        5 => work.run::<5>(),
        7 => work.run::<7>(),
        9 => work.run::<9>(),
        11 => work.run::<11>(),
        15 => work.run::<15>(),
        21 => work.run::<21>(),
        31 => work.run::<31>(),
        _ => {
            Err(Error::Parameter { name: "size", got: size as i64, allowed: "3, 5, 7, 9, 11, 15, 21 or 31" })
        }
    }
}
