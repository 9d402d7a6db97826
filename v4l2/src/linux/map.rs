//! The one mapping.
#![allow(unsafe_code, reason = "this is where the driver's memory is mapped; see the argument at each")]

use std::ffi::c_void;
use std::os::fd::BorrowedFd;
use std::ptr::NonNull;

use rustix::io::Errno;
use rustix::mm::{MapFlags, ProtFlags, mmap, munmap};

/// A plane of a buffer, mapped to be read.
#[derive(Debug)]
pub(crate) struct Map {
    start: NonNull<c_void>,
    length: usize,
}

// SAFETY: the memory belongs to the process, not to a thread, and is only read.
unsafe impl Send for Map {}
// SAFETY: as above.
unsafe impl Sync for Map {}

impl Map {
    /// Maps `length` bytes at the offset that the driver gave for a buffer.
    pub(crate) fn new(device: BorrowedFd<'_>, offset: usize, length: usize) -> Result<Self, Errno> {
        // SAFETY: without an address asked for, the kernel takes a place where nothing else is.
        let start = unsafe {
            mmap(std::ptr::null_mut(), length, ProtFlags::READ, MapFlags::SHARED, device, offset as u64)?
        };
        let start = NonNull::new(start).ok_or(Errno::NOMEM)?;
        Ok(Self { start, length })
    }

    /// Bytes of it.
    pub(crate) fn len(&self) -> usize {
        self.length
    }

    /// The bytes.
    ///
    /// They may change while the buffer is the driver's: callers hold it while they hold the slice.
    pub(crate) fn bytes(&self) -> &[u8] {
        // SAFETY: `length` bytes are mapped at `start` until `drop`. The callers, `Buffer` alone, have got the buffer from
        // the driver and have not given it back, so nobody writes.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr().cast(), self.length) }
    }
}

impl Drop for Map {
    fn drop(&mut self) {
        // SAFETY: mapped by `new`, and no slice of it outlives `self`. It can fail only for a range that is none.
        let _ = unsafe { munmap(self.start.as_ptr(), self.length) };
    }
}
