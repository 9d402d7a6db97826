//! Smoothing, convolution, rank filters, morphology, sharpening and scaling.

mod neighbourhood;
mod strips;
mod weights;
mod reciprocal;
mod normalize;
mod convolution;
mod box_mean;
mod gaussian;
mod gaussian3;
mod gaussian5;
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
pub use gaussian3::{Gaussian3, Gaussian3Filter, gaussian3_row};
pub use gaussian5::{Gaussian5, Gaussian5Filter, gaussian5_row};
pub use median3::{Median3, Median3Filter};
pub use median5::{Median5, Median5Filter};
pub use morphology::{Mask, Morphology, MorphologyFilter, MorphologyPair, Operation, close, open};
pub use neighbourhood::{Neighbourhood, RowKernel};
pub use unsharp::{Unsharp, UnsharpFilter};
