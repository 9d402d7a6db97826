//! From balanced pixels to what is wanted.

use algos_nostd::edges::GradientFilter;
use algos_nostd::edges::gradient::Sobel;
use algos_nostd::edges::measure::{L1, Saturated};
use algos_nostd::filter::{Gaussian3, Gaussian3Filter, Gaussian5, Gaussian5Filter, Neighbourhood};
use algos_nostd::image::{Error, Rgb};
use algos_nostd::lines::LineFilter;
use algos_nostd::pixel::gray8;
use algos_nostd::quantize::{ApplyPalette, InverseMap, Nearest};

use super::Product;
use super::edges::Edges;
use super::memory::Memory;
use super::settings::{MAP_BITS, Output, Smoothing};

type Gradient<'m> = GradientFilter<'m, Sobel, Saturated<L1>>;

/// The stages behind the balance.
#[derive(Debug)]
pub(super) enum Tail<'m> {
    Color,
    Palette(ApplyPalette<'m, InverseMap<'m, MAP_BITS>>),
    Gray(&'m mut [u8], Smooth<'m>),
    Sobel(&'m mut [u8], Smooth<'m>, Gradient<'m>),
    Canny(&'m mut [u8], Edges<'m>),
}

/// A smoothing filter, or none.
#[derive(Debug)]
pub(super) enum Smooth<'m> {
    None,
    Gaussian3(Gaussian3Filter<'m>),
    Gaussian5(Gaussian5Filter<'m>),
}

impl<'m> Smooth<'m> {
    fn new(smoothing: Smoothing, width: usize, memory: &mut Memory<'m>) -> Result<Self, Error> {
        Ok(match smoothing {
            Smoothing::None => Self::None,
            Smoothing::Gaussian3 => {
                let lent = memory.bytes(Gaussian3Filter::memory(width))?;
                Self::Gaussian3(Neighbourhood::new(Gaussian3, width, lent)?)
            }
            Smoothing::Gaussian5 => {
                let lent = memory.bytes(Gaussian5Filter::memory(width))?;
                Self::Gaussian5(Neighbourhood::new(Gaussian5, width, lent)?)
            }
        })
    }

    fn push(&mut self, line: &[u8], sink: &mut impl FnMut(&[u8])) -> Result<(), Error> {
        match self {
            Self::None => {
                sink(line);
                Ok(())
            }
            Self::Gaussian3(filter) => filter.push(line, sink),
            Self::Gaussian5(filter) => filter.push(line, sink),
        }
    }

    fn finish(&mut self, sink: &mut impl FnMut(&[u8])) {
        match self {
            Self::None => {}
            Self::Gaussian3(filter) => filter.finish(sink),
            Self::Gaussian5(filter) => filter.finish(sink),
        }
    }
}

impl<'m> Tail<'m> {
    pub(super) fn new(
        output: Output<'m>,
        width: usize,
        height: usize,
        memory: &mut Memory<'m>,
    ) -> Result<Self, Error> {
        Ok(match output {
            Output::Color => Self::Color,
            Output::Palette(palette) => {
                let nearest = Nearest::new(palette.colors, palette.probes)?;
                let map = InverseMap::new(nearest, memory.words(InverseMap::<MAP_BITS>::cells())?)?;
                Self::Palette(ApplyPalette::new(width, map, memory.bytes(width)?)?)
            }
            Output::Gray(smoothing) => {
                Self::Gray(memory.bytes(width)?, Smooth::new(smoothing, width, memory)?)
            }
            Output::Sobel(smoothing) => {
                let gray = memory.bytes(width)?;
                let smooth = Smooth::new(smoothing, width, memory)?;
                let lent = memory.bytes(Gradient::memory(width))?;
                Self::Sobel(gray, smooth, Gradient::new(width, lent, memory.bytes(width)?)?)
            }
            Output::Canny(smoothing, thresholds) => {
                let gray = memory.bytes(width)?;
                Self::Canny(gray, Edges::new(smoothing, thresholds, (width, height), memory)?)
            }
        })
    }

    pub(super) fn push(&mut self, pixels: &[Rgb], sink: &mut impl FnMut(Product<'_>)) -> Result<(), Error> {
        match self {
            Self::Color => {
                sink(Product::Color(pixels));
                Ok(())
            }
            Self::Palette(apply) => apply.push(pixels, &mut |line: &[u8]| sink(Product::Indices(line))),
            Self::Gray(gray, smooth) => {
                gray8::encode_line(pixels, gray)?;
                smooth.push(gray, &mut |line| sink(Product::Gray(line)))
            }
            Self::Sobel(gray, smooth, gradient) => {
                gray8::encode_line(pixels, gray)?;
                let mut result = Ok(());
                smooth.push(gray, &mut |line| {
                    let pushed = gradient.push(line, &mut |line: &[u8]| sink(Product::Gray(line)));
                    result = result.and(pushed);
                })?;
                result
            }
            Self::Canny(gray, edges) => {
                gray8::encode_line(pixels, gray)?;
                edges.push(gray)
            }
        }
    }

    pub(super) fn finish(&mut self, sink: &mut impl FnMut(Product<'_>)) {
        match self {
            Self::Color => {}
            Self::Palette(apply) => apply.finish(&mut |line: &[u8]| sink(Product::Indices(line))),
            Self::Gray(_, smooth) => smooth.finish(&mut |line| sink(Product::Gray(line))),
            Self::Sobel(_, smooth, gradient) => {
                let sink = &mut |line: &[u8]| sink(Product::Gray(line));
                // The filters were made for one width, so the second takes what the first gives.
                smooth.finish(&mut |line| _ = gradient.push(line, sink));
                gradient.finish(sink);
            }
            Self::Canny(_, edges) => edges.finish(&mut |line| sink(Product::Edges(line))),
        }
    }
}
