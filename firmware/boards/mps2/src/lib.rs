//! What the images for QEMU's `mps2` boards share.
//!
//! | module | what lives there |
//! |---|---|
//! | [`exit`] | how an image ends |
//! | [`stack`] | how deep the stack went |
//! | [`file`](mod@file) | the host's files, by semihosting |
//! | [`instructions`] | counts what code takes |
//! | [`rig`] | the camera: the block's model, a timer, a real interrupt |
//! | [`uart`] | a serial line |
//! | [`uptime`] | time since the start |
//! | [`scene`] | plays scenarios on the rig |
//! | [`line_image!`] | an image that works line by line |
//! | [`tell`](mod@tell) | says what came of them |
#![no_std]

mod line_image;
pub mod exit;
pub mod stack;
pub mod file;
pub mod instructions;
pub mod rig;
pub mod scene;
pub mod uart;
pub mod uptime;
pub mod tell;
