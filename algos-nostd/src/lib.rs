//! Graphics and image algorithms for microcontrollers: no heap, integers and fixed point, line by line.
//!
//! The map, in the order in which a picture flows:
//!
//! | module | what lives there |
//! |---|---|
//! | [`image`] | borrowed views of pixels with a stride, and the errors of the whole crate |
//! | [`pixel`] | pixel formats of camera buses and the conversions between them |
//! | [`lines`] | the line filter: push a line, get lines; how filters are chained and sized |
//! | [`color`] | demosaic, curves, histograms, colour balance |
//! | [`filter`] | smoothing, convolution, rank filters, morphology, scaling |
//! | [`edges`] | gradients, Canny, zero crossings, thinning, curves |
//! | [`quantize`] | palettes and dithering |
//! | [`draw`] | lines, circles, polygons, filling, compositing |
//! | [`clip`] | line and polygon clipping |
//!
//! The caller owns all memory: a `const fn` beside each filter says how much it takes. Output is bit-identical
//! on every target. Nothing here panics on bad input: constructors return [`image::Error`].
#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![forbid(unsafe_code)]
#![deny(clippy::float_arithmetic)]

pub mod image;
pub mod pixel;
pub mod lines;
pub mod color;
pub mod filter;
pub mod edges;
pub mod quantize;
pub mod draw;
pub mod clip;
