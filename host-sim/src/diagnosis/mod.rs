//! Diagnosis: from a trace and the profile it should fit to what is wrong, where, and what to change.
//!
//! | file | what lives there |
//! |---|---|
//! | `finding` | what comes out: [`Diagnosis`], its findings, evidence, remedies |

mod finding;

pub use crate::fault::FaultKind;
pub use finding::{Diagnosis, Evidence, Finding, Measured, Place, Remedy};
