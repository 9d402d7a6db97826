//! Where in a frame a pixel clock is, told from undisturbed wires by their profile.

use firmware::camif::pins::Pins;

use crate::profile::{Profile, SyncMode};

/// What a clock carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// A sample of the picture.
    Data,
    /// A byte of a synchronisation code.
    Code,
    /// Nothing: between lines, before the first or after the last.
    LineBlank,
    /// Nothing: VSYNC is at its blanking level, or lines of blanking pass.
    FrameBlank,
}

/// Where a clock is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Ends of frames so far.
    pub(crate) frame: u64,
    /// Data and code: the line, from 0. Blanking: lines of the frame so far.
    pub(crate) line: u32,
    /// Clocks since the part began; in a line, the sample's number.
    pub(crate) column: u32,
    pub(crate) part: Part,
}

/// Follows the wires.
#[derive(Clone, Debug)]
pub(crate) struct Tracker {
    sync: SyncMode,
    /// Levels that mean blanking (or a marker).
    levels: (bool, bool),
    samples: u32,
    place: Place,
    /// Markers seen at the clock before.
    marked: (bool, bool),
    started: bool,
    /// The last bytes, the newest lowest.
    bytes: u32,
    /// The code last seen was one of a line of blanking.
    blanking: bool,
}

impl Tracker {
    pub(crate) fn new(profile: &Profile) -> Self {
        Self {
            sync: profile.bus.sync,
            levels: (profile.bus.hsync_blank.is_high(), profile.bus.vsync_blank.is_high()),
            samples: profile.samples_per_line(),
            place: Place { frame: 0, line: 0, column: 0, part: Part::FrameBlank },
            marked: (false, false),
            started: false,
            bytes: 0,
            blanking: true,
        }
    }

    pub(crate) fn clock(&mut self, pins: Pins) -> Place {
        let wires = (pins.sync.hsync == self.levels.0, pins.sync.vsync == self.levels.1);
        match self.sync {
            SyncMode::Gated => self.gated(wires),
            SyncMode::Marker => self.marker(wires),
            SyncMode::Embedded => self.embedded(pins.data as u8),
        }
        self.started = true;
        self.place
    }

    fn gated(&mut self, (hsync, vsync): (bool, bool)) {
        let part = match (hsync, vsync) {
            (_, true) => Part::FrameBlank,
            (true, false) => Part::LineBlank,
            (false, false) => Part::Data,
        };
        let before = self.place.part;
        if part == before && self.started {
            self.place.column += 1;
            return;
        }
        if before == Part::Data {
            self.place.line += 1;
        }
        if part == Part::FrameBlank {
            self.place.frame += 1;
        }
        if before == Part::FrameBlank {
            self.place.line = 0;
        }
        (self.place.part, self.place.column) = (part, 0);
    }

    fn marker(&mut self, wires: (bool, bool)) {
        let (line, frame) = (wires.0 && !self.marked.0, wires.1 && !self.marked.1);
        self.marked = wires;
        self.place.part = Part::Data;
        if !self.started {
            return;
        }
        self.place.column += 1;
        if line {
            self.place.line += 1;
            self.place.column = 0;
        }
        if frame {
            (self.place.frame, self.place.line, self.place.column) = (self.place.frame + 1, 0, 0);
        }
    }

    fn embedded(&mut self, byte: u8) {
        let place = &mut self.place;
        if self.bytes & 0x00FF_FFFF == 0x00FF_0000 && self.started {
            // This byte says which code it is.
            place.part = Part::Code;
            match byte {
                0x80 => {
                    if self.blanking {
                        (place.frame, place.line) = (place.frame + 1, 0);
                    }
                    self.blanking = false;
                }
                0x9D => {}
                _ => self.blanking = true,
            }
        } else if self.bytes == 0xFF00_0080 {
            (place.part, place.column) = (Part::Data, 0);
        } else if place.part == Part::Data {
            place.column += 1;
            if place.column >= self.samples {
                (place.part, place.column) = (Part::Code, place.column);
            }
        } else if self.bytes == 0xFF00_009D {
            *place = Place { line: place.line + 1, column: 0, part: Part::LineBlank, ..*place };
        } else if matches!(self.bytes, 0xFF00_00AB | 0xFF00_00B6) {
            (place.part, place.column) = (Part::FrameBlank, 0);
        } else if byte == 0xFF {
            place.part = Part::Code;
        } else {
            place.column += 1;
        }
        self.bytes = self.bytes << 8 | u32::from(byte);
    }
}
