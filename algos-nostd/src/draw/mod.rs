//! Lines, circles, polygons, filling and alpha compositing.
//!
//! Everything is drawn into an [`ImageMut`](crate::image::ImageMut) and clipped to it: coordinates may lie anywhere in
//! `i16`. Solid drawing takes any pixel that can be copied; smooth drawing takes pixels that can be [mixed](Mix).
//!
//! | file | what it holds |
//! |---|---|
//! | `pixel`, `steps` | single pixels and spans; a line's steps along its longer side |
//! | `line` | [`draw_line`]: Bresenham's line with a stride; its pixels one by one are [`Walk`] |
//! | `run_slice` | [`draw_line_runs`], [`Runs`]: the same line, run by run |
//! | `thick` | [`draw_line_thick`]: Murphy's thick line |
//! | `mix` | [`Mix`]: a colour over another; [`paint_mask`]; exact division by 255 |
//! | `wu` | [`draw_line_wu`]: smooth, two pixels a step |
//! | `gupta_sproull` | [`draw_line_gupta_sproull`]: smooth, filtered by a cone |
//! | `circle`, `ellipse` | [`draw_circle`], [`fill_circle`], [`draw_ellipse`], [`fill_ellipse`] |
//! | `arc` | [`draw_arc`], [`draw_elliptic_arc`]: parts of them between two rays |
//! | `polygon` | [`fill_polygon`]: even-odd and non-zero, with an active edge table |
//! | `fill` | [`flood_fill`] and its kin; [`fuzzy_fill`] |
//! | `text`, `font` | [`draw_text`], [`draw_box`], [`fill_box`]: annotation |
//! | `composite` | [`Operator`]: Porter and Duff's operators, straight and premultiplied |

mod pixel;
mod steps;
mod line;
mod run_slice;
mod thick;
mod mix;
mod wu;
mod gupta_sproull;
mod circle;
mod ellipse;
mod arc;
mod polygon;
mod fill;
mod font;
mod text;
mod composite;
#[cfg(test)]
mod picture;

pub use crate::clip::{Point, Walk, Window};
pub use arc::{Sweep, draw_arc, draw_elliptic_arc};
pub use circle::{draw_circle, fill_circle};
pub use composite::{Operator, Premultiplied, Rgba, composite, composite_straight};
pub use ellipse::{draw_ellipse, fill_ellipse};
pub use fill::{
    Distance, PendingRun, flood_fill, flood_fill_queue, flood_fill_stack, flood_fill_walk, fuzzy_fill,
};
pub use gupta_sproull::draw_line_gupta_sproull;
pub use line::draw_line;
pub use mix::{Mix, divide_by_255, paint_mask};
pub use polygon::{Edge, FillRule, fill_polygon, polygon_edges};
pub use run_slice::{Run, Runs, draw_line_runs};
pub use text::{draw_box, draw_text, fill_box, text_size};
pub use thick::draw_line_thick;
pub use wu::draw_line_wu;
