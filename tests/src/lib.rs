//! What crosses crates: oracles written from the definitions, never from the fast code.
#![forbid(unsafe_code)]

pub mod oracle;
