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
//! | `structure` | what the lengths of lines, gaps, frames and pulses say, with its rules in `common` and `deviations` |
//! | `pitch` | the line's period as the picture tells it |
//! | `marks` | marks of sync that are a clock late, or damaged |
//! | `planes` | colour planes, and what a picture costs in bits |
//! | `mixing` | samples that show wires of the sample before |
//! | `statistics` | what each data wire does |
//! | `data` | what the samples say, with its rules in `wires`, `orders`, `slip` and `mosaic` |
//! | `remedy` | what to change, by class |
//! | `calibration` | from the score of a rule to a probability |
//! | `judge` | all rules in order: [`diagnose`] |
//! | `edge` | where data moves in an analyser's samples |
//! | `received` | a frame that the device got against the trace: [`compare`] |
//! | `fix` | the profile and the picture corrected |

mod finding;
mod recording;
mod shape;
mod cut;
mod structure;
mod common;
mod deviations;
mod pitch;
mod marks;
mod planes;
mod mixing;
mod statistics;
mod data;
mod wires;
mod orders;
mod slip;
mod mosaic;
mod remedy;
mod calibration;
mod judge;
mod edge;
mod received;
mod fix;

pub use crate::fault::FaultKind;
pub use cut::{CutFrame, CutLine, cut};
pub use finding::{Diagnosis, Evidence, Finding, Measured, Place, Remedy};
pub use fix::{Fix, Samples, fix};
pub use judge::diagnose;
pub use received::{Comparison, Sent, compare};
pub use recording::{MOST_CLOCKS, Recording, Run};
