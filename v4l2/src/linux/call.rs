//! The one ioctl.
#![allow(unsafe_code, reason = "this is where the kernel is called; see the argument at each")]

use std::ffi::c_void;
use std::marker::PhantomData;
use std::os::fd::BorrowedFd;

use rustix::io::Errno;
use rustix::ioctl::{Ioctl, IoctlOutput, Opcode, ioctl, opcode};

use super::raw::{self, Plain};

const GROUP: u8 = b'V';

/// A request of `videodev2.h`: its number, which says how many bytes go in and out, and the name for messages.
#[derive(Debug)]
pub(crate) struct Request<T> {
    opcode: Opcode,
    pub(crate) name: &'static str,
    argument: PhantomData<T>,
}

macro_rules! requests {
    ($($constant:ident = $direction:ident($number:literal) $type:ty, $name:literal;)*) => {
        $(pub(crate) const $constant: Request<$type> = Request {
            opcode: opcode::$direction::<$type>(GROUP, $number),
            name: $name,
            argument: PhantomData,
        };)*
    };
}

requests! {
    QUERY_CAPABILITY = read(0) raw::Capability, "VIDIOC_QUERYCAP";
    ENUMERATE_FORMATS = read_write(2) raw::FormatDescription, "VIDIOC_ENUM_FMT";
    GET_FORMAT = read_write(4) raw::Format, "VIDIOC_G_FMT";
    SET_FORMAT = read_write(5) raw::Format, "VIDIOC_S_FMT";
    REQUEST_BUFFERS = read_write(8) raw::RequestBuffers, "VIDIOC_REQBUFS";
    STREAM_ON = write(18) u32, "VIDIOC_STREAMON";
    STREAM_OFF = write(19) u32, "VIDIOC_STREAMOFF";
    GET_PARAMETERS = read_write(21) raw::StreamParameters, "VIDIOC_G_PARM";
    SET_PARAMETERS = read_write(22) raw::StreamParameters, "VIDIOC_S_PARM";
    ENUMERATE_INPUTS = read_write(26) raw::Input, "VIDIOC_ENUMINPUT";
    QUERY_MENU = read_write(37) raw::QueryMenu, "VIDIOC_QUERYMENU";
    GET_INPUT = read(38) u32, "VIDIOC_G_INPUT";
    SET_INPUT = read_write(39) u32, "VIDIOC_S_INPUT";
    ENUMERATE_SIZES = read_write(74) raw::FrameSize, "VIDIOC_ENUM_FRAMESIZES";
    ENUMERATE_INTERVALS = read_write(75) raw::FrameInterval, "VIDIOC_ENUM_FRAMEINTERVALS";
    GET_SELECTION = read_write(94) raw::Selection, "VIDIOC_G_SELECTION";
    SET_SELECTION = read_write(95) raw::Selection, "VIDIOC_S_SELECTION";
    QUERY_CONTROL = read_write(103) raw::QueryControl, "VIDIOC_QUERY_EXT_CTRL";
}

/// These hold addresses, and go through the functions below only.
mod with_address {
    use super::{GROUP, PhantomData, Request, opcode, raw};
    requests! {
        QUERY_BUFFER = read_write(9) raw::Buffer, "VIDIOC_QUERYBUF";
        QUEUE_BUFFER = read_write(15) raw::Buffer, "VIDIOC_QBUF";
        DEQUEUE_BUFFER = read_write(17) raw::Buffer, "VIDIOC_DQBUF";
        GET_CONTROLS = read_write(71) raw::ExtControls, "VIDIOC_G_EXT_CTRLS";
        SET_CONTROLS = read_write(72) raw::ExtControls, "VIDIOC_S_EXT_CTRLS";
    }
}

/// Which of the requests about a buffer.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BufferRequest {
    Query,
    Queue,
    Dequeue,
}

struct Call<'a, T> {
    opcode: Opcode,
    argument: &'a mut T,
}

// SAFETY: the opcode is that of a `Request<T>`, whose size is that of `T`; so the kernel reads and writes within
// `argument`, which is borrowed exclusively, and any bytes that it leaves there are a value of a `Plain` type.
unsafe impl<T: Plain> Ioctl for Call<'_, T> {
    type Output = ();
    const IS_MUTATING: bool = true;

    fn opcode(&self) -> Opcode {
        self.opcode
    }

    fn as_ptr(&mut self) -> *mut c_void {
        std::ptr::from_mut(self.argument).cast()
    }

    unsafe fn output_from_ptr(_: IoctlOutput, _: *mut c_void) -> rustix::io::Result<()> {
        Ok(())
    }
}

