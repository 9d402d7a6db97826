//! Profiles: what the wires of a camera mean, what a frame holds and how fast it comes.
//!
//! The map, in the order in which a profile's text flows:
//!
//! | file | what lives there |
//! |---|---|
//! | `choice` | values that are words (`"gated"`, `"low"`): their names, and the nearest to a wrong one |
//! | `error` | what can be wrong with a profile: the place, what was expected, the remedy |
//! | `parse` | TOML to [`Profile`]; unknown keys and values out of range are errors |
//! | `model` | [`Profile`] itself and the numbers that follow from it |
//! | `format` | the words for formats and mosaics, samples a pixel |
//! | `check` | what the keys must be to one another |
//! | `write` | [`Profile`] to TOML |
//! | `builtin` | the profiles that come with the program, and finding one by name or file |
//!
//! A profile's text is embedded in traces, so writing and reading again gives the same profile.

mod choice;
mod error;
mod parse;
mod model;
mod format;
mod check;
mod write;
mod builtin;

pub use builtin::{DEFAULT, built_in_names, built_ins};
pub use choice::Choice;
pub use error::ProfileError;
pub use model::{Bus, Frame, Level, Profile, SyncMode, Timing};

pub(crate) use choice::nearest;
