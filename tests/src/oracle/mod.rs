//! Oracles: each algorithm once more, slowly, from its definition.

pub mod camif;
pub mod pixel;
pub mod demosaic;
pub mod balance;
pub mod filter;
pub mod scale;
pub mod edges;
pub mod quantize;
pub mod draw;
pub mod clip;
