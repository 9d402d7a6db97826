//! What to change, by class: in words, as a key of the profile, as a bit of a register.

use super::finding::Remedy;
use crate::fault::FaultKind;
use crate::profile::{Choice, Level, Profile, SyncMode};
use firmware::camif::pins::Edge;

/// The remedy for a class on this profile's wires.
pub(super) fn of(kind: FaultKind, profile: &Profile) -> Remedy {
    use FaultKind as K;
    let other = |level: Level| if level.is_high() { Level::Low } else { Level::High };
    match kind {
        K::ClockGlitch => Remedy::new(
            "the clock wire rings or picks up noise: shorten it, add 22 to 47 ohms in series at the sensor, run ground beside it",
        ),
        K::MissingClock => Remedy::new(
            "edges of the clock are lost: check PCLK's level and drive strength, and the analyser's threshold and rate",
        ),
        K::ClockJitter => Remedy::new(
            "data is sampled close to where it changes: move the sampling edge or lower the pixel clock, and look at set-up and hold",
        ),
        K::WrongEdge => {
            let edge = if profile.bus.clock_edge == Edge::Rising { Edge::Falling } else { Edge::Rising };
            Remedy::new("sample on the other edge of the clock")
                .profile(format!("bus.clock_edge = \"{}\"", edge.name()))
                .register(format!("CR.PCKPOL = {}", u32::from(edge == Edge::Rising)))
        }
        K::ClockTooFast => Remedy::new(
            "lower the sensor's clock (its prescaler or PLL), or capture fewer bytes; HCLK must be 2.5 times PCLK at least",
        )
        .profile(format!("timing.pclk_hz = {}", profile.timing.pclk_hz))
        .register("CR.FCRC = 1 captures every second frame"),
        K::Undersampling => {
            Remedy::new("sample at 4 times the pixel clock at least, or lower the pixel clock for the capture")
        }
        K::ShortLine | K::LongLine => Remedy::new(
            "the sensor's window and the profile's width disagree in some lines: check the sensor's HREF start and stop registers",
        ),
        K::LineStartLoss => Remedy::new(
            "HREF rises late against the data: move the sensor's HSTART earlier, or check the delay of the HSYNC wire",
        ),
        K::ShortBlanking => Remedy::new(
            "give the receiver its time between lines: raise the sensor's horizontal blanking (dummy pixels), or tell the profile",
        )
        .profile("timing.hblank = the measured gap, if the receiver can do with it"),
        K::MissingHsync => Remedy::new("HSYNC does not show every line's end: check the wire, its level and its pull")
            .register(format!("CR.HSPOL = {}", u32::from(profile.bus.hsync_blank.is_high()))),
        K::SpuriousHsync => {
            Remedy::new("HSYNC has pulses within lines: look for crosstalk from data wires and add a series resistor")
        }
        K::MissingVsync => Remedy::new("VSYNC does not show every frame's end: check the wire, its level and its pull")
            .register(format!("CR.VSPOL = {}", u32::from(profile.bus.vsync_blank.is_high()))),
        K::SpuriousVsync => {
            Remedy::new("VSYNC has short pulses within frames: look for crosstalk and add a series resistor")
        }
        K::VsyncInFrame => Remedy::new(
            "the sensor starts a new frame before this one's end: it was reset or written to, or its height is not the profile's",
        ),
        K::InvertedHsync => {
            let level = other(profile.bus.hsync_blank);
            Remedy::new("exchange the levels of HSYNC")
                .profile(format!("bus.hsync_blank = \"{}\"", level.name()))
                .register(format!("CR.HSPOL = {}", u32::from(level.is_high())))
        }
        K::InvertedVsync => {
            let level = other(profile.bus.vsync_blank);
            Remedy::new("exchange the levels of VSYNC")
                .profile(format!("bus.vsync_blank = \"{}\"", level.name()))
                .register(format!("CR.VSPOL = {}", u32::from(level.is_high())))
        }
        K::StuckBit => Remedy::new("check that wire for an open joint, a short to ground or supply, and its pin's function"),
        K::SwappedBits => Remedy::new("exchange the two wires, or their pins, or name them so with --map"),
        K::ShortedBits => Remedy::new("look for a solder bridge between the two wires"),
        K::ShiftedBits => Remedy::new(
            "connect the sensor's highest data wire to the bus's highest: sensors of 10 bits use D9 to D2 for 8",
        )
        .register("CR.EDM = the width that the sensor drives"),
        K::ReversedBus => Remedy::new("connect D0 to D0: the data wires are in reverse, perhaps at a flat cable's end"),
        K::ByteSlip if profile.bus.sync == SyncMode::Gated => Remedy::new(
            "HREF comes late against the data by that many clocks: move the sensor's HSTART and HSTOP, or crop",
        )
        .register("CWSTRT.HOFFCNT = samples up to the next pixel, with CR.CROP = 1"),
        K::ByteSlip => Remedy::new("the line's mark comes late against the data: move the sensor's HSTART"),
        K::ByteSwap => Remedy::new("exchange the two bytes in the sensor's format register, or tell the profile"),
        K::FormatMismatch => Remedy::new("set the sensor to the profile's format, or tell the profile what it sends"),
        K::BayerPhase => Remedy::new("the window starts on another colour: move it by a pixel, undo a flip, or tell the profile"),
        K::RedBlueSwap => Remedy::new("exchange red and blue in the sensor's format register"),
    }
}
