//! The receiving end: the block, its driver and its memory, fed with stretches of pins.
//!
//! ```text
//! stretches ─► Camif::run ─► interrupt ─► FrameCamera::on_interrupt ─► frame ─► caller
//!                   ▲ pins                        ▲ registers, DMA
//!                   └──────── the same code as on the microcontroller ──────┘
//! ```
//!
//! | file | what lives there |
//! |---|---|
//! | `source` | [`Source`]: a trace and the profile by which it is read |
//! | `config` | what the driver must know, out of a profile |
//! | `bus` | the memory bus, out of `--bus-latency` |
//! | `activity` | FIFO and DMA over time |
//! | `receive` | [`receive`]: plays a source into block and driver, and hands out frames |

mod source;
mod config;
mod bus;
mod activity;
mod receive;

pub use activity::{Activity, Bucket};
pub use bus::{BusSyntaxError, parse_bus};
pub use config::capture_config;
pub use receive::{Received, Receiver, Summary, WATCHED, receive, receive_on};
pub use source::{Source, SourceError};
