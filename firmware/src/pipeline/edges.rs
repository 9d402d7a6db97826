//! Canny on the device: the line part while the frame passes, hysteresis on two maps of bits when it has ended.

use algos_nostd::edges::smooth::{Gaussian3, Gaussian5, NoSmoothing, Smoothing as Kernel};
use algos_nostd::edges::{BitMap, BitMapMut, CannyLines, Marks, Thresholds, grow, words_a_line, words_a_map};
use algos_nostd::image::Error;
use algos_nostd::lines::LineFilter;

use super::memory::Memory;
use super::settings::Smoothing;

/// The line part, by its smoothing.
#[derive(Debug)]
enum Lines<'m> {
    None(CannyLines<'m, NoSmoothing>),
    Gaussian3(CannyLines<'m, Gaussian3>),
    Gaussian5(CannyLines<'m, Gaussian5>),
}

/// The two maps, and how far they are filled.
#[derive(Debug)]
struct Maps<'m> {
    size: (usize, usize),
    candidates: &'m mut [u32],
    strong: &'m mut [u32],
    /// Words of the lines that are there.
    filled: usize,
}

/// Canny at work.
#[derive(Debug)]
pub(super) struct Edges<'m> {
    lines: Lines<'m>,
    maps: Maps<'m>,
}

impl<'m> Edges<'m> {
    pub(super) fn new(
        smoothing: Smoothing,
        thresholds: Thresholds,
        (width, height): (usize, usize),
        memory: &mut Memory<'m>,
    ) -> Result<Self, Error> {
        let candidates = memory.words(words_a_map(width, height))?;
        let strong = memory.words(words_a_map(width, height))?;
        let lines = match smoothing {
            Smoothing::None => Lines::None(lines(width, thresholds, memory)?),
            Smoothing::Gaussian3 => Lines::Gaussian3(lines(width, thresholds, memory)?),
            Smoothing::Gaussian5 => Lines::Gaussian5(lines(width, thresholds, memory)?),
        };
        Ok(Self { lines, maps: Maps { size: (width, height), candidates, strong, filled: 0 } })
    }

    pub(super) fn push(&mut self, gray: &[u8]) -> Result<(), Error> {
        let sink = &mut |marks: &[Marks]| self.maps.keep(marks);
        match &mut self.lines {
            Lines::None(lines) => lines.push(gray, sink),
            Lines::Gaussian3(lines) => lines.push(gray, sink),
            Lines::Gaussian5(lines) => lines.push(gray, sink),
        }
    }

    pub(super) fn finish(&mut self, sink: &mut impl FnMut(&[u32])) {
        let keep = &mut |marks: &[Marks]| self.maps.keep(marks);
        match &mut self.lines {
            Lines::None(lines) => lines.finish(keep),
            Lines::Gaussian3(lines) => lines.finish(keep),
            Lines::Gaussian5(lines) => lines.finish(keep),
        }
        self.maps.grow(sink);
    }
}

fn lines<'m, S: Kernel>(
    width: usize,
    thresholds: Thresholds,
    memory: &mut Memory<'m>,
) -> Result<CannyLines<'m, S>, Error> {
    CannyLines::new(width, thresholds, memory.words(CannyLines::<S>::memory(width))?)
}

impl Maps<'_> {
    /// A line of marks. What is too much of a frame is left out.
    fn keep(&mut self, marks: &[Marks]) {
        let Self { candidates, strong, filled, .. } = self;
        let (Some(candidates), Some(strong)) = (candidates.get_mut(*filled..), strong.get_mut(*filled..))
        else {
            return;
        };
        for ((marks, candidates), strong) in marks.iter().zip(candidates).zip(strong) {
            (*candidates, *strong) = (marks.candidates, marks.strong);
        }
        *filled = filled.saturating_add(marks.len());
    }

    /// Hysteresis; the lines that a frame was short of are empty.
    fn grow(&mut self, sink: &mut impl FnMut(&[u32])) {
        for map in [&mut *self.candidates, &mut *self.strong] {
            map.iter_mut().skip(self.filled).for_each(|word| *word = 0);
        }
        self.filled = 0;
        let (width, height) = self.size;
        // The maps are of one size, so nothing is refused.
        if let Ok(candidates) = BitMap::new(self.candidates, width, height)
            && let Ok(mut strong) = BitMapMut::new(self.strong, width, height)
            && grow(candidates, &mut strong).is_ok()
        {
            strong.as_map().words().chunks_exact(words_a_line(width).max(1)).for_each(sink);
        }
    }
}
