use crate::image::{Error, Rgb};
use crate::lines::check_width;
use crate::pixel::BitDepth;
use crate::pixel::bayer::{BayerOrder, Channel};

/// A RAW sample: `u8`, or a right-aligned `u16`.
pub trait Sample: Copy + Into<i32> + private::Sealed {
    /// Bits that it can hold.
    const BITS: u32;
}

impl Sample for u8 {
    const BITS: u32 = 8;
}

impl Sample for u16 {
    const BITS: u32 = 16;
}

mod private {
    pub trait Sealed {}
    impl Sealed for u8 {}
    impl Sealed for u16 {}
}

/// The last `2 × REACH + 1` lines of a mosaic, each with `REACH` mirrored samples on either side.
#[derive(Debug)]
pub(super) struct Window<'a, S, const REACH: usize> {
    lines: &'a mut [S],
    width: usize,
    pushed: usize,
    order: BayerOrder,
    shift: u32,
}

/// Samples that a window of lines of `width` takes.
pub(super) const fn window_samples(width: usize, reach: usize) -> usize {
    (2 * reach + 1) * (width + 2 * reach)
}

/// The index within `0..length` that an index outside is the mirror image of.
fn mirror(index: isize, length: usize) -> usize {
    let last = length as isize - 1;
    let mut index = index;
    while last > 0 && !(0..=last).contains(&index) {
        index = if index < 0 { -index } else { 2 * last - index };
    }
    index.clamp(0, last.max(0)) as usize
}

impl<'a, S: Sample, const REACH: usize> Window<'a, S, REACH> {
    const LINES: usize = 2 * REACH + 1;

    pub(super) fn new(
        order: BayerOrder,
        depth: BitDepth,
        width: usize,
        lines: &'a mut [S],
    ) -> Result<Self, Error> {
        if width <= REACH {
            return Err(Error::Parameter {
                name: "width",
                got: width as i64,
                allowed: "2 or more (bilinear), 3 or more (Malvar)",
            });
        }
        if depth.bits() > S::BITS {
            return Err(Error::Parameter {
                name: "depth",
                got: depth.bits().into(),
                allowed: "8 for samples of type u8",
            });
        }
        let expected = window_samples(width, REACH);
        if lines.len() < expected {
            return Err(Error::BufferLength { name: "window", expected, got: lines.len() });
        }
        Ok(Self { lines, width, pushed: 0, order, shift: depth.bits() - 8 })
    }

    /// Bits above 8 of a sample.
    pub(super) fn shift(&self) -> u32 {
        self.shift
    }

    fn slot(&self, y: usize) -> core::ops::Range<usize> {
        let padded = self.width + 2 * REACH;
        let start = y % Self::LINES * padded;
        start..start + padded
    }

    /// Takes a line; the number of the line that can now be made, if there is one.
    pub(super) fn push(&mut self, line: &[S]) -> Result<Option<usize>, Error> {
        check_width(self.width, line.len())?;
        let slot = self.slot(self.pushed);
        let padded = &mut self.lines[slot];
        padded[REACH..REACH + line.len()].copy_from_slice(line);
        for step in 1..=REACH {
            padded[REACH - step] = line[step];
            padded[REACH + line.len() - 1 + step] = line[line.len() - 1 - step];
        }
        self.pushed += 1;
        Ok(self.pushed.checked_sub(1 + REACH))
    }

    /// The lines still to be made at the end of a frame.
    pub(super) fn rest(&self) -> core::ops::Range<usize> {
        self.pushed.saturating_sub(REACH)..self.pushed
    }

    /// Is ready for the next frame.
    pub(super) fn reset(&mut self) {
        self.pushed = 0;
    }

    /// The padded line `offset` below line `y`, mirrored at the top and, once all are pushed, at the bottom.
    pub(super) fn line(&self, y: usize, offset: isize) -> &[S] {
        let line = mirror(y as isize + offset, self.pushed);
        &self.lines[self.slot(line)]
    }

    /// What line `y` is made of.
    pub(super) fn sites(&self, y: usize) -> Sites {
        let [even, odd] = self.order.line(y);
        Sites { red_line: even == Channel::Red || odd == Channel::Red, green_first: even == Channel::Green }
    }
}

/// The colours of a line: its own (red or blue) at every other site, green between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sites {
    red_line: bool,
    green_first: bool,
}

impl Sites {
    /// Fills a line: `own(x)` makes a site of the line's own colour, `green(x)` one of green; both give own, green and
    /// the other colour.
    #[inline(always)]
    pub(super) fn fill(
        self,
        out: &mut [Rgb],
        own: impl Fn(usize) -> [u8; 3],
        green: impl Fn(usize) -> [u8; 3],
    ) {
        // Four plain loops rather than a choice at every pixel.
        match (self.red_line, self.green_first) {
            (true, false) => alternate(out, own, green, |[own, green, other]| Rgb::new(own, green, other)),
            (true, true) => alternate(out, green, own, |[own, green, other]| Rgb::new(own, green, other)),
            (false, false) => alternate(out, own, green, |[own, green, other]| Rgb::new(other, green, own)),
            (false, true) => alternate(out, green, own, |[own, green, other]| Rgb::new(other, green, own)),
        }
    }
}

#[inline(always)]
fn alternate(
    out: &mut [Rgb],
    even: impl Fn(usize) -> [u8; 3],
    odd: impl Fn(usize) -> [u8; 3],
    pixel: impl Fn([u8; 3]) -> Rgb,
) {
    let (pairs, last) = out.as_chunks_mut::<2>();
    let width = 2 * pairs.len();
    for (half, pair) in pairs.iter_mut().enumerate() {
        *pair = [pixel(even(2 * half)), pixel(odd(2 * half + 1))];
    }
    if let [last] = last {
        *last = pixel(even(width));
    }
}

#[cfg(test)]
mod tests {
    use super::mirror;

    #[test]
    fn mirrors_keep_the_parity() {
        let seen: Vec<usize> = (-2..6).map(|index| mirror(index, 4)).collect();
        assert_eq!(seen, [2, 1, 0, 1, 2, 3, 2, 1]);
        for length in 2..6 {
            for index in -3..9isize {
                let inside = mirror(index, length);
                assert!(inside < length && (inside as isize - index) % 2 == 0);
            }
        }
        assert_eq!(mirror(-2, 1), 0);
    }
}
