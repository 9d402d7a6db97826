//! What the images of all boards do; a board brings its clocks, pins and buses.
//!
//! | module | what lives there |
//! |---|---|
//! | [`memory`] | [`FrameMemory`](memory::FrameMemory): frame buffers in a section of their own |
//! | [`ticks`] | milliseconds by SysTick, and delays |
//! | [`serve`] | which camera the interrupt handlers serve |
//! | [`application`] | sensor, capture, frames: [`run`](application::run) |

pub mod memory;
pub mod ticks;
pub mod serve;
pub mod application;
