use crate::image::{Error, Rgb};
use crate::lines::check_width;
use crate::pixel::BitDepth;
use crate::pixel::bayer::{BayerOrder, Channel};
use core::ops::{Add, Mul, Shr, Sub};

/// A RAW sample: `u8`, or a right-aligned `u16`.
pub trait Sample: Copy + private::Sealed {
    /// Bits that it can hold.
    const BITS: u32;
}

impl Sample for u8 {
    const BITS: u32 = 8;
}

impl Sample for u16 {
    const BITS: u32 = 16;
}

/// What sums are made in: wide enough for 28 samples, and no wider, so that more of them fit a vector.
pub trait Wide:
    Copy + Ord + From<i8> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Shr<u32, Output = Self>
{
    /// The nearest of 0 to 255.
    fn saturate(self) -> u8;
}

impl Wide for i16 {
    #[inline(always)]
    fn saturate(self) -> u8 {
        self.clamp(0, 255) as u8
    }
}

impl Wide for i32 {
    #[inline(always)]
    fn saturate(self) -> u8 {
        self.clamp(0, 255) as u8
    }
}

mod private {
    pub trait Sealed {
        type Wide: super::Wide;
        fn wide(self) -> Self::Wide;
    }

    impl Sealed for u8 {
        type Wide = i16;
        #[inline(always)]
        fn wide(self) -> i16 {
            self.into()
        }
    }

    impl Sealed for u16 {
        type Wide = i32;
        #[inline(always)]
        fn wide(self) -> i32 {
            self.into()
        }
    }
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

/// Own colour, green and the other colour of a place, if it is a site of the line's own colour and if it is one of green.
#[derive(Clone, Copy, Debug)]
pub(super) struct Both {
    pub(super) own: [u8; 3],
    pub(super) green: [u8; 3],
}

/// How a place's colours are made of the samples around it.
pub(super) trait Stencil<const LINES: usize> {
    /// `at(line, column)` is the sample there, from the top left of the stencil's reach.
    fn both<W: Wide>(at: impl Fn(usize, usize) -> W, shift: u32) -> Both;
}

impl Sites {
    /// Fills a line from padded lines around it.
    pub(super) fn fill<T: Stencil<LINES>, S: Sample, const LINES: usize>(
        self,
        lines: [&[S]; LINES],
        out: &mut [Rgb],
        shift: u32,
    ) {
        let lines = lines.map(|line| &line[..out.len() + LINES - 1]);
        let done =
            if cfg!(feature = "std") { fill_blocks::<T, S, LINES>(self, lines, out, shift) } else { 0 };
        let lines = lines.map(|line| &line[done..]);
        let at = |x: usize| move |line: usize, column: usize| lines[line][x + column].wide();
        let own = |x| T::both(at(x), shift).own;
        let green = |x| T::both(at(x), shift).green;
        let out = &mut out[done..];
        // Four plain loops rather than a choice at every pixel.
        match (self.red_line, self.green_first) {
            (true, false) => alternate(out, own, green, |[own, green, other]| Rgb::new(own, green, other)),
            (true, true) => alternate(out, green, own, |[own, green, other]| Rgb::new(own, green, other)),
            (false, false) => alternate(out, own, green, |[own, green, other]| Rgb::new(other, green, own)),
            (false, true) => alternate(out, green, own, |[own, green, other]| Rgb::new(other, green, own)),
        }
    }
}

/// Fills whole blocks: every place is made both ways and the right one kept, which vector units do several times
/// faster than one way at a time. Gives the number of pixels filled.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512bw+avx512vl", "x86_64+avx2")))]
fn fill_blocks<T: Stencil<LINES>, S: Sample, const LINES: usize>(
    sites: Sites,
    lines: [&[S]; LINES],
    out: &mut [Rgb],
    shift: u32,
) -> usize {
    /// Pixels a block: even, so that each begins alike.
    const BLOCK: usize = 64;
    /// Samples of a line that a block reads; no stencil is wider than 5.
    const SPAN: usize = BLOCK + 4;
    let mut planes = [[0; BLOCK]; 3];
    // Arrays of known length: no index in the loop below can lie outside, and the compiler sees that.
    let mut local = lines.map(|line| [line[0]; SPAN]);
    let mut own_sites = [0; BLOCK];
    own_sites.iter_mut().skip(usize::from(sites.green_first)).step_by(2).for_each(|mask| *mask = 0xFF_u8);
    let (blocks, _) = out.as_chunks_mut::<BLOCK>();
    let filled = blocks.len() * BLOCK;
    for (start, block) in (0..).step_by(BLOCK).zip(blocks) {
        let reach = BLOCK + LINES - 1;
        for (local, line) in local.iter_mut().zip(lines) {
            local[..reach].copy_from_slice(&line[start..start + reach]);
        }
        for x in 0..BLOCK {
            let Both { own, green } = T::both(|line, column| local[line][x + column].wide(), shift);
            for channel in 0..3 {
                planes[channel][x] = (own[channel] & own_sites[x]) | (green[channel] & !own_sites[x]);
            }
        }
        let [own, green, other] = &planes;
        let (red, blue) = if sites.red_line { (own, other) } else { (other, own) };
        for (((pixel, &r), &g), &b) in block.iter_mut().zip(red).zip(green).zip(blue) {
            *pixel = Rgb { r, g, b };
        }
    }
    filled
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
