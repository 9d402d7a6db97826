//! Traces: recorded pins, in files of several formats.
//!
//! ```text
//! file ─► Capture: format told by content ─► channels ─► play ─► levels over time ─► any LevelSink
//!               └─ open by a profile: wires, clock ─► Trace { info } ─► play ─► stretches ─► any StretchSink
//! stretches ─► create: format told by the name ─► temporary file ─► finish: renamed
//! ```
//!
//! Two ways in. Who knows what the wires mean opens a [`Trace`] and gets pixel clocks. Who has yet to find out opens a
//! [`Capture`] and gets the levels of any channels, from any format, in constant memory: see [`capture`].
//!
//! | module | what lives there |
//! |---|---|
//! | [`capture`] | a file of any format at the level of its signals |
//! | [`levels`] | levels over time, and who takes them |
//! | [`open`](mod@open) | a file by its wires: what it says of itself, and pixel clocks out of it |
//! | [`clock`] | pixel clocks recovered from samples of the clock wire |
//! | `edges` | the wires in one word, and states at edges gathered into stretches |
//! | [`create`](mod@create) | a file to be written |
//! | [`names`] | what wires are called, and `--map` |
//! | [`wiring`] | which signal is which wire |
//! | `bus` | the data lines among them |
//! | [`polarity`] | HREF against a high blanking level |
//! | [`camt`] | the project's own format on the host |
//! | [`vcd`] | value change dumps |
//! | [`sr`] | sigrok sessions |
//! | [`fst`] | fast signal traces |
//! | [`saleae`] | exports of Saleae Logic 2, as text and binary |
//! | [`error`] | what can go wrong |

pub mod open;
pub mod create;
pub mod names;
pub mod wiring;
mod bus;
pub mod polarity;
mod edges;
pub mod levels;
mod halves;
pub mod capture;
pub mod clock;
pub mod camt;
pub mod vcd;
pub mod sr;
pub mod saleae;
pub mod fst;
pub mod error;

pub use capture::{Capture, Channel};
pub use create::{Created, TraceWriter, TraceWriterOptions, create};
pub use error::TraceError;
pub use halves::HalvesError;
pub use names::{MapError, SignalMap};
pub use open::{Format, Played, Trace, TraceInfo, open};
pub use wiring::{Matched, Wanted};

use firmware::camif::pins::Edge;

use vcd::SamplePoint;

/// How a capture of wires is to be read. A `.camt` holds samples and needs none of it.
#[derive(Clone, Debug)]
pub struct CaptureOptions {
    /// Which signals are the wires.
    pub wanted: Wanted,
    /// The active edge of the pixel clock.
    pub edge: Edge,
    /// Which state is sampled.
    pub sample_point: SamplePoint,
    /// In an analyser's samples, pulses of the clock of less than these seconds are dropped; without, of less than half of the usual length.
    pub shortest_pulse: Option<f64>,
}

impl Default for CaptureOptions {
    /// Usual names, rising edge, the state at the edge.
    fn default() -> Self {
        Self {
            wanted: Wanted::default(),
            edge: Edge::Rising,
            sample_point: SamplePoint::default(),
            shortest_pulse: None,
        }
    }
}

/// Why playing stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlayError<T, S> {
    /// The trace.
    Trace(T),
    /// The sink wanted no more.
    Sink(S),
}

impl<T, S> PlayError<T, S> {
    /// The same with another error of the trace.
    pub(crate) fn map<U>(self, change: impl FnOnce(T) -> U) -> PlayError<U, S> {
        match self {
            Self::Trace(error) => PlayError::Trace(change(error)),
            Self::Sink(error) => PlayError::Sink(error),
        }
    }
}

#[cfg(test)]
mod tests;
