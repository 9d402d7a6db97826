//! The skeleton that neighbourhood filters share: a [`Window`] of lines, a row kernel, a row to write to.
//!
//! ```text
//! push(line) ─► window of LINES padded rows ─► kernel.row(rows, made) ─► sink
//! ```
//!
//! A filter of this folder is a [`RowKernel`]: a function from the rows around a line to that line's output. The
//! kernel alone can also be called by a fused stage that has its rows elsewhere, such as an edge detector.

use crate::image::Error;
use crate::lines::{LineFilter, LineSink, Reach, Window};

/// Makes one row of output from the `LINES` rows of input around it.
pub trait RowKernel<const LINES: usize> {
    /// Pixels that the kernel looks to the left and to the right.
    const COLUMNS: usize;

    /// Why the kernel can't be used over lines of this width, if it can't.
    ///
    /// # Errors
    /// Whatever is wrong; by default only an even `LINES`, which has no centre.
    fn check(&self, width: usize) -> Result<(), Error> {
        let _ = width;
        check_odd("LINES", LINES)
    }

    /// A frame begins: the next row is its first.
    fn begin(&mut self) {}

    /// Makes a row. `rows` are the input rows from top to bottom, each `made.len() + 2 × COLUMNS` pixels; pixel `x` of
    /// the output lies under pixel `x + COLUMNS` of `rows[LINES / 2]`. Within a frame the rows come in order.
    ///
    /// # Panics
    /// May panic if the rows are shorter than that.
    fn row(&mut self, rows: [&[u8]; LINES], made: &mut [u8]);
}

/// A row kernel as a line filter.
#[derive(Debug)]
pub struct Neighbourhood<'m, K, const LINES: usize> {
    kernel: K,
    window: Window<'m, u8>,
    made: &'m mut [u8],
}

impl<'m, K: RowKernel<LINES>, const LINES: usize> Neighbourhood<'m, K, LINES> {
    const REACH: Reach = Reach { columns: K::COLUMNS, lines: LINES / 2 };

    /// Bytes of memory that the filter takes over lines of `width` pixels.
    #[must_use]
    pub const fn memory(width: usize) -> usize {
        Window::<u8>::memory(width, Self::REACH).saturating_add(width)
    }

    /// The kernel over lines of `width` pixels; `memory` may be longer than [`Neighbourhood::memory`].
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if `width` is zero, [`Error::BufferLength`] if `memory` is too short, and what the kernel
    /// has against the width.
    pub fn new(kernel: K, width: usize, memory: &'m mut [u8]) -> Result<Self, Error> {
        kernel.check(width)?;
        let (expected, got) = (Self::memory(width), memory.len());
        if got < expected && width > 0 {
            return Err(Error::BufferLength { name: "memory", expected, got });
        }
        let (made, window) = memory.split_at_mut(width);
        Ok(Self { window: Window::new(width, Self::REACH, window)?, made, kernel })
    }

    fn emit(&mut self, sink: &mut impl LineSink<u8>) {
        self.kernel.row(self.window.rows(), self.made);
        sink.line(self.made);
    }
}

impl<K: RowKernel<LINES>, const LINES: usize> LineFilter for Neighbourhood<'_, K, LINES> {
    type Input = u8;
    type Output = u8;

    const LATENCY: usize = LINES / 2;

    fn push(&mut self, line: &[u8], sink: &mut impl LineSink<u8>) -> Result<(), Error> {
        if self.window.is_empty() {
            self.kernel.begin();
        }
        if self.window.push(line)? {
            self.emit(sink);
        }
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<u8>) {
        while self.window.drain() {
            self.emit(sink);
        }
    }
}

/// A side of a kernel must be odd, so that there is a centre.
pub(super) fn check_odd(name: &'static str, side: usize) -> Result<(), Error> {
    if side % 2 == 1 {
        Ok(())
    } else {
        Err(Error::Parameter {
            name,
            got: i64::try_from(side).unwrap_or(i64::MAX),
            allowed: "odd, so that the kernel has a centre",
        })
    }
}
