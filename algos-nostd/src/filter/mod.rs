//! Smoothing, convolution, rank filters, morphology, sharpening and scaling.

pub mod scale;
