//! What crosses crates.
//!
//! | module | what lives there |
//! |---|---|
//! | [`oracle`] | each algorithm once more, from its definition and never from the fast code |
//! | [`page`] | the pages that tests write |
//! | [`on_core`] | what the images for Cortex-M are given, and what the host makes of the same |
#![forbid(unsafe_code)]

pub mod oracle;
pub mod page;
pub mod on_core;
