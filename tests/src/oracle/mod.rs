//! Oracles: each algorithm once more, slowly, from its definition.

pub mod camif;
pub mod clip;
pub mod draw;
