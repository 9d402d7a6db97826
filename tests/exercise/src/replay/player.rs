//! One tick of the camera's clock: a stretch of the trace through the block.

use core::borrow::BorrowMut;

use embedded_io::Read;
use firmware::camif::Bus;
use firmware::camif::pins::{Samples, Sync};
use firmware::trace::{ChunkBuffer, Item, Reader};

use super::scenario::{Disturbance, Trouble};

/// Ticks without a clock after the trace's end, so that who waits sees that nothing comes.
pub const SILENT_TICKS: u32 = 16;

/// The block, and what its interrupt line leads to.
pub trait Clocked {
    /// Plays these samples until the interrupt line rises; returns how many were played, and whether the line is high.
    fn run(&mut self, sync: Sync, samples: Samples<'_>) -> (usize, bool);
    /// The line is high: the handler is to run now, or as soon as it is no longer masked.
    fn interrupt(&mut self);
    /// Masks the handler, or lets it through again.
    fn mask(&mut self, masked: bool);
    /// Puts another memory bus in place, and returns the one before.
    fn change_bus(&mut self, bus: Bus) -> Bus;
}

/// Plays a trace, a stretch a tick.
#[derive(Debug)]
pub struct Player<'s, R, B> {
    reader: Reader<R, B>,
    disturbance: Option<&'s Disturbance>,
    /// Ticks so far.
    ticks: u64,
    /// The bus as it was before the disturbance.
    bus: Option<Bus>,
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

impl<'s, R: Read, B: BorrowMut<ChunkBuffer>> Player<'s, R, B> {
    /// Reads the header; `None` if it is none.
    pub fn new(source: R, buffer: B, disturbance: Option<&'s Disturbance>) -> Option<Self> {
        let reader = Reader::new(source, buffer).ok()?;
        Some(Self { reader, disturbance, ticks: 0, bus: None, silent: 0 })
    }

    /// The buffer, for another player.
    pub fn into_buffer(self) -> B {
        self.reader.into_parts().1
    }

    /// Plays the next stretch. The handler runs at the clock at which the line rises.
    pub fn tick(&mut self, block: &mut impl Clocked) -> Tick {
        let tick = self.ticks;
        self.ticks += 1;
        if let Some(&Disturbance { from, ticks, what }) = self.disturbance {
            if tick == from {
                self.begin(what, block);
            } else if tick == from + ticks {
                self.end(what, block);
            }
        }
        let trouble = self.disturbance.filter(|disturbance| disturbance.covers(tick));
        let trouble = trouble.map(|disturbance| disturbance.what);
        if trouble == Some(Trouble::Silence) {
            return Tick::Played;
        }
        loop {
            match self.reader.next_item() {
                Ok(Some(Item::Stretch(mut sync, mut samples))) => {
                    match trouble {
                        Some(Trouble::Vsync(level)) => sync.vsync = level,
                        Some(Trouble::Hsync(level)) => sync.hsync = level,
                        _ => {}
                    }
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

    fn begin(&mut self, what: Trouble, block: &mut impl Clocked) {
        match what {
            Trouble::Masked => block.mask(true),
            Trouble::Bus(bus) => self.bus = Some(block.change_bus(bus)),
            Trouble::Silence | Trouble::Vsync(_) | Trouble::Hsync(_) | Trouble::Nap => {}
        }
    }

    fn end(&mut self, what: Trouble, block: &mut impl Clocked) {
        if what == Trouble::Masked {
            block.mask(false);
        }
        if let Some(bus) = self.bus.take() {
            block.change_bus(bus);
        }
    }
}
