//! The camera interface block (CAMIF) at register and pin level, and the firmware around it.
//!
//! The map, in data-flow order:
//!
//! | module | what lives there |
//! |---|---|
//! | [`trace`] | recorded pins: the `.camt` format, read and written without a heap |
//! | [`camif`] | the block itself, as a model: pins, registers, synchronisation, FIFO, burst DMA |
//! | [`port`] | the seams between driver and block: registers, and a DMA that owns what it is lent |
//! | [`buffers`] | who holds which buffer: the frame pool and the line ring |
//! | [`driver`] | configuration, capture, deadlines, recovery, verdicts |
//! | [`pipeline`] | the device's own vision: lines in, lines out, in memory known beforehand |
//! | [`sensor`] | sensor bring-up: identify, reset, mode tables as data |
//! | [`link`] | frames, log and commands over a serial line |
//! | [`station`] | the device at the end of the link: frames out, commands carried out |
//!
//! No heap, no clock, no chip's name: boards and hosts bring those.
#![cfg_attr(not(test), no_std)]

pub mod trace;
pub mod camif;
pub mod port;
pub mod buffers;
pub mod driver;
pub mod pipeline;
pub mod sensor;
pub mod link;
pub mod station;
