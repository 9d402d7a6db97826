//! Borrowed views of pixels and the errors of the crate: what everything else stands on.

mod error;
mod view;

pub mod geometry;
#[cfg(feature = "embedded-graphics")]
pub mod embedded_graphics;

pub use error::Error;
pub use view::{Image, ImageMut};

/// A pixel of red, green and blue, 8 bits each, in this order in memory.
pub type Rgb = rgb::Rgb<u8>;
