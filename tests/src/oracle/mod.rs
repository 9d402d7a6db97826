//! Oracles: each algorithm once more, slowly, from its definition.

pub mod camif;
pub mod balance;
pub mod demosaic;
pub mod pixel;
pub mod scale;
pub mod edges;
pub mod quantize;
//! Naive versions of the algorithms, written from their definitions.

pub mod clip;
pub mod draw;
pub mod filter;
pub mod edges;
