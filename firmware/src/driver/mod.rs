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
mod lines;
mod line_camera;
#[cfg(test)]
mod tests;
pub use error::StartError;
pub use frame::{Frame, crc32};
pub use frame_camera::{FrameCamera, frame_plan};
pub use line_camera::{Line, LineCamera, LineEvent};
