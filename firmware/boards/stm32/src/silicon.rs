//! Access to memory-mapped registers, and to memory as the DMA sees it.

use core::sync::atomic::{Ordering, fence};

/// The chip's address space.
pub trait Silicon {
    /// Reads 32 bits.
    fn read(&mut self, address: u32) -> u32;
    /// Writes 32 bits.
    fn write(&mut self, address: u32, value: u32);
    /// The address at which the DMA finds this memory.
    fn address(&self, memory: *const u32) -> u32;

    /// All accesses to memory before it happen before all accesses behind it.
    fn fence(&mut self) {
        // DMB on Arm; and the compiler moves nothing across it.
        fence(Ordering::SeqCst);
    }
}

/// The chip itself.
#[derive(Debug)]
pub struct Mmio(());

impl Mmio {
    /// The chip itself.
    ///
    /// # Safety
    /// This runs on the chip whose addresses it will be given, DCMI and the DMA are clocked, and nobody else uses that
    /// DCMI and that stream.
    #[must_use]
    pub const unsafe fn new() -> Self {
        Self(())
    }
}

impl Silicon for Mmio {
    fn read(&mut self, address: u32) -> u32 {
        // SAFETY: `new` was promised the chip; `DcmiPort` reads addresses of its `Chip` only, which are word-aligned
        // registers of clocked peripherals that are this port's alone. No Rust object lives there.
        unsafe { (address as usize as *const u32).read_volatile() }
    }

    fn write(&mut self, address: u32, value: u32) {
        // SAFETY: as in `read`. What the stream writes by such a register is bounded in `DcmiPort`.
        unsafe { (address as usize as *mut u32).write_volatile(value) }
    }

    fn address(&self, memory: *const u32) -> u32 {
        memory.addr() as u32
    }
}
