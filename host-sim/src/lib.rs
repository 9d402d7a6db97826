//! Makes, replays, breaks and diagnoses camera timing traces on the host.
#![forbid(unsafe_code)]

pub mod trace;
