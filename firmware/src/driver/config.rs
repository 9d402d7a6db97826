//! What the sensor sends and what of it is wanted: the one thing that a user fills in.
//!
//! ```text
//!  line_clocks ───────────────┐        crop.clocks ──┐
//! ┌──────────────────────────┐│      ┌──────────────┐│
//! │     ┌─────────────┐      ││lines │ captured     ││crop.lines
//! │     │ crop window │      ││ ───► │ line_bytes ×  ││
//! │     └─────────────┘      ││      │ lines        ││
//! └──────────────────────────┘│      └──────────────┘│
//! ```
//!
//! [`Config::geometry`] is what reaches memory; [`super::lint`] says what is wrong with a configuration.

use arbitrary_int::{u13, u14};

use crate::camif::Part;
use crate::camif::pins::Edge;
use crate::camif::registers::{
    Burst, BusWidth, ByteSelect, Control, CropSize, CropStart, Extension, FrameRate, Register, Registers,
    SyncCodes,
};

/// How the sensor says where lines and frames end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncMode {
    /// The sync wires have a blanking level, and data counts only outside it.
    Gated {
        /// The level of HSYNC between lines is high.
        hsync_blank_high: bool,
        /// The level of VSYNC between frames is high.
        vsync_blank_high: bool,
    },
    /// Every pixel clock carries data; an edge of the sync wires marks the end of a line or frame.
    Marker {
        /// HSYNC fires high.
        hsync_active_high: bool,
        /// VSYNC fires high.
        vsync_active_high: bool,
    },
    /// Codes in the data.
    Embedded {
        /// The codes.
        codes: SyncCodes,
        /// The bits of the codes that are compared.
        unmask: SyncCodes,
    },
}

/// The part of a picture that is captured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Pixel clocks of a line before the window.
    pub first_clock: u32,
    /// Pixel clocks of a line in the window.
    pub clocks: u32,
    /// Lines of a frame before the window.
    pub first_line: u32,
    /// Lines in the window.
    pub lines: u32,
}

/// Which lines are captured (newer parts).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineSelect {
    /// All of them.
    All,
    /// The first, the third, and so on.
    Even,
    /// The second, the fourth, and so on.
    Odd,
}

/// What to do when frames come faster than they are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// The consumer gets the newest frame; older ones make room and count as dropped.
    NewestWins,
    /// No finished frame is given up: capture pauses while no buffer is free, and what passes meanwhile is dropped.
    InOrder,
    /// One frame each time it is asked for.
    Snapshot,
}

/// What to do with a frame that is not as configured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damaged {
    /// It is counted as lost.
    Discard,
    /// It is handed out with its verdict if what there is of it lies in its place: short, long, or uneven. A frame that
    /// lost words on the way (overrun, sync or DMA error) is never handed out.
    Deliver,
}

/// What the sensor sends, and what of it is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Data wires.
    pub bus_width: BusWidth,
    /// The clock edge at which data is stable.
    pub edge: Edge,
    /// How lines and frames are told apart.
    pub sync: SyncMode,
    /// Pixel clocks that carry data in a line. A sync code is not data. For JPEG: of the longest stretch, see `lines`.
    pub line_clocks: u32,
    /// Lines a frame. For JPEG `line_clocks × lines` is the most bytes that a frame takes.
    pub lines: u32,
    /// Captures a window only.
    pub crop: Option<Crop>,
    /// Captures some bytes of a line only.
    pub byte_select: ByteSelect,
    /// The byte selection starts with the second byte.
    pub byte_select_odd: bool,
    /// Captures some lines only.
    pub line_select: LineSelect,
    /// Compressed frames of no fixed length.
    pub jpeg: bool,
    /// Which frames are captured.
    pub frame_rate: FrameRate,
    /// Words a DMA burst, at most: a shorter one is used where it would not divide a transfer.
    pub burst: Burst,
    /// What happens when no buffer is free.
    pub policy: Policy,
    /// What happens to damaged frames.
    pub damaged: Damaged,
    /// Takes an interrupt at each line, to measure it. Without, a verdict's least and most bytes are the frame's mean,
    /// and lines of uneven length go unseen while their sum is right.
    pub line_interrupts: bool,
    /// Pixel clock in hertz, for the linter; 0 if it is not known.
    pub pclk_hz: u32,
    /// Clock of the bus matrix in hertz, for the linter; 0 if it is not known.
    pub hclk_hz: u32,
    /// The longest that the DMA waits for the bus, in bus clocks, for the linter; 0 if it is not known.
    pub bus_latency: u32,
}

