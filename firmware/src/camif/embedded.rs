//! Embedded synchronisation: the codes FF 00 00 XY in the data of an 8-bit bus.
//!
//! ```text
//! … FF 00 00 LSC  d d d d …  FF 00 00 LEC  … FF 00 00 LSC  d d …  FF 00 00 LEC … FF 00 00 FEC
//!                ╰── line ──╯                             ╰─ line ─╯
//! ```
//!
//! FF 00 00 may be the start of a code, so three bytes wait in a delay line until the fourth shows that they are data.
//!
//! Where the manuals leave room (RM0090 §15.5.3), this block takes these sides: FSC starts the frame but opens no line;
//! with FSC = FF the first LSC after an FEC starts the frame and its first line; a code out of order (a line start inside
//! a line, a line end outside one, a frame start inside a frame, a frame end inside a line) is a synchronisation error.

use super::registers::SyncCodes;

/// What a byte of the stream turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// Not known yet, or not of interest.
    Nothing,
    /// A byte of the line, three clocks late.
    Data(u8),
    /// The frame starts.
    FrameStart,
    /// The frame starts with its first line (FSC = FF).
    FrameAndLineStart,
    /// A line starts.
    LineStart,
    /// The line ends.
    LineEnd,
    /// The frame ends.
    FrameEnd,
    /// A code out of order.
    Error,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    /// Before a frame; with FSC = FF an FEC must have been seen.
    #[default]
    Outside,
    /// Before a frame, after an FEC.
    AfterFrame,
    /// In a frame, between lines.
    Frame,
    /// In a line.
    Line,
}

/// The delay line and the place in the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Decoder {
    history: u32,
    held: u8,
    place: Place,
}

impl Decoder {
    pub(super) fn in_line(&self) -> bool {
        self.place == Place::Line
    }

    pub(super) fn in_frame(&self) -> bool {
        matches!(self.place, Place::Line | Place::Frame)
    }

    /// Takes the next byte.
    #[inline]
    pub(super) fn push(&mut self, byte: u8, codes: SyncCodes, unmask: SyncCodes) -> Found {
        self.history = self.history << 8 | u32::from(byte);
        if self.held < 3 {
            self.held += 1;
            return Found::Nothing;
        }
        if self.history >> 8 == 0x00FF_0000 {
            self.held = 0;
            return self.code(byte, codes, unmask);
        }
        if self.place == Place::Line { Found::Data((self.history >> 24) as u8) } else { Found::Nothing }
    }

    fn code(&mut self, code: u8, codes: SyncCodes, unmask: SyncCodes) -> Found {
        let is = |wanted: u8, mask: u8| (code ^ wanted) & mask == 0;
        let implicit_start = codes.frame_start() == 0xFF;
        let frame_start = !implicit_start && is(codes.frame_start(), unmask.frame_start());
        let line_start = is(codes.line_start(), unmask.line_start());
        let line_end = is(codes.line_end(), unmask.line_end());
        let frame_end = if codes.frame_end() == 0xFF {
            !(frame_start || line_start || line_end)
        } else {
            is(codes.frame_end(), unmask.frame_end())
        };
        let (place, found) = match self.place {
            Place::Line if line_end => (Place::Frame, Found::LineEnd),
            Place::Frame if line_start => (Place::Line, Found::LineStart),
            Place::Frame if frame_end => (Place::AfterFrame, Found::FrameEnd),
            Place::Line | Place::Frame if frame_start || line_start || line_end || frame_end => {
                // A frame end says where the next frame starts, even out of order.
                (if frame_end { Place::AfterFrame } else { Place::Outside }, Found::Error)
            }
            Place::Outside | Place::AfterFrame if frame_start => (Place::Frame, Found::FrameStart),
            Place::AfterFrame if implicit_start && line_start => (Place::Line, Found::FrameAndLineStart),
            Place::Outside if frame_end => (Place::AfterFrame, Found::Nothing),
            place => (place, Found::Nothing),
        };
        self.place = place;
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BT656: u32 = 0xFF9D_80FF;

    /// One letter a byte found: `F` frame start, `L` line start, `B` both, `l` line end, `f` frame end, `!` error.
    fn decode(bytes: &[u8], codes: u32, unmask: u32) -> String {
        let mut decoder = Decoder::default();
        let (codes, unmask) = (SyncCodes::new_with_raw_value(codes), SyncCodes::new_with_raw_value(unmask));
        bytes
            .iter()
            .filter_map(|&byte| match decoder.push(byte, codes, unmask) {
                Found::Nothing => None,
                Found::Data(data) => Some((b'a' + data % 26) as char),
                Found::FrameStart => Some('F'),
                Found::FrameAndLineStart => Some('B'),
                Found::LineStart => Some('L'),
                Found::LineEnd => Some('l'),
                Found::FrameEnd => Some('f'),
                Found::Error => Some('!'),
            })
            .collect()
    }

    fn stream(parts: &[&[u8]]) -> Vec<u8> {
        parts
            .iter()
            .flat_map(|part| if part.len() == 1 { [&[0xFF, 0, 0], *part].concat() } else { part.to_vec() })
            .collect()
    }

    #[test]
    fn bt656_starts_with_the_first_line_after_a_frame_end() {
        let bytes = stream(&[
            &[0x80],
            &[9, 9],
            &[0x9D],
            &[0xB6],
            &[0x80],
            &[0, 1],
            &[0x9D],
            &[0x80],
            &[2, 3],
            &[0x9D],
            &[0xAB],
        ]);
        assert_eq!(decode(&bytes, BT656, !0), "BablLcdlf");
    }

    #[test]
    fn explicit_codes_and_masks() {
        let codes = 0x0403_0201;
        let bytes = stream(&[&[0xF1], &[0xF2], &[0, 1], &[0xF3], &[0xF4], &[0x02]]);
        assert_eq!(decode(&bytes, codes, 0x0F0F_0F0F), "FLablf", "only the low half of each code counts");
        assert_eq!(decode(&bytes, codes, !0), "", "and all of it when unmasked");
    }

    #[test]
    fn codes_out_of_order_are_errors() {
        let codes = 0x0403_0201;
        for (bad, expected) in [([1, 3], "F!"), ([1, 1], "F!")] {
            assert_eq!(decode(&stream(&[&[bad[0]], &[bad[1]]]), codes, !0), expected);
        }
        let nested = stream(&[&[1], &[2], &[0, 1, 2, 3], &[2]]);
        assert_eq!(decode(&nested, codes, !0), "FLabcd!");
        let unfinished = stream(&[&[1], &[2], &[0, 1, 2, 3], &[4]]);
        assert_eq!(decode(&unfinished, codes, !0), "FLabcd!");
    }

    #[test]
    fn data_that_looks_like_a_code_start_is_data() {
        let bytes = stream(&[&[1], &[2], &[0xFF, 0, 1, 0xFF, 0, 0], &[3]]);
        // FF 00 00 followed by FF is no code of ours, and swallows the code that was to follow.
        assert_eq!(decode(&bytes, 0x0403_0201, !0), "FLvab");
        let bytes = stream(&[&[1], &[2], &[0xFF, 0, 1, 5, 6], &[3]]);
        assert_eq!(decode(&bytes, 0x0403_0201, !0), "FLvabfgl");
    }
}
