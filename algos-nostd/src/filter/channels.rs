//! A gray filter on colour: three of it, one a channel.
//!
//! ```text
//! RGB line ─► R line ─► filter ─► R line ─┐
//!             G line ─► filter ─► G line ─┼─► RGB line
//!             B line ─► filter ─► B line ─┘
//! ```
//!
//! Right for linear filters and for morphology; a median or a bilateral filter taken channel by channel can make
//! colours that were not in the picture, as they do in most libraries.
//!
//! Cost: three times the filter's, one pass to take the channels apart and one to put them together. Memory:
//! [`Channels::memory`], beside the filters' own.

use crate::image::{Error, Rgb};
use crate::lines::{LineFilter, LineSink, check_width};

/// A gray filter for each channel, as a line filter of colour.
#[derive(Debug)]
pub struct Channels<'m, F> {
    filters: [F; 3],
    /// A line of each channel, one after the other.
    planes: &'m mut [Rgb],
    /// Lines put together, to be handed on.
    made: &'m mut [Rgb],
}

impl<'m, F: LineFilter<Input = u8, Output = u8>> Channels<'m, F> {
    /// Lines that may be handed on at once: all that are held, when the frame ends.
    const LINES: usize = if F::LATENCY > 1 { F::LATENCY } else { 1 };

    /// Pixels of memory over lines of `width` pixels, beside the filters' own.
    #[must_use]
    pub const fn memory(width: usize) -> usize {
        width.saturating_mul(Self::LINES.saturating_add(1))
    }

    /// Three filters over lines of `width` pixels, for red, green and blue, each of which hands on at most one line a
    /// push (as all in this folder do); `memory` may be longer than [`Channels::memory`].
    ///
    /// # Errors
    /// [`Error::ZeroSize`] if `width` is zero, [`Error::BufferLength`] if `memory` is too short.
    pub fn new(filters: [F; 3], width: usize, memory: &'m mut [Rgb]) -> Result<Self, Error> {
        if width == 0 {
            return Err(Error::ZeroSize { width, height: 1 });
        }
        let (expected, got) = (Self::memory(width), memory.len());
        let memory =
            memory.get_mut(..expected).ok_or(Error::BufferLength { name: "memory", expected, got })?;
        let (planes, made) = memory.split_at_mut(width);
        Ok(Self { filters, planes, made })
    }
}

/// Takes the lines of one channel into the lines of all.
struct Weave<'a> {
    made: core::slice::ChunksExactMut<'a, Rgb>,
    channel: usize,
    lines: usize,
}

impl LineSink<u8> for Weave<'_> {
    fn line(&mut self, line: &[u8]) {
        let Some(made) = self.made.next() else { return };
        self.lines += 1;
        for (pixel, &value) in made.iter_mut().zip(line) {
            match self.channel {
                0 => pixel.r = value,
                1 => pixel.g = value,
                _ => pixel.b = value,
            }
        }
    }
}

impl<F: LineFilter<Input = u8, Output = u8>> LineFilter for Channels<'_, F> {
    type Input = Rgb;
    type Output = Rgb;

    const LATENCY: usize = F::LATENCY;

    fn push(&mut self, line: &[Rgb], sink: &mut impl LineSink<Rgb>) -> Result<(), Error> {
        let width = self.planes.len();
        check_width(width, line.len())?;
        let planes: &mut [u8] = bytemuck::cast_slice_mut(self.planes);
        let (red, others) = planes.split_at_mut(width);
        let (green, blue) = others.split_at_mut(width);
        for (((pixel, red), green), blue) in line.iter().zip(red).zip(green).zip(blue) {
            (*red, *green, *blue) = (pixel.r, pixel.g, pixel.b);
        }
        let mut lines = 0;
        for (channel, (filter, plane)) in self.filters.iter_mut().zip(planes.chunks_exact(width)).enumerate()
        {
            let mut weave = Weave { made: self.made.chunks_exact_mut(width), channel, lines: 0 };
            filter.push(plane, &mut weave)?;
            lines = weave.lines;
        }
        self.made.chunks_exact(width).take(lines).for_each(|line| sink.line(line));
        Ok(())
    }

    fn finish(&mut self, sink: &mut impl LineSink<Rgb>) {
        let width = self.planes.len();
        let mut lines = 0;
        for (channel, filter) in self.filters.iter_mut().enumerate() {
            let mut weave = Weave { made: self.made.chunks_exact_mut(width), channel, lines: 0 };
            filter.finish(&mut weave);
            lines = weave.lines;
        }
        self.made.chunks_exact(width).take(lines).for_each(|line| sink.line(line));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Median5, Median5Filter, Neighbourhood};

    #[test]
    fn each_channel_is_filtered_alone() {
        let mut memory = vec![vec![0; Median5Filter::memory(6)]; 4];
        let [red, green, blue, gray] = &mut memory[..] else { unreachable!("four were made") };
        let filters = [red, green, blue].map(|memory| Neighbourhood::new(Median5, 6, memory).unwrap());
        let mut lines = [Rgb::default(); Channels::<Median5Filter>::memory(6)];
        let mut filter = Channels::new(filters, 6, &mut lines).unwrap();
        let value = |x: usize, y: usize, channel: usize| ((x * 37 + y * 101 + channel * 59) % 251) as u8;
        for height in [1, 2, 7] {
            let mut made = Vec::new();
            let mut sink = |line: &[Rgb]| made.push(line.to_vec());
            for y in 0..height {
                let line: Vec<Rgb> =
                    (0..6).map(|x| Rgb::new(value(x, y, 0), value(x, y, 1), value(x, y, 2))).collect();
                filter.push(&line, &mut sink).unwrap();
            }
            filter.finish(&mut sink);
            for channel in 0..3 {
                let mut gray = Neighbourhood::new(Median5, 6, gray).unwrap();
                let mut expected = Vec::new();
                let mut sink = |line: &[u8]| expected.push(line.to_vec());
                for y in 0..height {
                    let line: Vec<u8> = (0..6).map(|x| value(x, y, channel)).collect();
                    gray.push(&line, &mut sink).unwrap();
                }
                gray.finish(&mut sink);
                let got: Vec<Vec<u8>> = made
                    .iter()
                    .map(|line| line.iter().map(|pixel| pixel.as_ref()[channel]).collect())
                    .collect();
                assert_eq!(got, expected, "{height} lines");
            }
        }
    }
}
