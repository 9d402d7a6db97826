//! The report of a diagnosis: one HTML file that works offline, and JUnit for machines.
//!
//! ```text
//! Source ─► take ─► frames, activity ─┐
//! Recording ─► cut ─► Rows ───────────┼─► Page ─► HTML: pictures, numbers as JSON, style and script
//! Diagnosis, BusGuess ─► rivals ──────┘
//! ```
//!
//! | file | what lives there |
//! |---|---|
//! | `take` | the frames that come in, and FIFO and DMA meanwhile |
//! | `rows` | which pixel clock a row of the picture begins at, and back |
//! | `waves` | the pieces of the trace that are shown as waveforms |
//! | `rivals` | pictures of what else the trace may be |
//! | `page` | all that the report holds: [`Page`] |
//! | `build` | [`build()`]: from a diagnosis to a page |
//! | `html` | a page becomes one file |
//! | `text` | numbers as people read them |
//! | `junit` | the same for a CI's test overview |
//! | `page.html`, `page.css`, `*.js` | what the reader sees |

mod take;
mod rows;
mod waves;
mod rivals;
mod page;
mod build;
mod text;
mod html;
mod junit;

pub use build::{Subject, build};
pub use html::write;
pub use junit::{campaign_junit, junit};
pub use page::{BusFacts, FindingPlace, FrameFacts, Illustration, Lines, Page, Rival, Shot};
pub(crate) use text::grouped;
pub use waves::Wave;

use firmware::driver::StartError;

use crate::picture::PictureError;
use crate::trace::TraceError;

/// Why a report could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The trace.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The driver refuses the profile.
    #[error("the profile {profile}: {error}; check its frame and bus")]
    Profile {
        /// The profile's name.
        profile: String,
        /// The driver's reason.
        error: StartError,
    },
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] PictureError),
    /// The page's template; a bug.
    #[error("the page can't be put together: {0}; this is a bug, please report it")]
    Template(#[from] minijinja::Error),
    /// The numbers or the XML; a bug.
    #[error("the numbers can't be written: {0}; this is a bug, please report it")]
    Numbers(String),
}
