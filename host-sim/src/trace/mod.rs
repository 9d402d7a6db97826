//! Traces: recorded pins, in files of several formats.
//!
//! ```text
//! file ─► open: format told by content ─► Trace { info } ─► play ─► stretches ─► any StretchSink
//! stretches ─► create: format told by the name ─► temporary file ─► finish: renamed
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | [`open`](mod@open) | a file of any format, what it says of itself, and playing it |
//! | [`create`](mod@create) | a file to be written |
//! | [`names`] | what wires are called, and `--map` |
//! | [`wiring`] | which signal is which wire |
//! | `bus` | the data lines among them |
//! | [`polarity`] | HREF against a high blanking level |
//! | [`camt`] | the project's own format on the host |
//! | [`vcd`] | value change dumps |
//! | [`error`] | what can go wrong |

pub mod open;
pub mod create;
pub mod names;
pub mod wiring;
mod bus;
pub mod polarity;
pub mod camt;
pub mod vcd;
pub mod error;

pub use create::{Created, TraceWriter, TraceWriterOptions, create};
pub use error::TraceError;
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
}

impl Default for CaptureOptions {
    /// Usual names, rising edge, the state at the edge.
    fn default() -> Self {
        Self { wanted: Wanted::default(), edge: Edge::Rising, sample_point: SamplePoint::default() }
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

#[cfg(test)]
mod tests;
