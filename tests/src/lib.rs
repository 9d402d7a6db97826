//! What crosses crates: oracles written from the definitions, never from the fast code, and the pages that tests write.
#![forbid(unsafe_code)]

pub mod oracle;
pub mod page;
