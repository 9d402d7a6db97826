//! Diagnosis: from a trace and the profile it should fit to what is wrong, where, and what to change.
//!
//! ```text
//! trace ─► Recording ─► Shape (frames, lines) ─► Structure ─┐
//!                            └─► Matrix (samples) ─► Data ──┴─► judge ─► Diagnosis
//! ```
//!
//! Nothing here knows the true picture or the fault. The map:
//!
//! | file | what lives there |
//! |---|---|
//! | `finding` | what comes out: [`Diagnosis`], its findings, evidence, remedies |
//! | `recording` | the beginning of a trace in memory |
//! | `shape` | frames and lines as sync cuts them |
//! | `cut` | the same for others: [`cut()`] |
//! | `structure` | what the lengths of lines, gaps, frames and pulses say |
//! | `planes` | colour planes, and what a picture costs in bits |
//! | `data` | what the samples say |
//! | `remedy` | what to change, by class |
//! | `judge` | all rules in order: [`diagnose`] |
//! | `received` | a frame that the device got against the trace: [`compare`] |
//! | `fix` | the profile and the picture corrected |

mod finding;
mod recording;
mod shape;
mod cut;
mod structure;
mod planes;
mod data;
mod remedy;
mod judge;
mod received;
mod fix;

pub use crate::fault::FaultKind;
pub use cut::{CutFrame, CutLine, cut};
pub use finding::{Diagnosis, Evidence, Finding, Measured, Place, Remedy};
pub use fix::{Fix, Samples, fix};
pub use judge::diagnose;
pub use received::{Comparison, Sent, compare};
pub use recording::{MOST_CLOCKS, Recording, Run};
