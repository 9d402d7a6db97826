//! Borrowed views of pixels and the errors of the whole crate: what everything else stands on.
//!
//! | file | what lives there |
//! |---|---|
//! | `view` | [`Image`] and [`ImageMut`]: pixels with a stride, borrowed from their owner |
//! | `point` | [`Point`]: a pixel's column and line, which may lie outside |
//! | [`geometry`] | flips, turns and crops |
//! | `error` | [`Error`]: what was expected and what was got |
//! | `embedded_graphics` | a view as a draw target, behind the feature of that name |

mod view;
mod point;
pub mod geometry;
mod error;
#[cfg(feature = "embedded-graphics")]
pub mod embedded_graphics;

pub use error::Error;
pub use point::Point;
pub use view::{Image, ImageMut};

/// A pixel of red, green and blue, 8 bits each, in this order in memory.
pub type Rgb = rgb::Rgb<u8>;
