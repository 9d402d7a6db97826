//! Makes, replays, breaks and diagnoses camera timing traces on the host.
//!
//! The map, in data-flow order:
//!
//! | module | what lives there |
//! |---|---|
//! | [`profile`] | what the wires of a camera mean, what a frame holds and how fast it comes |
//! | [`scene`] | what a virtual camera looks at |
//! | [`sensor`] | a picture becomes pixel clocks |
//! | [`picture`] | the bytes of a frame become a picture; files in and out |
#![forbid(unsafe_code)]

pub mod profile;
pub mod scene;
pub mod sensor;
pub mod picture;
