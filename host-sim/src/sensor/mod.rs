//! The virtual sensor: takes a picture, encodes it into the profile's format and plays it with the profile's timing.
//!
//! ```text
//! picture ─► encode ─► bytes of a frame ─► marker / gated / embedded ─► stretches of pixel clocks
//! ```
//!
//! The map:
//!
//! | file | what lives there |
//! |---|---|
//! | `player` | [`Sensor`]: frames in order, from a scene, a picture or raw bytes |
//! | `lines` | the samples of a line, as wide as the bus |
//! | `marker` | every clock carries data, edges of the sync wires end lines and frames |
//! | `gated` | blanking levels on the sync wires |
//! | `chip` | [`VirtualSensor`]: OV7670, OV2640, OV5640, MT9V034 with registers on I2C, which change what is played |
//! | `embedded` | sync codes in the data, as in ITU-R BT.656 |
//!
//! What comes out are stretches of constant sync levels, a whole line of samples in one where the levels allow it,
//! so a trace or the block's fast path takes them in bulk.

mod player;
mod lines;
mod marker;
mod gated;
mod embedded;
mod chip;

pub use chip::{
    Encoding, Mounting, NotAcknowledged, Pattern, Readout, Registers, Silent, View, VirtualBus, VirtualSensor,
};
pub use embedded::make_code_free;
pub use player::{PlayError, Sensor};

#[cfg(test)]
mod receive;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod on_block;
