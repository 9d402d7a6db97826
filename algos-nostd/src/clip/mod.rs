//! Line and polygon clipping in integers, to the pixel.
//!
//! A line is what [Bresenham's algorithm](Walk) lights. To clip it is to find the part of *those* pixels that lies
//! in the window, and the state in which the algorithm would have got there: the error term and the steps left.
//! No end point is rounded to a new place, so a clipped line lights exactly the pixels that the whole line lights in
//! the window, and the part of a line in one window meets its part in the next.
//!
//! | file | what it holds |
//! |---|---|
//! | `point` | [`Window`]: a rectangle of pixels at `i16` coordinates ([`Point`]) |
//! | `staircase` | the line seen from its own octant: which step reaches which pixel, exactly |
//! | `walk` | [`Walk`]: the state of Bresenham's algorithm at a pixel, and the pixels from there on |
//! | `kuzmin` | [`clip_line`]: the fastest of them, which drawing uses; [`clip_lines`]: many at once |
//! | `cohen_sutherland` | [`cohen_sutherland`]: outcodes, one edge at a time |
//! | `liang_barsky` | [`liang_barsky`]: four inequalities in the step |
//! | `cyrus_beck` | [`cyrus_beck`]: any convex window |
//! | `nicholl_lee_nicholl` | [`nicholl_lee_nicholl`]: sides of the corners first, no division wasted |
//! | `nine_regions` | [`nine_regions`]: Sobkow, Pospisil and Yang's table of the pairs of regions |
//! | `sutherland_hodgman` | [`sutherland_hodgman`]: polygons, one edge after the other |
//!
//! All line clippers have one signature (Cyrus–Beck takes its own window) and give equal answers.

mod point;
mod staircase;
mod walk;
mod kuzmin;
mod cohen_sutherland;
mod liang_barsky;
mod cyrus_beck;
mod nicholl_lee_nicholl;
mod nine_regions;
mod sutherland_hodgman;

pub use cohen_sutherland::cohen_sutherland;
pub use cyrus_beck::{ConvexWindow, cyrus_beck};
pub use kuzmin::{clip_line, clip_lines};
pub use liang_barsky::liang_barsky;
pub use nicholl_lee_nicholl::nicholl_lee_nicholl;
pub use nine_regions::nine_regions;
pub use point::Window;

pub use crate::image::Point;
pub use sutherland_hodgman::{clipped_polygon_capacity, sutherland_hodgman};
pub use walk::Walk;

pub(crate) use walk::Direction;
