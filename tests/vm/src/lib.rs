//! What the tests in the virtual machine share.
//!
//! | module | what lives there |
//! |---|---|
//! | `bars` | the colour bars that virtual cameras show, drawn from their definition; how far a picture is from them |
//! | `command` | `host-sim` and others as a user runs them |
//!
//! `tests/vm/run` builds the tests, boots a kernel and runs them; elsewhere they are ignored.
#![cfg(all(target_os = "linux", target_pointer_width = "64"))]

pub mod bars;
pub mod command;
