//! Scaling to any size, line by line.
//!
//! | module | what a pixel becomes | what it is for |
//! |---|---|---|
//! | [`box_area`] | the exact mean of the area that it covers | making smaller |
//! | [`bilinear`] | a weighing of its four nearest | making larger, or slightly smaller |
//!
//! Both take lines of gray or of [`Rgb`] and know both sizes beforehand. If a frame ends early, its last line is taken for
//! the missing ones; lines beyond its height are left out.

pub mod box_area;
pub mod bilinear;

use crate::image::{Error, Rgb};
use rgb::bytemuck::Pod;

/// A pixel of one or more bytes that are scaled each by itself: gray or [`Rgb`].
pub trait Bytes: Pod + private::Sealed {
    /// Bytes a pixel.
    const CHANNELS: usize;
}

impl Bytes for u8 {
    const CHANNELS: usize = 1;
}

impl Bytes for Rgb {
    const CHANNELS: usize = 3;
}

mod private {
    pub trait Sealed {}
    impl Sealed for u8 {}
    impl Sealed for super::Rgb {}
}

/// From one size to another, as (width, height) in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Of the lines that go in.
    pub from: (usize, usize),
    /// Of the lines that come out.
    pub to: (usize, usize),
}

impl Sizes {
    /// The largest side, in pixels: what arithmetic in 32 bits allows.
    pub const LIMIT: usize = 4096;

    fn check(&self) -> Result<(), Error> {
        for (width, height) in [self.from, self.to] {
            if width == 0 || height == 0 {
                return Err(Error::ZeroSize { width, height });
            }
            let side = width.max(height);
            if side > Self::LIMIT {
                return Err(Error::Parameter {
                    name: "sizes",
                    got: i64::try_from(side).unwrap_or(i64::MAX),
                    allowed: "at most 4096 pixels a side",
                });
            }
        }
        Ok(())
    }
}

fn check_at_least(name: &'static str, expected: usize, got: usize) -> Result<(), Error> {
    if got < expected { Err(Error::BufferLength { name, expected, got }) } else { Ok(()) }
}
