//! The device at the end of the link: what a board's main loop does with captured frames and with commands.
//!
//! ```text
//! frame of the camera ─┬─────────────► stream 0, as it is ─┐
//!                      └─► pipeline ─► stream 1, stages ───┼─► Sender ─► wire
//! wire ─► Inbox ─► Dispatcher ─► Control ─► replies ───────┘
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `stages` | pipelines as text, as far as a device can make them |
//! | `board` | [`Board`]: what a device has besides capture: registers, parameters, a sensor |
//! | `control` | [`Control`]: what the host has chosen; carries out commands |
//! | `main` | [`Station`]: the loop's part |
//!
//! No clock, no pins: a board brings a wire, the time, and a camera. Nothing that comes over the wire can cause a panic.

mod stages;
mod board;
mod control;
mod main;
#[cfg(test)]
mod tests;

pub use board::Board;
pub use control::{Control, MADE, Order, Picture, RAW, STREAMS};
pub use main::{BODY, Identity, Memory, Station, Wire};
pub use stages::{COLORS, Made, StageError, Stages};
