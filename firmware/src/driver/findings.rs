//! The linter's findings: how bad, what, why, and what to do about it.

use core::fmt;

use crate::camif::registers::Burst;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// It works, but perhaps not as meant.
    Warning,
    /// It can't work; the driver refuses to start.
    Error,
}

/// One thing that is wrong with a configuration; displayed with its reason and remedy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// What it is.
    pub code: Code,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Code {
    /// Nothing would reach memory.
    EmptyFrame {
        /// Bytes a line.
        line_bytes: u32,
        /// Lines a frame.
        lines: u32,
    },
    /// A frame is larger than a buffer can be.
    FrameTooLarge {
        /// Words a frame.
        words: u64,
    },
    /// The bus clock is too slow to sample the pixel clock.
    ClockRatio {
        /// Pixel clock.
        pclk_hz: u32,
        /// Bus clock.
        hclk_hz: u32,
        /// Least bus clock.
        needed_hz: u64,
    },
    /// The bus may let the FIFO overrun.
    SlowBus {
        /// Words a burst.
        burst: Burst,
        /// Bus clocks that the DMA may wait.
        latency: u32,
        /// Bus clocks from the DMA's request to the overrun.
        slack: u32,
    },
    /// The part has no marker synchronisation.
    NoMarker {
        /// The part.
        part: &'static str,
    },
    /// Embedded synchronisation needs an 8-bit bus.
    EmbeddedBusWidth {
        /// Wires configured.
        bits: u32,
    },
    /// The part can't select bytes or lines.
    NoSelection {
        /// The part.
        part: &'static str,
    },
    /// Byte selection needs an 8-bit bus.
    ByteSelectBusWidth {
        /// Wires configured.
        bits: u32,
    },
    /// Compressed frames exclude something else that is configured.
    Jpeg {
        /// What.
        with: &'static str,
    },
    /// A number does not fit its field of the crop registers.
    CropField {
        /// The field.
        field: &'static str,
        /// The number.
        value: u32,
        /// Least that fits.
        least: u32,
        /// Most that fits.
        most: u32,
    },
    /// The crop window is larger than the picture.
    CropPastFrame {
        /// Pixel clocks a line.
        line_clocks: u32,
        /// Lines a frame.
        lines: u32,
    },
    /// A line of the crop window is not a multiple of a word.
    CropWords {
        /// Bytes a line of it.
        bytes: u32,
    },
    /// The frame rate has no effect.
    FrameRateIgnored {
        /// On captures of what.
        why: &'static str,
    },
    /// A line is longer than a transfer can be.
    LineTransfer {
        /// Words a line.
        words: u32,
        /// Most words a transfer.
        limit: u32,
    },
    /// Lines packed by the part are not multiples of a word.
    LineAlignment {
        /// Bytes a line.
        bytes: u32,
    },
    /// The FIFO holds whole lines.
    ShortLine {
        /// Words a line.
        words: u32,
    },
    /// The last bytes of a frame don't fill a word and don't reach memory.
    FrameAlignment {
        /// Bytes a frame.
        bytes: u64,
    },
    /// The DMA has to be restarted at each frame's end.
    RestartEachFrame {
        /// Words a frame.
        words: u64,
        /// Because it is hardly longer than the FIFO, rather than because equal transfers do not fill it.
        short: bool,
    },
    /// A shorter burst is used, because the one configured does not divide a transfer.
    BurstShortened {
        /// Configured.
        burst: Burst,
        /// Used.
        used: Burst,
        /// Words a transfer.
        words: u32,
    },
    /// Reserved bits are set.
    ReservedBits {
        /// Which.
        bits: u32,
    },
    /// FCRC has its reserved value.
    ReservedFrameRate,
}

impl Finding {
    pub(super) const fn new(code: Code) -> Self {
        let severity = match code {
            Code::SlowBus { .. }
            | Code::CropPastFrame { .. }
            | Code::CropWords { .. }
            | Code::FrameAlignment { .. }
            | Code::RestartEachFrame { .. }
            | Code::BurstShortened { .. }
            | Code::ShortLine { .. } => Severity::Warning,
            _ => Severity::Error,
        };
        Self { severity, code }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        write!(f, "{severity}: {}", self.code)
    }
}

