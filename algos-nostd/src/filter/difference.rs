//! What a filter takes away, or adds: the difference between its input and its output.
//!
//! ```text
//! line ─┬─► filter (LATENCY lines later) ─► − ─► sink
//!       └─► ring of LATENCY + 1 lines ────► +
//! ```
//!
//! Top-hats are differences: of a picture and its opening (what is bright and small), or of its closing and the picture
//! (what is dark and small, the black top-hat). Reference: P. Soille, "Morphological Image Analysis", 2nd edition,
//! section 4.5. Differences below zero are zero.
//!
//! Memory: [`Difference::memory`], beside the filter's own.

use crate::image::Error;
use crate::lines::{LineFilter, LineSink, check_width};

/// Which way round to subtract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Input minus output: what the filter takes away. With an opening, the white top-hat.
    InputMinusOutput,
    /// Output minus input: what the filter adds. With a closing, the black top-hat.
    OutputMinusInput,
}

/// The difference between a filter's input and its output, as a line filter.
#[derive(Debug)]
pub struct Difference<'m, F> {
    filter: F,
    order: Order,
    ring: &'m mut [u8],
    made: &'m mut [u8],
    /// Rows of the ring: where the next line goes, and where the next output's own input is.
    next: usize,
    due: usize,
}

impl<'m, F: LineFilter<Input = u8, Output = u8>> Difference<'m, F> {
    /// Bytes of memory over lines of `width` pixels, beside the filter's own.
    #[must_use]
    pub const fn memory(width: usize) -> usize {
        width.saturating_mul(F::LATENCY.saturating_add(2))
    }

    /// The difference that `filter`, over lines of `width` pixels, makes; `memory` may be longer than
    /// [`Difference::memory`].
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if `width` is zero, [`Error::BufferLength`] if `memory` is too short.
    pub fn new(filter: F, order: Order, width: usize, memory: &'m mut [u8]) -> Result<Self, Error> {
        if width == 0 {
            return Err(Error::ZeroSize { width, height: 1 });
        }
        let (expected, got) = (Self::memory(width), memory.len());
        let memory =
            memory.get_mut(..expected).ok_or(Error::BufferLength { name: "memory", expected, got })?;
        let (made, ring) = memory.split_at_mut(width);
        Ok(Self { filter, order, ring, made, next: 0, due: 0 })
    }
}

/// One line of differences, from the oldest line that waits.
fn emit(
    order: Order,
    output: &[u8],
    (ring, due, made): (&[u8], &mut usize, &mut [u8]),
    sink: &mut impl LineSink<u8>,
) {
    let width = made.len();
    let input = ring.chunks_exact(width).nth(*due).unwrap_or_default();
    *due = if (*due + 2) * width <= ring.len() { *due + 1 } else { 0 };
    for ((made, &input), &output) in made.iter_mut().zip(input).zip(output) {
        *made = match order {
            Order::InputMinusOutput => input.saturating_sub(output),
            Order::OutputMinusInput => output.saturating_sub(input),
        };
    }
    sink.line(made);
}

impl<F: LineFilter<Input = u8, Output = u8>> LineFilter for Difference<'_, F> {
    type Input = u8;
    type Output = u8;

    const LATENCY: usize = F::LATENCY;

    fn push(&mut self, line: &[u8], sink: &mut impl LineSink<u8>) -> Result<(), Error> {
        let width = self.made.len();
        check_width(width, line.len())?;
        if let Some(row) = self.ring.chunks_exact_mut(width).nth(self.next) {
            row.copy_from_slice(line);
        }
        let Self { filter, order, ring, made, due, .. } = self;
        filter.push(line, &mut |output: &[u8]| emit(*order, output, (ring, due, made), sink))?;
        // A line that the filter refuses is not taken.
        self.next = if (self.next + 2) * width <= self.ring.len() { self.next + 1 } else { 0 };
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<u8>) {
        let Self { filter, order, ring, made, due, .. } = self;
        filter.finish(&mut |output: &[u8]| emit(*order, output, (ring, due, made), sink));
        (self.next, self.due) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Mask, MorphologyFilter, MorphologyPair, close, open};

    #[test]
    fn top_hats_find_what_is_small() {
        let picture = [[9, 5, 5, 5, 1, 5, 5], [5, 5, 5, 5, 5, 5, 5], [5, 5, 5, 5, 5, 5, 8]];
        let mut memory = [0; 2 * MorphologyFilter::<3, 3>::memory(7)];
        let mut lines = [0; Difference::<MorphologyPair<3, 3>>::memory(7)];
        for (order, expected) in [
            (Order::InputMinusOutput, [[4, 0, 0, 0, 0, 0, 0], [0; 7], [0, 0, 0, 0, 0, 0, 3]]),
            (Order::OutputMinusInput, [[0, 0, 0, 0, 4, 0, 0], [0; 7], [0; 7]]),
        ] {
            let filter = match order {
                Order::InputMinusOutput => open(Mask::<3, 3>::Rectangle, 7, &mut memory).unwrap(),
                Order::OutputMinusInput => close(Mask::Rectangle, 7, &mut memory).unwrap(),
            };
            let mut filter = Difference::new(filter, order, 7, &mut lines).unwrap();
            for _ in 0..2 {
                let mut seen = Vec::new();
                let mut sink = |line: &[u8]| seen.push(line.to_vec());
                for line in &picture {
                    filter.push(line, &mut sink).unwrap();
                }
                filter.finish(&mut sink);
                assert_eq!(seen, expected, "{order:?}");
            }
            assert!(filter.push(&[0; 6], &mut |_: &[u8]| {}).is_err());
        }
    }
}
