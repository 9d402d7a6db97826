//! The stages: a file for each group of the table. Each function gets the values, calls `algos-nostd` and hands the
//! picture on; memory that the library wants lent is taken here.
//!
//! | file | what lives there |
//! |---|---|
//! | `channels` | gray filters on gray or on each channel; sizes known at run time only |
//! | `light` | colour balance |
//! | `color` | gray, curves, levels, mosaics, formats |
//! | `filter` | smoothing, convolution, rank filters, morphology, sharpening |
//! | `maps` | gray pictures and maps of bits |
//! | `edges` | gradients, Canny, zero crossings, thinning, tracing |
//! | `palette` | palettes by every method |
//! | `quantize` | palettes and dithering put to use |
//! | `geometry` | flip, rotate, crop, scale |
//! | `draw` | lines, outlines, polygons, text |
//! | `paint` | fills and compositing |

mod channels;
mod light;
mod color;
mod filter;
mod maps;
mod edges;
mod palette;
mod quantize;
mod geometry;
mod draw;
mod paint;

use super::kind::Kind;
use super::table::{Group, Parameter, Stage};

/// All stages in the order of help.
pub(super) static TABLES: &[(Group, &[Stage])] = &[
    (Group::Color, color::STAGES),
    (Group::Color, light::STAGES),
    (Group::Filter, filter::STAGES),
    (Group::Edges, edges::STAGES),
    (Group::Quantize, quantize::STAGES),
    (Group::Geometry, geometry::STAGES),
    (Group::Draw, draw::STAGES),
    (Group::Draw, paint::STAGES),
];

/// A parameter of the table.
const fn parameter(name: &'static str, kind: Kind, default: &'static str, about: &'static str) -> Parameter {
    Parameter { name, kind, default, about }
}

/// Yes or no.
const YES_NO: Kind = Kind::Word(&[("yes", ""), ("no", "")]);
