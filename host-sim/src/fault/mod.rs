//! Faults: what goes wrong between a sensor and the pins, put in on purpose.
//!
//! ```text
//! sensor or trace ─► Injector { fault, fault, … } ─► pins, trace, receiver
//!                        ▲ seed
//! ```
//!
//! A fault is a decorator of stretches: whatever plays into a sink plays into one with faults before it, and neither
//! the sensor nor the block knows. The same seed gives the same damage.
//!
//! | file | what lives there |
//! |---|---|
//! | `kind` | [`FaultKind`]: every class by name, and its keys with their ranges |
//! | `spec` | [`FaultSpec`]: `KIND:key=value,…` from text, and values drawn by a seed |
//! | `random` | the random numbers |
//! | `place` | where in a frame a clock is |
//! | `inject` | [`Injector`]: the decorator |
//! | `clock` | faults of the pixel clock: edges too many, too few, at the wrong time |
//! | `lines` | lines too short, too long, late, and their blanking |
//! | `sync` | HSYNC and VSYNC missing, spurious or upside down |
//! | `codes` | the same three where sync stands in codes |
//! | `wires` | data wires stuck, swapped, shorted, shifted, reversed |
//! | `bytes` | samples that slip or change places |
//! | `frame` | another format, another mosaic |

mod kind;
mod spec;
mod random;
mod place;
mod inject;
mod clock;
mod lines;
mod sync;
mod codes;
mod wires;
mod bytes;
mod frame;

pub use inject::Injector;
pub use kind::{FaultKind, Key, Values};
pub use random::Random;
pub use spec::{FaultError, FaultSpec, help};
pub(crate) use wires::{reverse_bits, swap_bits};

#[cfg(test)]
mod tests;
