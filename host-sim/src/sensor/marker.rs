//! Sync by markers: every clock carries data.
//!
//! ```text
//!  data  0 1 2 3 4 5 6 7 8 9 …          lines of 4 samples, frames of 2 lines
//! HSYNC  ________┌─┐_____┌─┐__          the edge at sample k: the line ended before k
//! VSYNC  ________________┌─┐__          the same for the frame
//! ```
//!
//! The first sample of a stream has no marker, for nothing ended before it. One idle clock with both markers closes
//! the last frame.

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::lines::{Lines, lines_of};
use crate::profile::Profile;

/// The wires, each active or not.
fn levels(profile: &Profile, hsync: bool, vsync: bool) -> Sync {
    Sync {
        hsync: hsync == profile.bus.hsync_blank.is_high(),
        vsync: vsync == profile.bus.vsync_blank.is_high(),
    }
}

pub(super) fn frame<S: StretchSink>(
    profile: &Profile,
    lines: &mut Lines,
    bytes: &[u8],
    is_first: bool,
    sink: &mut S,
) -> Result<(), S::Error> {
    for (y, line) in lines_of(profile, bytes).enumerate() {
        let mut samples = lines.samples(profile, line);
        if y > 0 || !is_first {
            sink.stretch(levels(profile, true, y == 0), samples.take(1))?;
            samples = samples.skip(1);
        }
        sink.stretch(levels(profile, false, false), samples)?;
    }
    Ok(())
}

pub(super) fn close<S: StretchSink>(profile: &Profile, sink: &mut S) -> Result<(), S::Error> {
    sink.stretch(levels(profile, true, true), Samples::Repeat { value: 0, clocks: 1 })
}
