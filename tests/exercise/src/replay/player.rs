//! One tick of the camera's clock: a stretch of the trace through the block.

use core::borrow::BorrowMut;

use embedded_io::Read;
use firmware::camif::pins::{Samples, Sync};
use firmware::trace::{ChunkBuffer, Item, Reader};

/// Ticks without a clock after the trace's end, so that who waits sees that nothing comes.
pub const SILENT_TICKS: u32 = 16;

/// The block, and what its interrupt line leads to.
pub trait Clocked {
    /// Plays these samples until the interrupt line rises; returns how many were played, and whether the line is high.
    fn run(&mut self, sync: Sync, samples: Samples<'_>) -> (usize, bool);
    /// The line is high: the handler is to run now.
    fn interrupt(&mut self);
}

/// Plays a trace, a stretch a tick.
#[derive(Debug)]
pub struct Player<R, B> {
    reader: Reader<R, B>,
    silent: u32,
}

/// What a tick was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tick {
    /// Clocks, or silence after them.
    Played,
    /// There is no more.
    Ended,
    /// The trace cannot be read.
    Broken,
}

impl<R: Read, B: BorrowMut<ChunkBuffer>> Player<R, B> {
    /// Reads the header; `None` if it is none.
    pub fn new(source: R, buffer: B) -> Option<Self> {
        Reader::new(source, buffer).ok().map(|reader| Self { reader, silent: 0 })
    }

    /// The buffer, for another player.
    pub fn into_buffer(self) -> B {
        self.reader.into_parts().1
    }

    /// Plays the next stretch. The handler runs at the clock at which the line rises.
    pub fn tick(&mut self, block: &mut impl Clocked) -> Tick {
        loop {
            match self.reader.next_item() {
                Ok(Some(Item::Stretch(sync, mut samples))) => {
                    while !samples.is_empty() {
                        let (played, high) = block.run(sync, samples);
                        samples = samples.skip(played);
                        if high {
                            block.interrupt();
                        }
                    }
                    return Tick::Played;
                }
                Ok(Some(Item::Profile(_) | Item::End(_))) => {}
                Ok(None) if self.silent < SILENT_TICKS => {
                    self.silent += 1;
                    return Tick::Played;
                }
                Ok(None) => return Tick::Ended,
                Err(_) => return Tick::Broken,
            }
        }
    }
}