impl Config {
    /// An 8-bit bus sampled on the rising edge, every frame whole; everything else can be set afterwards.
    #[must_use]
    pub const fn new(sync: SyncMode, line_clocks: u32, lines: u32) -> Self {
        Self {
            bus_width: BusWidth::Bits8,
            edge: Edge::Rising,
            sync,
            line_clocks,
            lines,
            crop: None,
            byte_select: ByteSelect::All,
            byte_select_odd: false,
            line_select: LineSelect::All,
            jpeg: false,
            frame_rate: FrameRate::All,
            burst: Burst::Four,
            policy: Policy::NewestWins,
            damaged: Damaged::Discard,
            line_interrupts: true,
            pclk_hz: 0,
            hclk_hz: 0,
            bus_latency: 0,
        }
    }

    /// What of each frame reaches memory.
    #[must_use]
    pub fn geometry(&self) -> Geometry {
        let (clocks, lines) = match self.crop {
            Some(crop) => (
                crop.clocks.min(self.line_clocks.saturating_sub(crop.first_clock)),
                crop.lines.min(self.lines.saturating_sub(crop.first_line)),
            ),
            None => (self.line_clocks, self.lines),
        };
        let line_bytes = self.selected_samples(clocks).saturating_mul(self.bus_width.bytes_per_sample());
        let lines = match self.line_select {
            LineSelect::All => lines,
            LineSelect::Even => lines.div_ceil(2),
            LineSelect::Odd => lines / 2,
        };
        Geometry { line_bytes, lines }
    }

    fn selected_samples(&self, clocks: u32) -> u32 {
        let (whole, rest) = (clocks / 4, clocks % 4);
        let odd = self.byte_select_odd;
        match self.byte_select {
            ByteSelect::All => clocks,
            ByteSelect::OneOfTwo => clocks.saturating_add(u32::from(!odd)) / 2,
            ByteSelect::OneOfFour => whole + u32::from(rest > u32::from(odd)),
            ByteSelect::TwoOfFour if odd => whole * 2 + rest.saturating_sub(2),
            ByteSelect::TwoOfFour => whole * 2 + rest.min(2),
        }
    }

    /// CR without ENABLE and CAPTURE.
    #[must_use]
    pub fn control(&self, one_frame: bool) -> Control {
        let control = Control::default()
            .with_snapshot(one_frame)
            .with_crop(self.crop.is_some())
            .with_jpeg(self.jpeg)
            .with_sample_on_rising(self.edge == Edge::Rising)
            .with_frame_rate(self.frame_rate)
            .with_bus_width(self.bus_width)
            .with_byte_select(self.byte_select)
            .with_byte_select_odd(self.byte_select_odd)
            .with_line_select(self.line_select != LineSelect::All)
            .with_line_select_odd(self.line_select == LineSelect::Odd);
        match self.sync {
            SyncMode::Gated { hsync_blank_high: horizontal, vsync_blank_high: vertical }
            | SyncMode::Marker { hsync_active_high: horizontal, vsync_active_high: vertical } => {
                control.with_hsync_blank_high(horizontal).with_vsync_blank_high(vertical)
            }
            SyncMode::Embedded { .. } => control.with_embedded_sync(true),
        }
    }

