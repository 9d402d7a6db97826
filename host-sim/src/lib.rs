//! Makes, replays, breaks and diagnoses camera timing traces on the host.
//!
//! The map, in data-flow order:
//!
//! | module | what lives there |
//! |---|---|
//! | [`profile`] | what the wires of a camera mean, what a frame holds and how fast it comes |
//! | [`scene`] | what a virtual camera looks at |
//! | [`sensor`] | a picture becomes pixel clocks |
//! | [`fault`] | what goes wrong on the way to the pins, put in on purpose |
//! | [`trace`] | pixel clocks in files: `.camt` and VCD, read and written |
//! | [`receiver`] | pixel clocks go through block and driver, and frames come out |
//! | [`diagnosis`] | what is wrong with a trace, where, and what to change |
//! | [`campaign`] | faults × seeds × profiles, diagnosed without knowing them |
//! | [`picture`] | the bytes of a frame become a picture; files in and out |
//! | [`guess`] | the profile of a trace that has none |
//! | [`pipeline`] | the algorithms by name, on a picture |
//! | [`report`] | a diagnosis as one HTML file, and as JUnit |
//! | [`capture`] | real cameras: V4L2 |
//! | [`stream`] | a device on a serial line, played |
//! | `frequency` | which value comes most often |
//! | [`command`] | the command line |
#![forbid(unsafe_code)]

pub mod profile;
pub mod scene;
pub mod sensor;
pub mod fault;
pub mod trace;
pub mod receiver;
pub mod diagnosis;
pub mod campaign;
pub mod picture;
pub mod guess;
pub mod pipeline;
pub mod report;
pub mod capture;
pub mod stream;
mod frequency;
pub mod command;