/// Calls the device; begins again when a signal interrupts it.
///
/// # Safety
/// Addresses within `argument` must be those of memory that the request may use.
unsafe fn call_with_addresses<T: Plain>(
    device: BorrowedFd<'_>,
    request: &Request<T>,
    argument: &mut T,
) -> Result<(), Errno> {
    loop {
        // SAFETY: as argued at `Ioctl for Call`; the caller vouches for addresses within.
        match unsafe { ioctl(device, Call { opcode: request.opcode, argument: &mut *argument }) } {
            Err(Errno::INTR) => {}
            result => return result,
        }
    }
}

/// Calls the device with an argument that holds no address.
pub(crate) fn call<T: Plain>(
    device: BorrowedFd<'_>,
    request: &Request<T>,
    argument: &mut T,
) -> Result<(), Errno> {
    // SAFETY: the public requests have arguments without addresses.
    unsafe { call_with_addresses(device, request, argument) }
}

/// Calls the device about a buffer. Of multi-planar devices `planes` tells of each plane; for others it is not used.
pub(crate) fn call_buffer(
    device: BorrowedFd<'_>,
    request: BufferRequest,
    buffer: &mut raw::Buffer,
    planes: &mut [raw::Plane; raw::PLANES],
) -> Result<(), Errno> {
    use with_address::{DEQUEUE_BUFFER, QUERY_BUFFER, QUEUE_BUFFER};
    if buffer.kind == raw::CAPTURE_PLANES {
        buffer.m = planes.as_mut_ptr().expose_provenance();
        buffer.length = raw::PLANES as u32;
    }
    let request = match request {
        BufferRequest::Query => &QUERY_BUFFER,
        BufferRequest::Queue => &QUEUE_BUFFER,
        BufferRequest::Dequeue => &DEQUEUE_BUFFER,
    };
    // SAFETY: of multi-planar devices `m` is the address of as many planes as `length` says, borrowed exclusively over
    // the call and made of integers. Of others the kernel takes `m` as an offset and follows no address; with mapped
    // memory it follows none in a plane either.
    unsafe { call_with_addresses(device, request, buffer) }
}

/// What a control is given, or gives.
#[derive(Debug)]
pub(crate) enum Payload<'a> {
    /// A number of 32 bits, or of 64.
    Number(i64),
    /// Bytes, such as text with its end.
    Bytes(&'a mut [u8]),
}

/// Reads one control, or sets it.
pub(crate) fn call_control(
    device: BorrowedFd<'_>,
    set: bool,
    id: u32,
    is_wide: bool,
    payload: &mut Payload<'_>,
) -> Result<(), Errno> {
    let mut control = raw::ExtControl { id, ..raw::ExtControl::ZERO };
    match payload {
        Payload::Number(number) if is_wide => control.value = number.to_ne_bytes(),
        // The kernel reads the 32 bits of the union's beginning.
        Payload::Number(number) => control.value[..4].copy_from_slice(&(*number as i32).to_ne_bytes()),
        Payload::Bytes(bytes) => {
            control.size = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
            control.value = bytes.as_mut_ptr().expose_provenance().to_ne_bytes();
        }
    }
    let mut all = raw::ExtControls {
        count: 1,
        controls: std::ptr::from_mut(&mut control).expose_provenance(),
        ..raw::ExtControls::ZERO
    };
    let request = if set { &with_address::SET_CONTROLS } else { &with_address::GET_CONTROLS };
    // SAFETY: `controls` is the address of one control, as `count` says, which lives until after the call. Its payload is a
    // number in place or, for a control that has one, the address of as many borrowed bytes as `size` says; a number
    // for a control with a payload goes with a size of 0, to which the kernel answers ENOSPC or EFAULT without
    // following the number.
    unsafe { call_with_addresses(device, request, &mut all)? };
    if let Payload::Number(number) = payload {
        let [a, b, c, d, ..] = control.value;
        *number = if is_wide {
            i64::from_ne_bytes(control.value)
        } else {
            i64::from(i32::from_ne_bytes([a, b, c, d]))
        };
    }
    Ok(())
}
