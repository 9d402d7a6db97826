//! Smoothing, convolution, rank filters, morphology, sharpening and scaling.
//!
//! | filter | what it does | made of |
//! |---|---|---|
//! | [`Mean`] | mean over a box, any odd size at one cost | running sums |
//! | [`Gaussian3`] | `[1 2 1]` both ways, σ ≈ 0.85 | 16-bit sums, exact |
//! | [`Gaussian5`] | the integer kernel 1/159 for σ = 1.4 | three folded row sums, exact |
//! | [`Gaussian`] | any odd size and σ; [`Gaussian::SEVEN`] | separable weights of 1/256, exact |
//! | [`Convolution`], [`Separable`] | any kernel of 16-bit weights, a divisor, an offset | 32-bit sums, exact |
//! | [`Median3`], [`Median5`] | the middle value | exchange networks |
//! | [`Bilateral`] | smooths, and leaves edges | one table, 64-bit sums |
//! | [`Morphology`], [`open`], [`close`] | erode, dilate, gradient; square, cross or any mask | minima and maxima |
//! | [`Unsharp`] | sharpens: amount, radius, threshold | [`Gaussian`], in the same pass |
//! | [`Difference`] | what a filter takes away: top-hats | a ring of lines |
//! | [`Channels`] | any of these on colour, a channel at a time | three filters |
//!
//! Each is a [`RowKernel`], a function from a few rows to one, which [`Neighbourhood`] makes a
//! [`LineFilter`](crate::lines::LineFilter) over memory that the caller lends. A whole-frame function is that filter
//! run over the rows:
//!
//! ```
//! use algos_nostd::filter::{Gaussian5, Gaussian5Filter, Neighbourhood};
//! use algos_nostd::image::{Image, ImageMut};
//! use algos_nostd::lines::run;
//!
//! let pixels = [[7u8; 16]; 9];
//! let mut smooth = [0; 16 * 9];
//! let mut memory = [0; Gaussian5Filter::memory(16)];
//! let mut filter = Neighbourhood::new(Gaussian5, 16, &mut memory)?;
//! run(&mut filter, Image::new(pixels.as_flattened(), 16, 9)?, &mut ImageMut::new(&mut smooth, 16, 9)?)?;
//! assert_eq!(smooth, [7; 16 * 9]);
//! # Ok::<(), algos_nostd::image::Error>(())
//! ```
//!
//! **Border.** Beyond the edge lies the nearest pixel of the picture, for every filter here, also between the two halves
//! of an opening or closing. [`Window`](crate::lines::Window) sees to it.
//!
//! **Rounding.** Linear filters compute their sum exactly and round once, to nearest, halves up.
//!
//! **Lanes.** Rows are worked on in strips of fixed length, in the narrowest integers that hold the exact sum, so that
//! a compiler finds vector instructions; with the `std` feature AVX-512 or AVX2 is chosen when the program runs,
//! where there is one. The output is the same.

mod neighbourhood;
mod strips;
mod sums;
mod weights;
mod reciprocal;
mod normalize;
mod box_mean;
mod gaussian3;
mod gaussian5;
mod gaussian;
mod convolution;
mod median3;
mod median5;
mod bilateral;
mod morphology;
mod unsharp;
mod difference;
mod channels;
pub mod scale;

pub use bilateral::{Bilateral, BilateralFilter};
pub use box_mean::{Mean, MeanFilter};
pub use channels::Channels;
pub use convolution::{Convolution, ConvolutionFilter, Separable, SeparableFilter};
pub use difference::{Difference, Order};
pub use gaussian::{Gaussian, GaussianFilter};
pub(crate) use gaussian3::gaussian3_sums;
pub use gaussian3::{Gaussian3, Gaussian3Filter, gaussian3_row};
pub(crate) use gaussian5::gaussian5_sums;
pub use gaussian5::{Gaussian5, Gaussian5Filter, gaussian5_row};
pub use median3::{Median3, Median3Filter};
pub use median5::{Median5, Median5Filter};
pub use morphology::{Mask, Morphology, MorphologyFilter, MorphologyPair, Operation, close, open};
pub use neighbourhood::{Neighbourhood, RowKernel};
pub(crate) use sums::Finish;
pub use unsharp::{Unsharp, UnsharpFilter};
