//! Smoothing, convolution, rank filters, morphology, sharpening and scaling.
