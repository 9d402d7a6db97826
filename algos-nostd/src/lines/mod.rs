//! The line filter: how every algorithm that needs only a window of lines is written.
//!
//! A camera delivers lines, and a microcontroller has no room for a frame. A [`LineFilter`] takes a line at a time,
//! keeps as few as it needs in memory that the caller lends, and hands finished lines to a sink:
//!
//! ```text
//! push(line 0) ─► nothing yet            LATENCY = 1
//! push(line 1) ─► line 0
//! push(line 2) ─► line 1
//! finish()     ─► line 2                  as many lines out as went in
//! ```
//!
//! A whole-frame function is the filter run over the rows: see [`run`]. Filters chain with [`LineFilter::then`].
//! Filters that look at a pixel's neighbours do it through a [`Window`], which also knows what lies beyond the edge.
//! `pairs` holds two 16-bit values in a word, for processors without vector units.

mod chain;
mod window;
pub(crate) mod pairs;

pub use chain::Then;
pub use window::{Reach, Window, shifted};

use crate::image::{Error, Image, ImageMut};

/// Takes finished lines. Any `FnMut(&[T])` is one.
pub trait LineSink<T> {
    /// One line, in order from the top. It is the sink's only for the length of the call.
    fn line(&mut self, line: &[T]);
}

impl<T, F: FnMut(&[T])> LineSink<T> for F {
    fn line(&mut self, line: &[T]) {
        self(line);
    }
}

/// Lines in, lines out, with a fixed delay and fixed memory.
pub trait LineFilter {
    /// Pixel that goes in.
    type Input;
    /// Pixel that comes out.
    type Output;

    /// Lines that must follow a line before its own output can be made.
    const LATENCY: usize;

    /// Takes the next line and hands on whatever it completes.
    ///
    /// # Errors
    /// [`Error::BufferLength`] if the line is not as wide as the filter was made for; the line is then not taken.
    fn push(&mut self, line: &[Self::Input], sink: &mut impl LineSink<Self::Output>) -> Result<(), Error>;

    /// The frame has ended: hands on the lines still held, and is ready for the next frame.
    fn finish(&mut self, sink: &mut impl LineSink<Self::Output>);

    /// This filter, then another one: memory and latency add up.
    fn then<N: LineFilter<Input = Self::Output>>(self, next: N) -> Then<Self, N>
    where
        Self: Sized,
    {
        Then::new(self, next)
    }
}

/// Checks a line's width: the one error that a [`LineFilter::push`] has.
///
/// # Errors
/// [`Error::BufferLength`] if they differ.
pub fn check_width(expected: usize, got: usize) -> Result<(), Error> {
    if expected == got { Ok(()) } else { Err(Error::BufferLength { name: "line", expected, got }) }
}

/// Runs a filter over a whole frame: the rows in, the rows out.
///
/// # Errors
/// If the filter refuses a row, or makes rows of another width or number than `output` has.
pub fn run<F: LineFilter>(
    filter: &mut F,
    input: Image<'_, F::Input>,
    output: &mut ImageMut<'_, F::Output>,
) -> Result<(), Error>
where
    F::Output: Copy,
{
    let expected = (output.width(), output.height());
    let mut rows = output.rows_mut();
    let (mut made, mut width_made) = (0, expected.0);
    let mut sink = |line: &[F::Output]| {
        made += 1;
        match rows.next() {
            Some(row) if row.len() == line.len() => row.copy_from_slice(line),
            _ => width_made = line.len(),
        }
    };
    for row in input.rows() {
        filter.push(row, &mut sink)?;
    }
    filter.finish(&mut sink);
    if (width_made, made) == expected {
        Ok(())
    } else {
        Err(Error::SizeMismatch { expected: (width_made, made), got: expected })
    }
}
