//! How deep the stack went: start-up paints its memory (`paint-stack` of cortex-m-rt), and what has lost its paint was used.

use core::ptr::addr_of;

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    /// The linker's: where statics end, the lowest word that the stack may take.
    static _stack_end: u32;
    /// The linker's: one past the stack's first word.
    static _stack_start: u32;
}

/// Bytes of the stack that were used at most so far. What was reserved and never written is not seen.
#[must_use]
pub fn high_water() -> u32 {
    let (mut word, top) = (addr_of!(_stack_end), addr_of!(_stack_start));
    // SAFETY: between the two lies RAM that is aligned to words and painted, and `word` stays below `top`. The stack's own
    // part of it may change meanwhile, hence volatile; the first word in use ends the search.
    while word < top && unsafe { word.read_volatile() } == STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    (top.addr() - word.addr()) as u32
}
