//! Guessing the bus: from a trace without a profile to the profile.
//!
//! ```text
//! trace ─► survey ─► layout, sync: which clocks are lines and frames ─► windows: the samples of one frame
//!                                                                         │
//!          profile, confidence, doubts, rivals as pictures ◄── format ◄── models: how many bits does a sample take?
//! ```
//!
//! | file | what lives there |
//! |---|---|
//! | [`open`](mod@open) | a trace file, and what is told of the guess |
//! | [`wires`] | which channel is which wire, where their names say nothing |
//! | [`bus`] | the whole way |
//! | [`survey`] | one pass over the beginning: runs of the sync wires, life of the data, codes |
//! | [`layout`] | where lines and frames lie under a reading of the sync wires |
//! | [`sync`] | which reading is right |
//! | `windows` | the samples of a frame |
//! | [`entropy`] | how many bits numbers take |
//! | [`models`] | pixel formats as models that foretell samples |
//! | `geometry` | how usual a frame's size is |
//! | [`format`](mod@format) | which format it is |
//! | [`sheet`] | the rivals side by side |
//!
//! Integers only: the same trace gives the same guess on every machine.

pub mod open;
pub mod wires;
pub mod bus;
pub mod survey;
pub mod layout;
pub mod sync;
mod windows;
pub mod entropy;
pub mod models;
mod geometry;
pub mod format;
pub mod sheet;

pub use bus::{BusGuess, NothingFits};
pub use open::{AUTO, Answer, FileGuess, GuessError, ReadBy, guess_file, profile_for};
