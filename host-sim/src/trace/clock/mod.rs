//! Clock recovery: pixel clocks out of a capture in which PCLK is one channel among others.
//!
//! ```text
//! PCLK     ____────____────_─__────____        samples of an analyser, several a clock
//! data     XX──────XX──────XX──────XX──        still at the rising edges, moving at the falling ones
//!              ▲       ▲      ▲   ▲
//!            edge    edge  pulse  edge         shorter than any half of this clock: dropped and counted
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | `survey` | the beginning of a capture: how long the clock is high and low, at which edge the data is still |
//! | `choice` | from there to a [`Clock`]: what edge, which pulses are too short, whether there are samples enough |
//! | `finder` | a state at every active edge of the clock |
//! | `channels` | the same for a capture of which nobody knows what its channels are |

mod survey;
mod choice;
mod finder;
mod channels;

pub(super) use choice::Known;
pub use choice::{Clock, ClockError, Stillness};
pub(super) use finder::Finder;
pub(super) use survey::Survey;
