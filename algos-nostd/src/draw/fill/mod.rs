//! Filling of connected areas.
//!
//! All fill the pixels that are joined to the seed by steps to the right, left, up and down over pixels of the area.
//! None fails for want of memory: what does not fit in the lent memory is filled by the walk, which needs none.
//!
//! | file | what it holds | memory | order |
//! |---|---|---|---|
//! | `area` | [`Area`]: what is filled; pixels of one colour | | |
//! | `span` | [`flood_fill`]: whole runs of pixels | 8 bytes a run waiting | the fastest |
//! | `stack` | [`flood_fill_stack`]: pixel by pixel, the latest first | 4 bytes a pixel waiting | |
//! | `queue` | [`flood_fill_queue`]: pixel by pixel, the nearest first | 4 bytes a pixel waiting | |
//! | `walk` | [`flood_fill_walk`]: with the right hand on the wall | none | slow in mazes with loops |
//! | `fuzzy` | [`fuzzy_fill`]: similar pixels, to a mask of alpha | as `span` | |

mod area;
mod span;
mod stack;
mod queue;
mod walk;
mod fuzzy;

pub use fuzzy::{Distance, fuzzy_fill};
pub use queue::flood_fill_queue;
pub use span::{PendingRun, flood_fill};
pub use stack::flood_fill_stack;
pub use walk::flood_fill_walk;

use area::{Area, OneColor};
