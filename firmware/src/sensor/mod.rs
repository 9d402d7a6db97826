//! Sensor bring-up: from a sensor without power to one that sends the frames that the camera interface expects.
//!
//! ```text
//! pins: power, reset ─► identify ─► reset ─► base table ─► mode table ─► read back ─► frames on the bus
//!        power_up          Sensor::start ────────────────────────────────────────┘
//! ```
//!
//! What a sensor is stands in data, a [`Model`]; one driver, [`Sensor`], brings up all of them. In the order of the work:
//!
//! | module | what lives there |
//! |---|---|
//! | [`table`] | a register table, step by step |
//! | [`model`] | [`Model`] and [`Mode`]: what there is to know of a sensor |
//! | `power` | [`power_up`]: the reset and power-down pins in their order |
//! | [`bus`] | registers over I2C: SCCB with addresses of 8 and 16 bits, banks, data of 16 bits |
//! | `driver` | [`Sensor`]: identify, reset, program, read back |
//! | `error` | [`SensorError`]: what went wrong, where, and what to check |
//! | [`ov7670`], [`ov2640`], [`ov5640`], [`mt9v034`] | the sensors |
//!
//! # Sources, and what they are worth
//! The tables were written from the sensors' data sheets, sections of which are cited where a value comes from. OmniVision
//! documents a good part of its registers as "reserved" and tunes the picture (gamma, colour matrix, lens shading) through
//! them; none of that is here. What is here sets clock, window, format, scaling and polarities. **No table was yet tried on
//! silicon**: the tests are against a virtual sensor written from the same documents.
//!
//! # Example
//! ```
//! use embedded_hal::{delay::DelayNs, digital::OutputPin, i2c::I2c};
//! use firmware::driver::Config;
//! use firmware::sensor::{Sensor, SensorError, ov7670::OV7670, power_up};
//!
//! /// Brings an OV7670 up, and says what the camera interface is to capture.
//! fn bring_up(
//!     i2c: impl I2c,
//!     reset: &mut impl OutputPin,
//!     power_down: &mut impl OutputPin,
//!     delay: &mut impl DelayNs,
//! ) -> Result<Option<Config>, SensorError> {
//!     power_up(&OV7670, reset, power_down, delay)?;
//!     let mut sensor = Sensor::new(i2c, &OV7670);
//!     let Some(mode) = OV7670.mode("vga-rgb565") else { return Ok(None) };
//!     sensor.start(mode, delay)?;
//!     Ok(Some(mode.capture(24_000_000)))
//! }
//! ```

pub mod table;
pub mod model;
mod power;
pub mod bus;
mod driver;
mod error;
pub mod ov7670;
pub mod ov2640;
pub mod ov5640;
pub mod mt9v034;
#[cfg(test)]
mod tests;

pub use driver::Sensor;
pub use error::{Access, SensorError};
pub use model::{Mode, Model};
pub use power::{NoPin, power_up};

/// All models.
pub static MODELS: [&Model; 4] = [&ov7670::OV7670, &ov2640::OV2640, &ov5640::OV5640, &mt9v034::MT9V034];
