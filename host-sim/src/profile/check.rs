use std::fmt;

use super::{Choice, Profile, ProfileError, SyncMode};

/// Whole numbers from the first to the last, both included, and their unit.
#[derive(Clone, Copy)]
pub(super) struct Range {
    first: u32,
    last: u32,
    unit: &'static str,
}

impl Range {
    pub(super) fn contains(self, value: u32) -> bool {
        (self.first..=self.last).contains(&value)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {} {}", self.first, self.last, self.unit)
    }
}

/// Sides of a frame: the largest then takes 201 million bytes, so that a hostile profile can't exhaust memory.
pub(super) const SIZE: Range = Range { first: 1, last: 8_192, unit: "pixels" };
/// Blanking of a line: its longest is seconds at any clock that a camera has.
pub(super) const HBLANK: Range = Range { first: 0, last: 10_000_000, unit: "pixel clocks" };
/// Blanking of a frame and its parts.
pub(super) const VBLANK: Range = Range { first: 0, last: 1_000_000_000, unit: "pixel clocks" };
/// The pixel clock.
pub(super) const PCLK: Range = Range { first: 1, last: 1_000_000_000, unit: "Hz" };
/// Widths of the bus.
pub(super) const BITS: [u32; 4] = [8, 10, 12, 14];

pub(super) fn allowed_bits() -> String {
    "8, 10, 12 or 14".to_owned()
}

/// Clocks of the two codes around a line with embedded sync: EAV and SAV.
const CODES: u32 = 8;

impl Profile {
    /// Checks every value and what the values must be to one another.
    ///
    /// Profiles that were read have passed this; call it on one that was built or changed by code.
    ///
    /// # Errors
    /// [`ProfileError::Range`] or [`ProfileError::Conflict`], which says what to change.
    pub fn check(&self) -> Result<(), ProfileError> {
        if !BITS.contains(&self.bus.bits) {
            let (got, allowed) = (self.bus.bits.to_string(), allowed_bits());
            return Err(ProfileError::Range { line: None, key: "bits", got, allowed });
        }
        for (key, value, range) in [
            ("width", self.frame.width, SIZE),
            ("height", self.frame.height, SIZE),
            ("pclk_hz", self.timing.pclk_hz, PCLK),
            ("hblank", self.timing.hblank, HBLANK),
            ("vblank", self.timing.vblank, VBLANK),
            ("vfront", self.timing.vfront, VBLANK),
            ("vback", self.timing.vback, VBLANK),
        ] {
            if !range.contains(value) {
                let (got, allowed) = (value.to_string(), range.to_string());
                return Err(ProfileError::Range { line: None, key, got, allowed });
            }
        }
        self.check_format()?;
        self.check_timing()
    }

    fn check_format(&self) -> Result<(), ProfileError> {
        let (bits, format) = (self.bus.bits, self.frame.format);
        let needed = self.frame.sample_bits();
        let fits = if needed == 8 { bits == 8 } else { bits >= needed };
        if !fits {
            return Err(conflict(
                format!("`{}` does not fit a bus of {bits} bits", format.name()),
                if needed == 8 {
                    "set `bits = 8`, or a raw format of more bits".to_owned()
                } else {
                    format!("set `bits = {needed}`, or `format = \"raw8\"`")
                },
            ));
        }
        if self.frame.is_yuv422() && self.frame.width % 2 == 1 {
            return Err(conflict(
                format!("`{}` holds pixels in pairs and `width` is {}", format.name(), self.frame.width),
                format!("set `width = {}`", self.frame.width + 1),
            ));
        }
        if self.bus.sync == SyncMode::Embedded && bits != 8 {
            return Err(conflict(
                format!("embedded sync codes need a bus of 8 bits and `bits` is {bits}"),
                "set `bits = 8` and a format of 8-bit samples, or `sync = \"gated\"`".to_owned(),
            ));
        }
        Ok(())
    }

    fn check_timing(&self) -> Result<(), ProfileError> {
        let timing = &self.timing;
        let line = self.samples_per_line();
        if self.bus.sync != SyncMode::Gated && (timing.vfront, timing.vback) != (0, 0) {
            return Err(conflict(
                format!("`vfront` and `vback` mean nothing with `sync = \"{}\"`", self.bus.sync.name()),
                "remove them, or set `sync = \"gated\"`".to_owned(),
            ));
        }
        match self.bus.sync {
            SyncMode::Marker if timing.hblank != 0 || timing.vblank != 0 => Err(conflict(
                "with `sync = \"marker\"` every pixel clock carries data".to_owned(),
                "set `hblank = 0` and `vblank = 0`, or `sync = \"gated\"`".to_owned(),
            )),
            SyncMode::Marker if line < 2 => Err(conflict(
                "with `sync = \"marker\"` and one sample a line HSYNC never falls, so no line can end"
                    .to_owned(),
                "set `width` to 2 or more".to_owned(),
            )),
            SyncMode::Gated if timing.hblank == 0 => Err(conflict(
                "with `sync = \"gated\"` only blanking tells lines apart and `hblank` is 0".to_owned(),
                "set `hblank` to 1 or more, or `sync = \"marker\"`".to_owned(),
            )),
            SyncMode::Gated if u64::from(timing.vblank) <= porches(self) => Err(conflict(
                format!(
                    "with `sync = \"gated\"` VSYNC needs a clock at its blanking level: `vblank` is {}, of which \
                     `vfront` and `vback` take {}",
                    timing.vblank,
                    porches(self)
                ),
                format!("set `vblank` to {} or more", porches(self) + 1),
            )),
            SyncMode::Embedded if timing.hblank < CODES => Err(conflict(
                format!("`hblank` is {} and must hold the two sync codes of 4 clocks each", timing.hblank),
                format!("set `hblank` to {CODES} or more"),
            )),
            SyncMode::Embedded if timing.vblank < blank_line(self) => Err(conflict(
                format!(
                    "`vblank` is {} and must hold a line of blanking, whose codes end the frame",
                    timing.vblank
                ),
                format!("set `vblank` to {} or more", blank_line(self)),
            )),
            _ => Ok(()),
        }
    }
}

fn porches(profile: &Profile) -> u64 {
    u64::from(profile.timing.vfront) + u64::from(profile.timing.vback)
}

/// Clocks of the least vertical blanking with embedded sync: a line and the blanking on either side.
fn blank_line(profile: &Profile) -> u32 {
    profile.samples_per_line().saturating_add(profile.timing.hblank.saturating_mul(2))
}

fn conflict(what: String, remedy: String) -> ProfileError {
    ProfileError::Conflict { what, remedy }
}