    /// Writes all registers but CR.
    pub(super) fn program(&self, registers: &mut impl Registers, part: &Part) {
        if let SyncMode::Embedded { codes, unmask } = self.sync {
            registers.write(Register::SyncCode, codes.raw_value());
            registers.write(Register::SyncUnmask, unmask.raw_value());
        }
        if let Some(crop) = self.crop {
            // The linter has refused what does not fit; masking keeps the conversions free of panics.
            let clocks = |value: u32| u14::new((value & 0x3FFF) as u16);
            let start = CropStart::default()
                .with_clocks(clocks(crop.first_clock))
                .with_line(u13::new((crop.first_line & 0x1FFF) as u16));
            let size = CropSize::default()
                .with_clocks_less_one(clocks(crop.clocks.wrapping_sub(1)))
                .with_lines_less_one(clocks(crop.lines.wrapping_sub(1)));
            registers.write(Register::CropStart, start.raw_value());
            registers.write(Register::CropSize, size.raw_value());
        }
        if part.marker {
            let marker = matches!(self.sync, SyncMode::Marker { .. });
            registers.write(Register::Extension, Extension::default().with_marker(marker).raw_value());
        }
    }
}

/// What of a frame reaches memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Geometry {
    /// Bytes a line.
    pub line_bytes: u32,
    /// Lines a frame.
    pub lines: u32,
}

impl Geometry {
    /// Bytes a frame, as the block counts them.
    #[must_use]
    pub const fn bytes(&self) -> u64 {
        self.line_bytes as u64 * self.lines as u64
    }

    /// Whole words a frame. Lines are packed; an incomplete word at the frame's end does not reach memory.
    #[must_use]
    pub const fn words(&self) -> u64 {
        self.bytes() / 4
    }

    /// Words a line that stands alone.
    #[must_use]
    pub const fn line_words(&self) -> u32 {
        self.line_bytes.div_ceil(4)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Gated, both blanking levels high.
    pub(crate) const GATED: SyncMode = SyncMode::Gated { hsync_blank_high: true, vsync_blank_high: true };
    /// Marker, both wires firing high.
    pub(crate) const MARKER: SyncMode = SyncMode::Marker { hsync_active_high: true, vsync_active_high: true };

    #[test]
    fn geometry_is_what_a_loop_over_the_samples_counts() {
        let selects = [ByteSelect::All, ByteSelect::OneOfTwo, ByteSelect::OneOfFour, ByteSelect::TwoOfFour];
        for (clocks, select) in (0..20).flat_map(|clocks| selects.map(|select| (clocks, select))) {
            for odd in [false, true] {
                let taken = |index: &u32| match select {
                    ByteSelect::All => true,
                    ByteSelect::OneOfTwo => index % 2 == u32::from(odd),
                    ByteSelect::OneOfFour => index % 4 == u32::from(odd),
                    ByteSelect::TwoOfFour => index % 4 / 2 == u32::from(odd),
                };
                let config =
                    Config { byte_select: select, byte_select_odd: odd, ..Config::new(GATED, clocks, 1) };
                let counted = (0..clocks).filter(taken).count();
                assert_eq!(
                    config.geometry().line_bytes as usize,
                    counted,
                    "{select:?} of {clocks}, odd {odd}"
                );
            }
        }
    }

    #[test]
    fn a_window_past_the_edge_takes_the_picture_only() {
        let crop = Some(Crop { first_clock: 6, clocks: 8, first_line: 1, lines: 9 });
        let config = Config { crop, ..Config::new(GATED, 10, 4) };
        assert_eq!(config.geometry(), Geometry { line_bytes: 4, lines: 3 });
        let wide = Config { bus_width: BusWidth::Bits10, line_select: LineSelect::Odd, ..config };
        assert_eq!(wide.geometry(), Geometry { line_bytes: 8, lines: 1 });
    }

    #[test]
    fn marker_wires_firing_high_are_the_polarity_bits() {
        let sync = SyncMode::Marker { hsync_active_high: true, vsync_active_high: false };
        let control = Config::new(sync, 8, 8).control(false);
        assert!(control.hsync_blank_high() && !control.vsync_blank_high() && !control.embedded_sync());
        assert!(!control.enable() && !control.capture());
    }
}
