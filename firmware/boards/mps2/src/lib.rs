//! What the images for QEMU's `mps2` boards share.
#![no_std]

pub mod exit;
