//! Campaigns: faults × seeds × profiles are put in and diagnosed by somebody who does not know them.
//!
//! ```text
//! Plan ─► case 0, 1, 2, … ─► shard I/N ─► results, a JSON line each ─► merge ─► Table
//!           picture ─► sensor ─► fault ─┬► block and driver ─► frames: as sent, or not?
//!                                       └► diagnose ─► classes found
//! ```
//!
//! A case is a function of its number and the plan alone, so any number of shards gives the same merged bytes.
//!
//! | file | what lives there |
//! |---|---|
//! | `plan` | [`Plan`]: which cases there are, and the small profiles they run on |
//! | `view` | what the sensor of a case looks at |
//! | `case` | one case, from picture to finding |
//! | `results` | result files, written and merged |
//! | `table` | what came of all cases |
//! | `reliability` | how often findings of a stated confidence were right |

mod plan;
mod view;
mod case;
mod results;
mod table;
mod reliability;

pub use case::{CaseResult, run};
pub use plan::{Case, Plan, PlanError, Shard, small};
pub use reliability::Reliability;
pub use results::{Header, ResultsError, merge, read, write};
pub use table::Table;
pub use view::Pictures;
