//! Pipelines: the algorithms of `algos-nostd` by name, on a picture.
//!
//! ```text
//! "gray|gaussian:size=5,sigma=1.4|canny:low=50,high=150"
//!        │ parse, by the table
//!        ▼
//! Pipeline ─► Runner ─► picture ─► gray ─► gaussian ─► canny ─► picture
//! ```
//!
//! The map:
//!
//! | file | what lives there |
//! |---|---|
//! | `picture` | [`Picture`]: RGB or gray, and how one becomes the other |
//! | `kind`, `value` | what a parameter can be, read and written |
//! | `table` | what a stage is, and the table of all |
//! | `stages` | the stages, a file for each group; each calls `algos-nostd` |
//! | `arguments` | the values of a stage's parameters, by name |
//! | `parse` | text to [`Pipeline`] and back |
//! | `run` | [`Runner`]: pictures through a pipeline, one after the other |
//! | `error` | what can be wrong |
//! | `help`, `page` | the table for people: `--op help` and `docs/pipeline.md` |
//!
//! No algorithm is written here. What a stage is called, takes and gives is declared once, in the table, which serves
//! parsing, messages, help and the page.

mod picture;
mod value;
mod kind;
mod table;
mod stages;
mod arguments;
mod parse;
mod run;
mod error;
mod help;
#[cfg(test)]
mod page;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod properties;

pub use error::PipelineError;
pub use help::{help, is_help};
pub use parse::{Invocation, Pipeline};
pub use picture::{Frame, Picture};
pub use run::Runner;
pub use table::{Group, Stage, stages};
