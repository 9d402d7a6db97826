//! Demosaic, curves, histograms and colour balance: what a camera does to colour.
//!
//! | module | what it does |
//! |---|---|
//! | [`demosaic`] | RAW samples of a Bayer sensor become pixels |
//! | [`curve`] | gamma and other look-up tables |
//! | [`histogram`] | how often each value occurs, counted line by line |
//! | [`balance`] | the colour of the light found and taken away; 3×3 matrices |
//! | [`pointwise`] | what changes each pixel by itself, as a line filter |

pub mod demosaic;
pub mod curve;
pub mod histogram;
pub mod balance;
pub mod pointwise;