impl core::error::Error for Finding {}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::EmptyFrame { line_bytes, lines } => write!(
                f,
                "a frame of {lines} lines of {line_bytes} bytes holds no word; check the frame's size, the crop window and the selection"
            ),
            Self::FrameTooLarge { words } => {
                write!(
                    f,
                    "a frame of {words} words is larger than a buffer can be; crop it, or capture line by line"
                )
            }
            Self::ClockRatio { pclk_hz, hclk_hz, needed_hz } => write!(
                f,
                "HCLK is {hclk_hz} Hz where PCLK of {pclk_hz} Hz needs at least {needed_hz} Hz; lower the sensor's pixel clock or raise HCLK"
            ),
            Self::SlowBus { burst, latency, slack } => write!(
                f,
                "with bursts of {} words the FIFO overruns {slack} bus clocks after the DMA's request, and the bus may take {latency}; \
                 use a shorter burst, raise the DMA's priority or lower the pixel clock",
                burst.words()
            ),
            Self::NoMarker { part } => write!(
                f,
                "{part} has no marker synchronisation; set the sensor to blank its data (gated), or use a part that has it"
            ),
            Self::EmbeddedBusWidth { bits } => write!(
                f,
                "embedded synchronisation works on an 8-bit bus, not on {bits} wires; use 8 bits or the sync wires"
            ),
            Self::NoSelection { part } => write!(
                f,
                "{part} can't select bytes or lines (those bits of CR are reserved); capture all and select in software"
            ),
            Self::ByteSelectBusWidth { bits } => write!(
                f,
                "byte selection works on an 8-bit bus, not on {bits} wires; capture all and select in software"
            ),
            Self::Jpeg { with } => write!(f, "compressed frames exclude {with}; turn one of the two off"),
            Self::CropField { field, value, least, most } => write!(
                f,
                "{value} does not fit the crop window's {field}, which takes {least} to {most}; move or shrink the window"
            ),
            Self::CropPastFrame { line_clocks, lines } => write!(
                f,
                "the crop window reaches past the picture of {lines} lines of {line_clocks} pixel clocks, and only the picture is captured; shrink the window"
            ),
            Self::CropWords { bytes } => write!(
                f,
                "a line of the crop window is {bytes} bytes, which words don't fill, and manuals differ on what parts make of it; use a multiple of 4"
            ),
            Self::FrameRateIgnored { why } => write!(
                f,
                "the frame rate has no effect on captures {why}; capture all frames and leave some out"
            ),
            Self::LineTransfer { words, limit } => write!(
                f,
                "a line of {words} words is longer than a transfer of {limit}; crop it, or capture whole frames"
            ),
            Self::LineAlignment { bytes } => write!(
                f,
                "a line of {bytes} bytes does not fill words, and this part packs lines without a gap; crop to a multiple of 4 bytes"
            ),
            Self::ShortLine { words } => write!(
                f,
                "a line of {words} words fits the FIFO, so after a stall of the bus several end at once and may be numbered wrong; capture whole frames"
            ),
            Self::FrameAlignment { bytes } => write!(
                f,
                "the last {} of a frame's {bytes} bytes don't fill a word and don't reach memory; crop to a multiple of 4 bytes",
                bytes % 4
            ),
            Self::RestartEachFrame { words, short } => write!(
                f,
                "a frame of {words} words {}, so the DMA is restarted at each frame's end and frames that follow without vertical blanking are missed; \
                 change the number of lines or crop",
                if short { "is hardly longer than the FIFO" } else { "is not filled by equal transfers" }
            ),
            Self::BurstShortened { burst, used, words } => write!(
                f,
                "bursts of {} words don't divide transfers of {words}, so bursts of {} are used; change the number of lines or crop for the longer ones",
                burst.words(),
                used.words()
            ),
            Self::ReservedBits { bits } => {
                write!(f, "reserved bits {bits:#010x} of CR are set; write them as 0")
            }
            Self::ReservedFrameRate => {
                write!(
                    f,
                    "FCRC has its reserved value 3; write 0 for all frames, 1 for a half, 2 for a quarter"
                )
            }
        }
    }
}
