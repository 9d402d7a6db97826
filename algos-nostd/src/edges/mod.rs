//! Gradients, edge detectors, and from edge maps to curves.
//!
//! ```text
//! gray ──► gradient ──► measure                                    magnitudes and directions to look at
//!   │
//!   └────► smooth ──┬─► suppress ──► hysteresis ──┬─► thin ──► trace ──► simplify
//!                   └─► zero crossings ───────────┘
//!          lines, 16 bits            maps, one bit a pixel              points
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | [`gradient`] | central differences, Roberts, Prewitt, Sobel, Scharr as line filters |
//! | [`measure`] | what is made of a gradient: the pair, L1, L2, four or eight directions |
//! | [`smooth`] | smoothing that keeps the fraction, for the detectors |
//! | `suppress` | non-maximum suppression of a row, in exact directions: [`Marks`] |
//! | `canny_lines` | [`CannyLines`]: the part of Canny that needs a window of lines |
//! | `hysteresis` | [`grow`]: the part that needs the frame, as bits |
//! | `canny` | [`canny()`]: both |
//! | `zero_crossing` | [`ZeroCrossings`]: Marr and Hildreth's edges as a line filter |
//! | `bits` | [`BitMap`], [`BitMapMut`]: maps of one bit a pixel |
//! | `thin` | [`thin()`]: Zhang–Suen, Guo–Hall, and side by side |
//! | `trace` | [`trace()`]: chains of pixels, piece by piece |
//! | `simplify` | [`simplify()`]: Ramer–Douglas–Peucker |
//!
//! Line filters take a fixed number of rows; what takes a map says so. `carve` cuts lent memory into rows.

pub mod gradient;
pub mod measure;
pub mod smooth;
mod suppress;
mod canny_lines;
mod hysteresis;
mod canny;
mod zero_crossing;
mod bits;
mod thin;
mod trace;
mod simplify;
mod carve;

pub use bits::{BitMap, BitMapMut, PIXELS_A_WORD, unpack, words_a_line, words_a_map};
pub use canny::{CannyConfig, CannySmoothing, canny, canny_memory};
pub use canny_lines::{CannyLines, Norm, Thresholds};
pub use gradient::{Gradient, GradientFilter, Operator};
pub use hysteresis::grow;
pub use measure::Measure;
pub use simplify::{simplify, simplify_memory};

pub use crate::image::Point;
pub use suppress::Marks;
pub use thin::{Thinning, thin, thin_memory};
pub use trace::{Curve, trace};
pub use zero_crossing::ZeroCrossings;
