//! The camera interface block (CAMIF) at register and pin level, and the firmware around it.
#![cfg_attr(not(test), no_std)]

pub mod camif;
pub mod port;
pub mod trace;
