//! Which samples of a frame are taken: crop window, byte selection, line selection.
//!
//! Clocks and lines are counted from the start of the line and of the frame, for the window and the selections alike.
//! CAPCNT is the number of clocks less one (RM0090 §15.8.10; §15.5.5 would have its two low bits read as zero).

use super::registers::{ByteSelect, Control, CropSize, CropStart};

/// The selection of a frame, worked out from the registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Selection {
    /// Clocks of a line that are taken: `from..to`.
    pub(super) from: u32,
    pub(super) to: u32,
    /// Lines of a frame that are taken: `first_line..end_line`.
    first_line: u32,
    end_line: u32,
    /// Bit n: clock n of each four is taken.
    pub(super) bytes: u8,
    /// Bit n: line n of each two is taken.
    lines: u8,
}

/// Takes all four clocks of four.
pub(super) const ALL_BYTES: u8 = 0b1111;

impl Selection {
    /// Nothing at all: between lines, and in frames that are not captured.
    pub(super) const NOTHING: Self = Self { from: 0, to: 0, first_line: 0, end_line: 0, bytes: 0, lines: 0 };

    pub(super) fn new(control: Control, start: CropStart, size: CropSize) -> Self {
        // In JPEG the wires do not tell lines: everything is taken.
        let crop = control.crop() && !control.jpeg();
        let (from, to, first_line, end_line) = if crop {
            let (from, first) = (u32::from(start.clocks().value()), u32::from(start.line().value()));
            let clocks = u32::from(size.clocks_less_one().value()) + 1;
            let lines = u32::from(size.lines_less_one().value()) + 1;
            (from, from + clocks, first, first + lines)
        } else {
            (0, u32::MAX, 0, u32::MAX)
        };
        // Selections do not exist on a wider bus (RM0433: the field must be left at its reset value).
        let selects = control.bus_width().bits() == 8 && !control.jpeg();
        let bytes = match (control.byte_select(), control.byte_select_odd()) {
            _ if !selects => ALL_BYTES,
            (ByteSelect::All, _) => ALL_BYTES,
            (ByteSelect::OneOfTwo, false) => 0b0101,
            (ByteSelect::OneOfTwo, true) => 0b1010,
            (ByteSelect::OneOfFour, false) => 0b0001,
            (ByteSelect::OneOfFour, true) => 0b0010,
            (ByteSelect::TwoOfFour, false) => 0b0011,
            (ByteSelect::TwoOfFour, true) => 0b1100,
        };
        let lines = match (control.line_select() && !control.jpeg(), control.line_select_odd()) {
            (false, _) => 0b11,
            (true, false) => 0b01,
            (true, true) => 0b10,
        };
        Self { from, to, first_line, end_line, bytes, lines }
    }

    /// Something of this line is taken.
    pub(super) fn takes_line(&self, line: u32) -> bool {
        (self.first_line..self.end_line).contains(&line) && self.lines >> (line & 1) & 1 != 0
    }

    /// No line from this one on is in the window.
    pub(super) fn is_past(&self, line: u32) -> bool {
        line >= self.end_line
    }

    /// This clock of a line is taken.
    #[inline]
    pub(super) fn takes_clock(&self, clock: u32) -> bool {
        clock >= self.from && clock < self.to && self.bytes >> (clock & 3) & 1 != 0
    }
}
