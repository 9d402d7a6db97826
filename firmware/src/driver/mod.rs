//! The driver.
pub mod config;
pub mod lint;
mod findings;
pub mod chunks;
pub mod verdict;
pub mod deadline;
mod engine;
mod tally;
mod meter;
mod frames;
mod judge;
pub use config::Config;
mod error;
mod shared;
mod frame_camera;
mod frame;
#[cfg(test)]
mod tests;
pub use error::StartError;
pub use frame::{Frame, crc32};
pub use frame_camera::{FrameCamera, frame_plan};
