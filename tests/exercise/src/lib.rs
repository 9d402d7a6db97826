//! Every algorithm of `algos-nostd`, and the encodings of the serial link, once, on one picture, in lent memory.
//!
//! The host and the images for Cortex-M run this one list, so their results can be compared by checksums, and what
//! each costs can be counted around the same work.
//!
//! | module | what lives there |
//! |---|---|
//! | [`replay`] | a trace through block, driver and vision, and a record of what the driver did |
//! | [`space`] | the picture and all memory that is lent |
//! | `report` | what an exercise tells: units of work and a checksum |
//! | `over` | runs a filter over the picture |
//! | `pixels`, `color`, `filters`, `edges`, `quantize`, `draw`, `clip`, `geometry`, `link` | the exercises, by group |
#![cfg_attr(not(test), no_std)]

pub mod replay;
pub mod space;
mod report;
mod over;
mod pixels;
mod color;
mod filters;
mod edges;
mod quantize;
mod draw;
mod clip;
mod geometry;
mod link;

pub use report::{Clock, Done, Exercise, Unit};
pub use space::Workspace;

/// All exercises, by group.
pub static GROUPS: [&[Exercise]; 9] = [
    pixels::EXERCISES,
    color::EXERCISES,
    filters::EXERCISES,
    edges::EXERCISES,
    quantize::EXERCISES,
    draw::EXERCISES,
    clip::EXERCISES,
    geometry::EXERCISES,
    link::EXERCISES,
];

/// All exercises.
pub fn all() -> impl Iterator<Item = &'static Exercise> {
    GROUPS.iter().flat_map(|group| group.iter())
}
