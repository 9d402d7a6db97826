//! The device at the end of the link: what a board's main loop does with captured frames and with commands.
//!
//! ```text
//! frame of the camera ─┬─────────────► stream 0, raw ──────┐
//!                      └─► pipeline ─► stream 1, stages ───┼─► Sender ─► wire
//! wire ─► Inbox ─► Dispatcher ─► Control ─► replies ───────┘
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `stages` | pipelines as text, as far as a device can make them |
//! | `control` | [`Control`]: what the host has chosen; carries out commands |
//! | `main` | [`Station`]: the loop's part |
//!
//! No clock, no pins: a board brings a wire, the time, and a camera. Nothing that comes over the wire can cause a panic.

mod stages;
mod control;
mod main;
#[cfg(test)]
mod tests;

pub use control::{Control, Order, Picture};
pub use main::{BODY, Memory, Station, Wire};
