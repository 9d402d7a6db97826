//! Demosaic: RAW samples of a Bayer sensor become pixels.
//!
//! | module | reach | lines held | what it is for |
//! |---|---|---|---|
//! | [`bilinear`] | 3×3 | 3 | previews, small cores |
//! | [`malvar`] | 5×5 | 5 | pictures: twice the additions, and some 4 dB better on textures |
//!
//! Both are line filters from samples (`u8`, or right-aligned `u16`) to 8-bit [`crate::image::Rgb`]. At the picture's edges the mosaic is
//! mirrored about its outermost line and column, which keeps its colours in order.

mod window;

pub mod bilinear;
pub mod malvar;

pub use window::Sample;
