//! Colour balance: find the colour of the light, and take it away.
//!
//! ```text
//! lines ─► estimate ─► White ─► running mean ─► gains or a 3×3 matrix ─► lines of the next frame (or this one)
//! ```
//!
//! | module | what it does |
//! |---|---|
//! | [`white`] | the colour of a light, and the three gains that make it neutral |
//! | [`gray_world`] | estimate: the mean of the scene is gray |
//! | [`white_patch`] | estimate: the brightest of the scene is white |
//! | [`gray_edge`] | estimate: the mean of the edges is gray |
//! | [`running`] | estimates over frames, such that the picture does not flicker |
//! | [`matrix`] | 3×3 matrices in fixed point, the hot loop |
//! | [`adaptation`] | scaling in XYZ and von Kries in LMS, as one such matrix |
//! | [`exact`] | matrices of 32 fraction bits that those are made of |
//!
//! An estimate and what is done with it hold for values proportional to light. On gamma-coded values the gains are still
//! what gray-world balance of everyday libraries does; matrices should be given linear values
//! ([`super::curve`]).

pub mod white;
pub mod gray_world;
pub mod white_patch;
pub mod gray_edge;
pub mod running;
pub mod matrix;
pub mod adaptation;
pub mod exact;

pub use white::{Gains, White};
