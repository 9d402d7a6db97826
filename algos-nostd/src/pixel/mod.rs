//! Pixel formats of camera buses and the conversions between them.
//!
//! Everything works on one line at a time and in both directions: `encode_line` makes what a sensor would send,
//! `decode_line` makes pixels of what the camera interface received. Bytes stand in the order in which they cross
//! an 8-bit bus.
//!
//! | module | format | bytes a pixel |
//! |---|---|---|
//! | [`format`] | all of them by name, with line sizes and encoding | |
//! | [`rgb888`] | red, green, blue | 3 |
//! | [`rgb565`] | 5, 6 and 5 bits in either byte order | 2 |
//! | [`gray8`] | BT.601 luma | 1 |
//! | [`yuv422`] | YUYV and UYVY, BT.601 and BT.709, full and limited range | 2 |
//! | [`bayer`] | which colour filter lies over which pixel; mosaic of a colour picture | |
//! | [`raw`] | RAW samples right-aligned in 16 bits, packed as on MIPI, brought to 8 bits | 1, 2, 5/4, 3/2 |
//! | [`black_level`] | what a sensor reads in the dark, taken off | |
//!
//! RAW samples become pixels by demosaicing, in [`crate::color`].

mod layout;

pub mod format;
pub mod rgb888;
pub mod rgb565;
pub mod gray8;
pub mod yuv422;
pub mod bayer;
pub mod raw;
pub mod black_level;

pub use layout::{BitDepth, ByteOrder};
