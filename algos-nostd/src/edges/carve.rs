//! Lent memory cut into rows of the types that a filter needs.
//!
//! A filter with rows of bytes, 16-bit sums and 32-bit magnitudes would ask its caller for as many buffers. It asks for
//! one of words instead, and cuts it up here.

/// Words that `count` elements of `size` bytes take.
pub(super) const fn words_of(count: usize, size: usize) -> usize {
    count.saturating_mul(size).div_ceil(4)
}

/// Takes `count` elements off the front of `memory`; `None`, and nothing taken, if it is too short.
pub(super) fn carve<'m, T: bytemuck::Pod>(memory: &mut &'m mut [u32], count: usize) -> Option<&'m mut [T]> {
    let words = memory.split_off_mut(..words_of(count, size_of::<T>()))?;
    bytemuck::try_cast_slice_mut(words).ok()?.get_mut(..count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_do_not_overlap_and_end_with_the_memory() {
        let mut memory = [u32::MAX; 4];
        let mut rest = &mut memory[..];
        carve::<u8>(&mut rest, 5).unwrap().fill(0);
        carve::<i16>(&mut rest, 3).unwrap().fill(1);
        assert!(carve::<u8>(&mut rest, 1).is_none());
        assert_eq!(bytemuck::bytes_of(&memory), [0, 0, 0, 0, 0, 255, 255, 255, 1, 0, 1, 0, 1, 0, 255, 255]);
    }
}
