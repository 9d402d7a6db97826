//! The kernel's structures on 64-bit machines, from `include/uapi/linux/videodev2.h`, and its constants.
//!
//! Unions are arrays of words, of which the accessors take what they need. Every field is an integer.

/// A structure that consists of integers, for which any bit pattern is a value.
///
/// All of them are listed in this file.
pub(crate) trait Plain: Sized {
    /// All bits zero.
    const ZERO: Self;
}

macro_rules! plain {
    ($(#[$meta:meta])* $name:ident [$size:literal] { $($(#[$field_meta:meta])* $field:ident : $type:ty = $zero:expr,)* }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name {
            $($(#[$field_meta])* pub(crate) $field: $type,)*
        }
        impl Plain for $name {
            const ZERO: Self = Self { $($field: $zero,)* };
        }
        const _: () = assert!(size_of::<$name>() == $size);
    };
}

plain! {
    /// `v4l2_capability`
    Capability [104] {
        driver: [u8; 16] = [0; 16],
        card: [u8; 32] = [0; 32],
        bus_info: [u8; 32] = [0; 32],
        version: u32 = 0,
        capabilities: u32 = 0,
        device_caps: u32 = 0,
        reserved: [u32; 3] = [0; 3],
    }
}

plain! {
    /// `v4l2_input`
    Input [80] {
        index: u32 = 0,
        name: [u8; 32] = [0; 32],
        kind: u32 = 0,
        audioset: u32 = 0,
        tuner: u32 = 0,
        standards: u64 = 0,
        status: u32 = 0,
        capabilities: u32 = 0,
        reserved: [u32; 3] = [0; 3],
        padding: u32 = 0,
    }
}

plain! {
    /// `v4l2_fmtdesc`
    FormatDescription [64] {
        index: u32 = 0,
        kind: u32 = 0,
        flags: u32 = 0,
        description: [u8; 32] = [0; 32],
        pixel_format: u32 = 0,
        mbus_code: u32 = 0,
        reserved: [u32; 3] = [0; 3],
    }
}

plain! {
    /// `v4l2_frmsizeenum`; `size` is width and height, or least, greatest and step of each.
    FrameSize [44] {
        index: u32 = 0,
        pixel_format: u32 = 0,
        kind: u32 = 0,
        size: [u32; 6] = [0; 6],
        reserved: [u32; 2] = [0; 2],
    }
}

plain! {
    /// `v4l2_frmivalenum`; `interval` is a fraction, or the least, the greatest and the step.
    FrameInterval [52] {
        index: u32 = 0,
        pixel_format: u32 = 0,
        width: u32 = 0,
        height: u32 = 0,
        kind: u32 = 0,
        interval: [u32; 6] = [0; 6],
        reserved: [u32; 2] = [0; 2],
    }
}

plain! {
    /// `v4l2_format`; `fmt` is a `v4l2_pix_format` or, of multi-planar devices, a `v4l2_pix_format_mplane`.
    Format [208] {
        kind: u32 = 0,
        padding: u32 = 0,
        fmt: [u32; 50] = [0; 50],
    }
}

plain! {
    /// `v4l2_streamparm`; `parm` is a `v4l2_captureparm`: capability, mode, numerator, denominator of the interval, …
    StreamParameters [204] {
        kind: u32 = 0,
        parm: [u32; 50] = [0; 50],
    }
}

plain! {
    /// `v4l2_selection`
    Selection [64] {
        kind: u32 = 0,
        target: u32 = 0,
        flags: u32 = 0,
        left: i32 = 0,
        top: i32 = 0,
        width: u32 = 0,
        height: u32 = 0,
        reserved: [u32; 9] = [0; 9],
    }
}

plain! {
    /// `v4l2_query_ext_ctrl`
    QueryControl [232] {
        id: u32 = 0,
        kind: u32 = 0,
        name: [u8; 32] = [0; 32],
        minimum: i64 = 0,
        maximum: i64 = 0,
        step: u64 = 0,
        default: i64 = 0,
        flags: u32 = 0,
        element_size: u32 = 0,
        elements: u32 = 0,
        dimensions: u32 = 0,
        dimension: [u32; 4] = [0; 4],
        reserved: [u32; 32] = [0; 32],
    }
}

plain! {
    /// `v4l2_querymenu`; `name` begins with the value, of integer menus.
    QueryMenu [44] {
        id: u32 = 0,
        index: u32 = 0,
        name: [u8; 32] = [0; 32],
        reserved: u32 = 0,
    }
}

plain! {
    /// `v4l2_ext_control`, which is packed; `value` is a number or the address of the payload.
    ExtControl [20] {
        id: u32 = 0,
        size: u32 = 0,
        reserved: u32 = 0,
        value: [u8; 8] = [0; 8],
    }
}

plain! {
    /// `v4l2_ext_controls`; `controls` is the address of an array of `count`.
    ExtControls [32] {
        which: u32 = 0,
        count: u32 = 0,
        error_index: u32 = 0,
        request: i32 = 0,
        reserved: u32 = 0,
        padding: u32 = 0,
        controls: usize = 0,
    }
}

plain! {
    /// `v4l2_requestbuffers`
    RequestBuffers [20] {
        count: u32 = 0,
        kind: u32 = 0,
        memory: u32 = 0,
        capabilities: u32 = 0,
        flags: [u8; 4] = [0; 4],
    }
}

plain! {
    /// `v4l2_buffer`; `m` is the offset to map at, or the address of an array of `length` planes.
    Buffer [88] {
        index: u32 = 0,
        kind: u32 = 0,
        bytes_used: u32 = 0,
        flags: u32 = 0,
        field: u32 = 0,
        padding: u32 = 0,
        seconds: i64 = 0,
        microseconds: i64 = 0,
        timecode: [u32; 4] = [0; 4],
        sequence: u32 = 0,
        memory: u32 = 0,
        m: usize = 0,
        length: u32 = 0,
        reserved: u32 = 0,
        request: i32 = 0,
        padding_end: u32 = 0,
    }
}

plain! {
    /// `v4l2_plane`; `m` is the offset to map at.
    Plane [64] {
        bytes_used: u32 = 0,
        length: u32 = 0,
        m: usize = 0,
        data_offset: u32 = 0,
        reserved: [u32; 11] = [0; 11],
    }
}

impl Plain for u32 {
    const ZERO: Self = 0;
}

/// `VIDEO_MAX_PLANES`
pub(crate) const PLANES: usize = 8;

/// `V4L2_BUF_TYPE_VIDEO_CAPTURE` and `…_MPLANE`
pub(crate) const CAPTURE: u32 = 1;
pub(crate) const CAPTURE_PLANES: u32 = 9;

/// `V4L2_MEMORY_MMAP`
pub(crate) const MAPPED: u32 = 1;

/// `V4L2_CAP_…`
pub(crate) const CAN_CAPTURE: u32 = 0x0000_0001;
pub(crate) const CAN_CAPTURE_PLANES: u32 = 0x0000_1000;
pub(crate) const CAN_STREAM: u32 = 0x0400_0000;
pub(crate) const HAS_DEVICE_CAPS: u32 = 0x8000_0000;

/// `V4L2_FIELD_NONE`
pub(crate) const PROGRESSIVE: u32 = 1;

/// `V4L2_PIX_FMT_PRIV_MAGIC`: the fields behind `priv` are meant.
pub(crate) const EXTENDED: u32 = 0xFEED_CAFE;

/// `V4L2_BUF_FLAG_ERROR`
pub(crate) const BUFFER_ERROR: u32 = 0x40;

/// `V4L2_CTRL_FLAG_NEXT_CTRL` and `…_NEXT_COMPOUND`
pub(crate) const NEXT_CONTROL: u32 = 0xC000_0000;

/// Text that ends with a zero, or with the array. What is not UTF-8 becomes U+FFFD.
pub(crate) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_ends_where_it_should() {
        assert_eq!(text(b"vivid\0\0x"), "vivid");
        assert_eq!(text(b"no end"), "no end");
        assert_eq!(text(b"\xFF\0"), "\u{FFFD}");
        assert_eq!(text(b""), "");
    }

    /// The offsets that the C compiler gives on x86-64 and AArch64.
    #[test]
    fn fields_stand_where_the_kernel_puts_them() {
        use std::mem::offset_of;
        assert_eq!([offset_of!(Input, standards), offset_of!(Input, status)], [48, 56]);
        assert_eq!([offset_of!(Format, fmt), offset_of!(StreamParameters, parm)], [8, 4]);
        assert_eq!([offset_of!(QueryControl, minimum), offset_of!(QueryControl, flags)], [40, 72]);
        assert_eq!(offset_of!(ExtControl, value), 12);
        assert_eq!(offset_of!(ExtControls, controls), 24);
        assert_eq!(
            [offset_of!(Buffer, seconds), offset_of!(Buffer, sequence), offset_of!(Buffer, m)],
            [24, 56, 64]
        );
        assert_eq!([offset_of!(Buffer, length), offset_of!(Buffer, request)], [72, 80]);
        assert_eq!([offset_of!(Plane, m), offset_of!(Plane, data_offset)], [8, 16]);
    }
}
