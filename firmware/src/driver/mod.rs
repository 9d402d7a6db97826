//! The driver: captures frames or lines through the [seams](crate::port), on the model as on silicon.
//!
//! In the order in which a user meets them:
//!
//! | module | what lives there |
//! |---|---|
//! | [`config`] | what the sensor sends and what of it is wanted |
//! | [`lint`], `findings` | what is wrong with a configuration, why, and what to do about it |
//! | `error` | why capture does not start |
//! | `frame_camera`, `frame` | [`FrameCamera`]: whole frames, blocking or async, and the lease of one |
//! | `line_camera` | [`LineCamera`]: line by line, in memory for a few lines |
//! | [`verdict`] | what came of each frame, and of all |
//! | [`deadline`] | why a wait ended without a frame |
//! | [`chunks`] | how a frame is cut into transfers |
//! | `frames`, `judge`, `lines` | the state machines behind the cameras, and how a frame's end is judged |
//! | `machine` | what both do alike |
//! | `meter`, `tally` | lines measured, frames counted |
//! | `engine` | every access to the block and its DMA |
//! | `shared` | what the interrupt handler and the tasks share |
//!
//! # What it promises
//! - It never hangs: the handler takes a bounded number of register accesses, and every wait has a deadline and a typed
//!   cause.
//! - It never hands out a torn frame. What an overrun, a sync error or a DMA error met is lost; capture starts again by
//!   itself, and the frame after the one on the wires at that time is whole again: two VSYNCs at most.
//! - Every frame on the wires is counted once, as delivered, dropped, lost or skipped.
//! - It does not panic, and has no `unsafe`.
//!
//! # Example
//! ```
//! use core::cell::RefCell;
//! use firmware::camif::{Bus, Camif, Part, pins::{Samples, Sync}};
//! use firmware::driver::{Config, FrameCamera, config::SyncMode};
//!
//! // On a board the port is over memory-mapped registers; here it is the model.
//! let (mut first, mut second) = ([0; 16], [0; 16]);
//! let model = RefCell::new(Camif::new(Part::CAMIF, Bus::IDEAL));
//! let camera = FrameCamera::new(&model, [&mut first[..], &mut second[..]])?;
//! let sync = SyncMode::Gated { hsync_blank_high: true, vsync_blank_high: true };
//! camera.start(&Config::new(sync, 16, 4))?;
//!
//! // The model stops where an interrupt line rises, and the handler is called, as hardware would.
//! let play = |hsync, vsync, mut samples: Samples<'_>| {
//!     while !samples.is_empty() {
//!         let played = model.borrow_mut().run(Sync { hsync, vsync }, samples);
//!         samples = samples.skip(played);
//!         camera.on_interrupt();
//!     }
//! };
//! // A sensor sends a frame of 4 lines of 16 bytes over and over.
//! let blank = Samples::Repeat { value: 0, clocks: 8 };
//! let send = || {
//!     play(true, true, blank);
//!     for line in [[1; 16], [2; 16], [3; 16], [4; 16]] {
//!         play(false, false, Samples::Bytes(&line));
//!         play(true, false, blank);
//!     }
//!     play(true, true, blank);
//! };
//! let mut now = 0;
//! let frame = camera.wait_frame(10, || {
//!     send();
//!     now += 1;
//!     now
//! })?;
//! assert!(frame.verdict().outcome.is_good());
//! assert_eq!(frame[16..32], [2; 16]);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

pub mod config;
pub mod lint;
mod findings;
mod error;
mod frame_camera;
mod frame;
mod line_camera;
pub mod verdict;
pub mod deadline;
pub mod chunks;
mod frames;
mod judge;
mod lines;
mod machine;
mod meter;
mod tally;
mod engine;
mod shared;
#[cfg(test)]
mod tests;

pub use config::Config;
pub use error::StartError;
pub use frame::{Frame, crc32};
pub use frame_camera::{FrameCamera, frame_plan};
pub use line_camera::{Line, LineCamera, LineEvent};
