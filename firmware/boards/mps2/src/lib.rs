//! What the images for QEMU's `mps2` boards share.
//!
//! | module | what lives there |
//! |---|---|
//! | [`exit`] | how an image ends |
//! | [`file`](mod@file) | the host's files, by semihosting |
//! | [`instructions`] | counts what code takes |
#![no_std]

pub mod exit;
pub mod file;
pub mod instructions;
