//! Value change dumps (IEEE 1364-2005 §18): what simulators and logic analysers write.
//!
//! ```text
//! file ─► blocks ─► declarations ─► wiring ─► changes ─► state at active edges ─► stretches
//!                   (header)        (ids)     (changes, rare)         (edges)
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `blocks` | a file as a row of blocks, with lines counted for errors |
//! | `scan` | eight characters at a time |
//! | `header` | the declarations |
//! | `ids` | from identifier to wire |
//! | `stamp` | time stamps |
//! | `changes` | the rule of when a sample is taken |
//! | `common` | the fast loop |
//! | `rare` | the other tokens |
//! | `reader` | all of it: [`VcdReader`] |
//! | `levels` | the levels of any signals |
//! | `ticks` | the time stamps of a clock |
//! | `writer` | stretches to a file: [`VcdWriter`] |
//! | `error` | what can be wrong, and where |

mod blocks;
mod scan;
mod header;
mod ids;
mod stamp;
mod changes;
mod common;
mod rare;
mod reader;
mod levels;
mod ticks;
mod writer;
mod error;

pub use blocks::Place;
pub use changes::SamplePoint;
pub use error::{Problem, VcdError};
pub(super) use header::name_and_range;
pub(super) use levels::VcdLevels;
pub use reader::{VcdPlayed, VcdReader};
pub(super) use ticks::Ticks;
pub use writer::{Layout, Style, VcdNames, VcdWriteError, VcdWriter, VcdWriterOptions};
