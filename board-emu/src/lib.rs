//! Runs the very ELF that goes to the flash of an STM32, with this project's camera interface in it.
//!
//! No emulator models a DCMI. Here the block of [`firmware::camif`] takes the empty slot of an emulated part (the crate
//! `rigless`), so that an unmodified image meets a camera: a timing trace, any fault of the host simulator, any bus.
//!
//! The map, in data-flow order:
//!
//! | module | what lives there |
//! |---|---|
//! | [`footage`] | pins, recorded |
//! | [`camera`] | what drives them |
//! | [`dcmi`] | the block in the part: clocks in, request and interrupt lines out |
//! | [`part`] | the part around it |
//! | [`board`] | part, crystal, rail, serial port, I2C |
//! | [`i2c`] | a virtual sensor on the bus |
//! | [`serial`] | the far end of the serial port: a file, a socket, memory |
//! | [`run`](mod@run) | a run from reset to its end |
//! | [`cpu`] | what the core is doing, and where |
//! | [`gaps`] | what of the part was missing, and what of that was expected |
//! | [`report`] | what came of a run |
//! | [`symbols`] | names for addresses |
#![forbid(unsafe_code)]

pub mod footage;
pub mod camera;
pub mod dcmi;
pub mod part;
pub mod board;
pub mod i2c;
pub mod serial;
pub mod run;
pub mod cpu;
pub mod gaps;
pub mod report;
pub mod symbols;
