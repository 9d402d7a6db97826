//! A trace through block, driver and vision, the same on a host and on a Cortex-M.
//!
//! ```text
//! .camt ─► Player ─► block ─► interrupt ─► driver ─► consumer ─► what is told
//!          a stretch      │ model  handler       │ record of every access
//!          a tick                                └────────► checksum
//! ```
//!
//! On the host a tick is a call; on the boards it is a timer's interrupt, and the handler a real one. What the driver does
//! must not depend on which of them it was: the records tell.
//!
//! | module | what lives there |
//! |---|---|
//! | [`scenario`] | which trace, which configuration, which bus, what goes wrong |
//! | [`faults`] | every fault that the driver recovers from |
//! | [`record`] | every access of the driver to the block, as a checksum |
//! | [`player`] | a stretch a tick |
//! | [`consumer`] | what the main loop does with lines and frames |
//! | [`check`] | whether that is what was to come of it |

pub mod scenario;
pub mod faults;
pub mod record;
pub mod player;
pub mod consumer;
pub mod check;
