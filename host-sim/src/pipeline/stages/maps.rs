use algos_nostd::edges::{
    BitMap, BitMapMut, Point, simplify, simplify_memory, trace, unpack, words_a_line, words_a_map,
};
use algos_nostd::image::Error;

use crate::pipeline::picture::{Frame, Picture};

/// A map of bits that owns its words.
pub(super) struct Map {
    pub(super) words: Vec<u32>,
    size: (usize, usize),
}

impl Map {
    /// Nothing set.
    pub(super) fn empty(size: (usize, usize)) -> Self {
        Self { words: vec![0; words_a_map(size.0, size.1)], size }
    }

    /// The pixels above a level.
    pub(super) fn above(frame: &Frame<u8>, level: u8) -> Result<Self, Error> {
        let mut map = Self::empty(frame.size());
        let mut view = map.view_mut()?;
        for (y, row) in frame.rows().enumerate() {
            for (x, &value) in row.iter().enumerate() {
                view.set(x, y, value > level);
            }
        }
        Ok(map)
    }

    pub(super) fn view(&self) -> Result<BitMap<'_>, Error> {
        BitMap::new(&self.words, self.size.0, self.size.1)
    }

    pub(super) fn view_mut(&mut self) -> Result<BitMapMut<'_>, Error> {
        BitMapMut::new(&mut self.words, self.size.0, self.size.1)
    }

    /// The map of a line filter that makes words.
    pub(super) fn lines<F>(frame: &Frame<u8>, filter: &mut F) -> Result<Self, Error>
    where
        F: algos_nostd::lines::LineFilter<Input = u8, Output = u32>,
    {
        let (width, height) = frame.size();
        let words = frame.through(filter, (words_a_line(width), height))?.pixels().to_vec();
        Ok(Self { words, size: (width, height) })
    }

    /// White where a bit is set, black elsewhere.
    pub(super) fn into_picture(self) -> Picture {
        let mut frame = Frame::filled(self.size.0, self.size.1, 0);
        for (words, row) in self.words.chunks(words_a_line(self.size.0).max(1)).zip(frame.rows_mut()) {
            unpack(words, row);
        }
        frame.into()
    }

    /// The curves of the map with at least so many pixels, in order, each simplified to a tolerance in 1/256 pixel (0: as
    /// it is).
    pub(super) fn curves(&self, least: usize, tolerance: u32) -> Result<Vec<Vec<Point>>, Error> {
        let mut rest = Self::empty(self.size);
        let mut room = vec![Point::default(); self.view()?.count() + 2];
        let mut memory = vec![0; simplify_memory(room.len())];
        let (mut curves, mut refused) = (Vec::new(), Ok(0));
        trace(self.view()?, &mut rest.view_mut()?, &mut room, &mut |curve| {
            if curve.points.len() < least {
                return;
            }
            let mut kept = curve.points.len();
            if tolerance > 0 {
                match simplify(curve.points, tolerance, &mut memory) {
                    Ok(points) => kept = points,
                    error => refused = error,
                }
            }
            curves.push(curve.points[..kept].to_vec());
        })?;
        refused.map(|_| curves)
    }
}
