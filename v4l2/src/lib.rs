//! Video4Linux2 capture devices: what they offer, their settings, and frames in mapped memory.
//!
//! ```text
//! open ─► input ─► formats ─► format ─► interval ─► crop ─► controls ─► Stream ─► Buffer ─► given back when dropped
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `four_cc` | [`FourCc`]: the names of pixel formats |
//! | `device` | [`Device`]: open and list devices, what they are, their inputs |
//! | `format` | pixel formats, sizes, frame intervals; listed, asked for and granted |
//! | `selection` | the part of the sensor that is captured |
//! | `control` | brightness, exposure, test pattern…: listed, read and set, by name |
//! | `stream` | [`Stream`] and [`Buffer`]: frames in memory that the driver wrote, nothing copied |
//! | `error` | [`Error`]: what was asked of the device, and what it answered |
//! | `raw`, `call`, `map` | the kernel's structures; the one ioctl; the one mapping |
//!
//! Both kinds of devices are known, those whose buffers are one piece and those whose pixel planes are apart
//! (`V4L2_CAP_VIDEO_CAPTURE_MPLANE`).
//!
//! **Why not a crate.** `v4l` and `v4l2r` run bindgen at build time and so need libclang. `linux-video` does not, but
//! has no timeout (it dequeues blockingly, inside the call that also queues and starts), does not wrap selections, and
//! reads what the kernel writes as Rust enumerations, which is undefined for a value that a newer kernel knows.
//! `moq-v4l` panics on a control type that it does not know, on names that are not UTF-8, and in `drop`. What is left
//! is small: structures of numbers, one call, one mapping.
//!
//! **`unsafe`** stands in `call` and `map` only, and has three arguments. *The call*: the kernel copies exactly as many
//! bytes as the request's number says; the number is made from the type of the argument, and every such type consists
//! of integers, for which all bit patterns are values. *Pointers in arguments* (planes, control payloads) point to
//! slices that are borrowed over the call and whose length stands beside them. *Mapped memory* is only ever read, lives as long as
//! whoever holds a [`Buffer`], and is lent out from the moment the kernel gives it back until it is queued again, in
//! which time the driver does not write to it.
//!
//! Linux on 64-bit machines only: elsewhere there are but the names of formats.

mod four_cc;

pub use four_cc::FourCc;

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
mod linux {
    pub(crate) mod raw;
    pub(crate) mod call;
    pub(crate) mod map;
    pub(crate) mod error;
    pub(crate) mod device;
    pub(crate) mod format;
    pub(crate) mod selection;
    pub(crate) mod control;
    pub(crate) mod stream;
}

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
pub use linux::{
    control::{Control, ControlKind, MenuItem, Value},
    device::{Capability, Device, Input, device_paths},
    error::Error,
    format::{Format, Interval, PixelFormat, PlaneLayout, Sizes},
    selection::{Rectangle, Target},
    stream::{Buffer, Stream},
};
