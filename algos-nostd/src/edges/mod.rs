//! Gradients, edge detectors, and from edge maps to curves.

mod bits;
mod canny;
mod canny_lines;
mod carve;
pub mod gradient;
mod hysteresis;
pub mod measure;
pub mod smooth;
mod suppress;

pub use bits::{BitMap, BitMapMut, PIXELS_A_WORD, unpack, words_a_line, words_a_map};
pub use canny::{CannyConfig, CannySmoothing, canny, canny_memory};
pub use canny_lines::{CannyLines, Norm, Thresholds};
pub use gradient::{Gradient, GradientFilter, Operator};
pub use hysteresis::grow;
pub use measure::Measure;
pub use suppress::Marks;
