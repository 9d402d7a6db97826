//! Naive versions of the algorithms, written from their definitions.

pub mod clip;
pub mod draw;
