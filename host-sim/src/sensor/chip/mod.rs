//! Virtual sensors with registers: what is written to them over I2C changes what comes out on the pins.
//!
//! ```text
//! I2C ─► VirtualSensor: register file ─► decode ─► Readout: clock, window, format ─► Sensor ─► pixel clocks
//!              ▲ NACK, reset, read-only                      ▲ scene
//! ```
//!
//! | file | what lives there |
//! |---|---|
//! | `virtual_sensor` | [`VirtualSensor`]: one sensor on a bus, a byte at a time |
//! | `registers` | [`Registers`]: its register file |
//! | `bus` | [`VirtualBus`]: the same as an `embedded-hal` bus, for the driver |
//! | `readout` | [`Readout`]: what the registers amount to, and frames made so |
//! | `encoding` | how a line of pixels stands on the wires, the ways that no profile has included |
//! | `view` | the part of the scene that the window shows |
//! | `blanking` | lines of an array spread over those of the output |
//! | `ov7670`, `ov2640`, `ov5640`, `mt9v034` | what each sensor's registers mean |
//!
//! The meanings are written from the data sheets, not from the driver's tables, so that a wrong table gives a wrong
//! picture. What of a sensor is not modelled is said in [`Readout::notes`], or is [`Silent::NotModelled`].

mod registers;
mod virtual_sensor;
mod bus;
mod readout;
mod encoding;
mod view;
mod blanking;
mod ov7670;
mod ov2640;
mod ov5640;
mod mt9v034;
#[cfg(test)]
mod tests;

pub use bus::{NotAcknowledged, VirtualBus};
pub use encoding::Encoding;
pub use readout::{Pattern, Readout, Silent};
pub use registers::Registers;
pub use view::View;
pub use virtual_sensor::{Mounting, VirtualSensor};

/// A kind of sensor.
#[derive(Debug)]
pub(super) struct Chip {
    pub(super) name: &'static str,
    /// 7 bits.
    pub(super) address: u8,
    pub(super) layout: Layout,
    /// Values after a reset; all others are 0.
    pub(super) reset_values: &'static [(u16, u16)],
    pub(super) read_only: &'static [u16],
    /// Whether a write resets the sensor.
    pub(super) resets: fn(register: u16, value: u16) -> bool,
    /// What the registers amount to.
    pub(super) decode: fn(&Registers, &Mounting) -> Result<Readout, Silent>,
}

/// How registers are addressed on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Bytes of an address.
    pub(super) address_bytes: u8,
    /// Bytes of a register.
    pub(super) data_bytes: u8,
    /// The register that holds the bank, which is the upper byte of the others' addresses.
    pub(super) bank_select: Option<u8>,
    /// A read may follow its address by a repeated start; SCCB has none.
    pub(super) repeated_start: bool,
}

/// SCCB with addresses and data of 8 bits.
const SCCB: Layout = Layout { address_bytes: 1, data_bytes: 1, bank_select: None, repeated_start: false };

static CHIPS: [&Chip; 4] = [&ov7670::CHIP, &ov2640::CHIP, &ov5640::CHIP, &mt9v034::CHIP];
