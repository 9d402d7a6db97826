//! What the images of all boards do; a board brings its clocks and its memory.
//!
//! | module | what lives there |
//! |---|---|
//! | [`memory`] | [`FrameMemory`](memory::FrameMemory): frame buffers in a section of their own |
//! | [`ticks`] | milliseconds by SysTick, and delays |
//! | [`wiring`] | pins, buses and the serial line |
//! | [`serve`] | which camera the interrupt handlers serve |
//! | [`application`] | sensor, capture, frames: [`run`](application::run) |

pub mod memory;
pub mod ticks;
pub mod wiring;
pub mod serve;
pub mod application;
