//! Pixel clocks as levels of all wires, for the formats that hold levels over time: two changes a clock.
//!
//! ```text
//!             t(2k)      t(2k+1)     t(2k+2)         t(n) = n half periods, to the picosecond
//! PCLK    ────┐          ┌───────────┐
//!             └──────────┘           └────
//! data        ╳ changes here         ╳
//! ```
//!
//! Channels: PCLK, HSYNC, VSYNC, then the lines of the bus from D0 on.

use firmware::camif::pins::{Edge, Samples, Sync};

use super::vcd::{Ticks, VcdWriterOptions};

/// What has no levels over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum HalvesError {
    /// A bus of no width that there is.
    #[error("a bus of {0} bits; it must be 8, 10, 12 or 14")]
    BusBits(u8),
    /// A clock of 0 Hz has no times.
    #[error("the pixel clock is unknown, and the trace needs times; give pclk_hz in the profile")]
    NoClock,
    /// A sample does not fit the bus.
    #[error("sample 0x{value:X} at clock {clock} does not fit a bus of {bus_bits} bits")]
    Sample {
        /// Number of its clock.
        clock: u64,
        /// The sample.
        value: u16,
        /// Width of the bus.
        bus_bits: u8,
    },
}

/// Channels before the lines of the bus.
const NAMES: [&str; 3] = ["PCLK", "HSYNC", "VSYNC"];

/// Pixel clocks as levels of all channels, twice a clock.
#[derive(Debug)]
pub(super) struct Halves {
    bus_bits: u8,
    idle: u32,
    ticks: Ticks,
    pub(super) clocks: u64,
    last: u32,
}

impl Halves {
    pub(super) fn new(options: &VcdWriterOptions) -> Result<Self, HalvesError> {
        if !matches!(options.bus_bits, 8 | 10 | 12 | 14) {
            return Err(HalvesError::BusBits(options.bus_bits));
        }
        if options.pclk_hz == 0 {
            return Err(HalvesError::NoClock);
        }
        let idle = u32::from(options.edge == Edge::Falling);
        let ticks = Ticks::in_picoseconds(options.pclk_hz);
        Ok(Self { bus_bits: options.bus_bits, idle, ticks, clocks: 0, last: idle })
    }

    pub(super) fn channels(&self) -> usize {
        NAMES.len() + usize::from(self.bus_bits)
    }

    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        NAMES.map(str::to_owned).into_iter().chain((0..self.bus_bits).map(|line| format!("D{line}")))
    }

    /// Both halves of a clock: when, and the levels of all channels, the first one in bit 0.
    pub(super) fn clock(&mut self, sync: Sync, value: u16) -> Result<[(u64, u32); 2], HalvesError> {
        let bus_bits = self.bus_bits;
        if value >> bus_bits != 0 {
            return Err(HalvesError::Sample { clock: self.clocks, value, bus_bits });
        }
        self.clocks += 1;
        let levels =
            u32::from(value) << NAMES.len() | u32::from(sync.vsync) << 2 | u32::from(sync.hsync) << 1;
        self.last = levels | self.idle;
        let first = (self.ticks.now, self.last);
        self.ticks.advance();
        let second = (self.ticks.now, self.last ^ 1);
        self.ticks.advance();
        Ok([first, second])
    }

    /// The clock at rest again, behind the last one.
    pub(super) fn rest(&self) -> (u64, u32) {
        (self.ticks.now, self.last)
    }
}

/// Plays samples into `each`.
pub(super) fn each<E>(samples: Samples<'_>, mut each: impl FnMut(u16) -> Result<(), E>) -> Result<(), E> {
    match samples {
        Samples::Bytes(bytes) => bytes.iter().try_for_each(|&byte| each(u16::from(byte))),
        Samples::Words(words) => words.iter().try_for_each(|&word| each(word)),
        Samples::Repeat { value, clocks } => (0..clocks).try_for_each(|_| each(value)),
    }
}
