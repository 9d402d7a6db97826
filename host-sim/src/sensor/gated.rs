//! Sync by levels: data counts while neither wire is at its blanking level.
//!
//! ```text
//!  data  ......▓▓▓▓▓..▓▓▓▓▓....▓▓▓▓▓     two lines a frame; all blanking levels high here
//! HSYNC  ‾‾‾‾‾‾_____‾‾_____‾‾‾‾_____     hblank between lines
//! VSYNC  ‾‾‾‾‾_____________‾‾‾______     vblank between frames; vfront and vback before and after it
//! ```
//!
//! A stream starts with VSYNC at its blanking level, which a receiver needs to see a frame's start, and ends there.
//! The bus holds 0 in blanking.

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::lines::{Lines, lines_of};
use crate::profile::Profile;

/// The wires, each in blanking or not.
fn levels(profile: &Profile, hsync: bool, vsync: bool) -> Sync {
    Sync {
        hsync: hsync == profile.bus.hsync_blank.is_high(),
        vsync: vsync == profile.bus.vsync_blank.is_high(),
    }
}

/// Blank clocks, none if there are none.
fn blank<S: StretchSink>(sink: &mut S, sync: Sync, clocks: u32) -> Result<(), S::Error> {
    if clocks == 0 { Ok(()) } else { sink.stretch(sync, Samples::Repeat { value: 0, clocks }) }
}

pub(super) fn frame<S: StretchSink>(
    profile: &Profile,
    lines: &mut Lines,
    bytes: &[u8],
    is_first: bool,
    sink: &mut S,
) -> Result<(), S::Error> {
    let between_lines = levels(profile, true, false);
    if !is_first {
        blank(sink, between_lines, profile.timing.vfront)?;
    }
    blank(sink, levels(profile, true, true), vsync_clocks(profile))?;
    blank(sink, between_lines, profile.timing.vback)?;
    for (y, line) in lines_of(profile, bytes).enumerate() {
        if y > 0 {
            blank(sink, between_lines, profile.timing.hblank)?;
        }
        sink.stretch(levels(profile, false, false), lines.samples(profile, line))?;
    }
    Ok(())
}

pub(super) fn close<S: StretchSink>(profile: &Profile, sink: &mut S) -> Result<(), S::Error> {
    blank(sink, levels(profile, true, false), profile.timing.vfront)?;
    blank(sink, levels(profile, true, true), vsync_clocks(profile))
}

/// Clocks with VSYNC at its blanking level.
fn vsync_clocks(profile: &Profile) -> u32 {
    let timing = &profile.timing;
    timing.vblank.saturating_sub(timing.vfront).saturating_sub(timing.vback)
}
