//! Frame buffers in a section of their own, `.frames`, which a board's linker script puts within the DMA's reach.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

/// Memory of `N` frames of `WORDS` words each. Nothing initializes it before the program runs.
#[repr(C, align(32))]
pub struct FrameMemory<const WORDS: usize, const N: usize>(UnsafeCell<MaybeUninit<[[u32; WORDS]; N]>>);

// SAFETY: nothing but `claim` looks inside, and its caller promises to call it once.
unsafe impl<const WORDS: usize, const N: usize> Sync for FrameMemory<WORDS, N> {}

impl<const WORDS: usize, const N: usize> FrameMemory<WORDS, N> {
    /// Memory of unknown content.
    #[must_use]
    pub const fn new() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// The frames, zeroed.
    ///
    /// # Safety
    /// Called once.
    #[expect(
        clippy::mut_from_ref,
        reason = "called once: there is no second reference by the caller's promise"
    )]
    pub unsafe fn claim(&'static self) -> [&'static mut [u32]; N] {
        let memory = self.0.get();
        // SAFETY: the memory is a static's, and the caller promises that nobody else has it.
        unsafe { memory.write_bytes(0, 1) };
        // SAFETY: the only reference, by the caller's promise.
        let memory = unsafe { &mut *memory };
        // SAFETY: zeroed above, and every pattern of bits is a `u32`.
        let frames = unsafe { memory.assume_init_mut() };
        frames.each_mut().map(<[u32; WORDS]>::as_mut_slice)
    }
}

impl<const WORDS: usize, const N: usize> Default for FrameMemory<WORDS, N> {
    fn default() -> Self {
        Self::new()
    }
}
