//! The driver.
pub mod config;
pub mod lint;
mod findings;
pub mod chunks;
pub mod verdict;
pub mod deadline;
pub use config::Config;
