//! The block.
pub mod pins;
