//! Pictures on the host: from the bytes of a frame, from files and to files.
//!
//! The map, in data-flow order:
//!
//! | file | what lives there |
//! |---|---|
//! | `encode` | a picture to the bytes of a frame, as DMA would write them |
//! | `demosaic` | a mosaic to colours |
//! | `decode` | the bytes of a frame to a picture, what is missing marked |
//! | `crc` | the checksum of a frame |
//! | `file` | PNG and JPEG in; PNG and raw frames out, never half-written |

mod encode;
mod demosaic;
mod decode;
mod crc;
mod file;

pub use crc::{crc32, crc32_after, crc32_of};
pub use decode::{Decoded, decode};
pub(crate) use demosaic::demosaic;
pub use encode::encode;
pub use file::{PictureError, read, write_pieces, write_png, write_raw};

/// A picture and a profile of different sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the picture is {} × {} pixels and the profile's frame {} × {}; scale the picture or change `width` and `height`",
    picture.0, picture.1, frame.0, frame.1
)]
pub struct SizeError {
    /// The picture's width and height.
    pub picture: (u32, u32),
    /// The frame's.
    pub frame: (u32, u32),
}
