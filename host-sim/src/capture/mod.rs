//! Real cameras: their frames become pictures, files and traces.
//!
//! ```text
//! list, choose ─► v4l2, libcamera ─► CaptureDevice ─► session ─► queue ─► output ─► PNG, raw, --op, trace
//!                                        ▲    frames in the device's memory    │
//!                                        └───────────── given back ────────────┘
//! ```
//!
//! | file | what lives there |
//! |---|---|
//! | `device` | [`CaptureDevice`] and [`Captured`]: what a camera is here; what it is asked for and offers |
//! | `v4l2` | cameras of the Linux kernel |
//! | `libcamera` | cameras that need more than a kernel, with the feature of that name |
//! | `layout` | how pixels stand in memory, by V4L2's codes |
//! | `convert` | [`Converter`]: a frame in memory becomes a picture |
//! | `statistics` | what came of the frames: gaps, errors |
//! | `session` | [`capture`]: the loop from device to output, which never lets the device wait |
//! | `output` | [`Output`]: files, pipelines, a trace |
//! | `cpu` | processor time of a thread |
//! | `error` | why frames do not come |

mod error;
mod layout;
mod device;
mod convert;
mod statistics;
mod cpu;
mod output;
mod session;
#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
pub mod v4l2;
#[cfg(all(target_os = "linux", feature = "libcamera"))]
pub mod libcamera;
#[cfg(test)]
mod fake;

pub use convert::{Converter, FrameFault};
pub use device::{
    CaptureDevice, Captured, Found, FoundFormat, FoundSize, FrameFormat, Opened, Settings, YuvMeaning,
};
pub use error::CaptureError;
pub use layout::{Layout, Packed, Planar, Samples, Space};
pub use output::{Files, Output, Written};
pub use session::{Limits, Session, capture};
pub use statistics::Statistics;
