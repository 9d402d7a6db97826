//! What there is to know of a sensor, as data.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::bus::Addressing;
use super::table::Table;
use crate::camif::pins::Edge;
use crate::camif::registers::BusWidth;
use crate::driver::Config;
use crate::driver::config::SyncMode;

/// A sensor.
#[derive(Debug, PartialEq, Eq)]
pub struct Model {
    /// Its name in small letters.
    pub name: &'static str,
    /// Its address on the bus, 7 bits.
    pub address: u8,
    /// How its registers are reached.
    pub addressing: Addressing,
    /// Registers that tell that it is this sensor.
    pub identity: &'static [Identity],
    /// How long reset is held and what follows it.
    pub power: Power,
    /// The clock that its tables are meant for, in hertz. Another one changes the pixel clock in proportion.
    pub input_hz: u32,
    /// The clocks that it takes, in hertz.
    pub input_range_hz: (u32, u32),
    /// All registers to their reset values.
    pub reset: Table,
    /// What all modes have in common.
    pub base: Table,
    /// The test pattern off.
    pub pattern_off: Table,
    /// The test pattern on.
    pub pattern_on: Table,
    /// What it can send.
    pub modes: &'static [Mode],
}

/// A register with a known value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The register.
    pub register: u16,
    /// Its value, or its values where there are several revisions; the first is what messages call expected.
    pub accepted: &'static [u16],
}

/// Waits around the reset pin, in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Power {
    /// From power and clock to the end of reset.
    pub reset_low: u32,
    /// From the end of reset to the first access.
    pub settle: u32,
}

/// What a sensor sends when it is programmed so.
#[derive(Debug, PartialEq, Eq)]
pub struct Mode {
    /// Its name: size and format.
    pub name: &'static str,
    /// Pixels a line.
    pub width: u32,
    /// Lines a frame.
    pub height: u32,
    /// What stands on the data wires.
    pub format: Format,
    /// The mosaic of the raw formats, from the first pixel; of no meaning for others.
    pub bayer: BayerOrder,
    /// Data wires to be connected, the sensor's uppermost ones.
    pub bus_width: BusWidth,
    /// Pixel clocks a pixel.
    pub clocks_per_pixel: u32,
    /// How lines and frames are told apart.
    pub sync: SyncMode,
    /// The clock edge at which data is stable.
    pub edge: Edge,
    /// The pixel clock is the input clock times the first by the second.
    pub pixel_clock: (u32, u32),
    /// Its registers.
    pub table: Table,
}

impl Model {
    /// The mode of this name.
    #[must_use]
    pub fn mode(&self, name: &str) -> Option<&'static Mode> {
        self.modes.iter().find(|mode| mode.name == name)
    }
}

impl Mode {
    /// Pixel clock for an input clock, in hertz.
    #[must_use]
    pub const fn pixel_clock_hz(&self, input_hz: u32) -> u32 {
        let (multiply, divide) = self.pixel_clock;
        match (input_hz as u64 * multiply as u64).checked_div(divide as u64) {
            Some(hertz) if hertz <= u32::MAX as u64 => hertz as u32,
            _ => u32::MAX,
        }
    }

    /// What the camera interface must know to capture it.
    #[must_use]
    pub fn capture(&self, input_hz: u32) -> Config {
        let mut config = Config::new(self.sync, self.width * self.clocks_per_pixel, self.height);
        config.bus_width = self.bus_width;
        config.edge = self.edge;
        config.pclk_hz = self.pixel_clock_hz(input_hz);
        config
    }
}
