//! Guessing the bus: from a trace without a profile to the profile.
pub mod survey;
pub mod layout;
pub mod sync;
pub mod entropy;
pub mod models;
mod geometry;
pub mod format;
mod windows;
pub mod bus;
