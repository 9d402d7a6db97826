use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::yuv422::{Matrix, Range};

use crate::driver::deadline::Cause;
use crate::driver::verdict::{Outcome, Verdict};
use crate::link::fields::{Reader, Writer};
use crate::link::format::Format;

/// What the name of a format leaves open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meaning {
    /// The mosaic of the RAW formats.
    pub bayer: BayerOrder,
    /// Matrix of the YUV formats.
    pub matrix: Matrix,
    /// Range of the YUV formats.
    pub range: Range,
}

impl Default for Meaning {
    /// [`Meaning::DEFAULT`].
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Meaning {
    /// RGGB; BT.601 in limited range.
    pub const DEFAULT: Self = Self { bayer: BayerOrder::Rggb, matrix: Matrix::Bt601, range: Range::Limited };

    pub(super) fn from_code(code: u8) -> Self {
        Self {
            bayer: match code & 3 {
                0 => BayerOrder::Rggb,
                1 => BayerOrder::Bggr,
                2 => BayerOrder::Grbg,
                _ => BayerOrder::Gbrg,
            },
            matrix: if code & 0x10 == 0 { Matrix::Bt601 } else { Matrix::Bt709 },
            range: if code & 0x20 == 0 { Range::Limited } else { Range::Full },
        }
    }

    pub(super) fn code(self) -> u8 {
        let bayer = match self.bayer {
            BayerOrder::Rggb => 0,
            BayerOrder::Bggr => 1,
            BayerOrder::Grbg => 2,
            BayerOrder::Gbrg => 3,
        };
        bayer | u8::from(self.matrix == Matrix::Bt709) << 4 | u8::from(self.range == Range::Full) << 5
    }
}

/// FRAME: a frame begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameStart {
    /// The stream.
    pub stream: u8,
    /// Its pixel format.
    pub format: Format,
    /// What the format leaves open.
    pub meaning: Meaning,
    /// Taken by a snapshot.
    pub snapshot: bool,
    /// Number of the captured frame on the camera's wires.
    pub sequence: u32,
    /// Width in pixels.
    pub width: u16,
    /// Height in lines.
    pub height: u16,
    /// When it was captured: microseconds since the device started.
    pub captured: u64,
    /// CRC-32 of the palette's bytes; 0 without one.
    pub palette: u32,
}

impl FrameStart {
    pub(super) const KIND: u8 = 0x04;

    pub(super) fn read(content: &[u8]) -> Option<Self> {
        let mut fields = Reader(content);
        Some(Self {
            stream: fields.u8()?,
            format: Format::from_code(fields.u8()?)?,
            meaning: Meaning::from_code(fields.u8()?),
            snapshot: fields.u8()? & 1 != 0,
            sequence: fields.u32()?,
            width: fields.u16()?,
            height: fields.u16()?,
            captured: fields.u64()?,
            palette: fields.u32()?,
        })
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        let mut fields = Writer::new(room);
        fields.u8(self.stream).u8(self.format.code()).u8(self.meaning.code()).u8(self.snapshot.into());
        fields
            .u32(self.sequence)
            .u16(self.width)
            .u16(self.height)
            .u64(self.captured)
            .u32(self.palette)
            .finish()
    }
}

/// END: a frame is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct End {
    /// The stream.
    pub stream: u8,
    /// Its pixel format.
    pub format: Format,
    /// What came of the capture: see [`outcome_code`].
    pub verdict: u8,
    /// Number of the captured frame.
    pub sequence: u32,
    /// Width of the picture sent, in pixels.
    pub width: u16,
    /// Height of the picture sent, in lines.
    pub height: u16,
    /// Lines captured.
    pub lines: u32,
    /// Bytes captured.
    pub bytes: u32,
    /// Bytes of the shortest line captured.
    pub min_line_bytes: u32,
    /// Bytes of the longest line captured.
    pub max_line_bytes: u32,
    /// The number that goes with the verdict.
    pub detail: u32,
    /// Overruns since the frame handed out before.
    pub overruns: u32,
    /// Frames dropped since then.
    pub dropped: u32,
    /// Bytes sent, before encoding.
    pub bytes_sent: u32,
    /// CRC-32 over the bytes sent, before encoding, line after line.
    pub crc: u32,
    /// Lines sent, each counted once.
    pub lines_sent: u16,
}

impl End {
    pub(super) const KIND: u8 = 0x06;

    pub(super) fn read(content: &[u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let (stream, format) = (fields.u8()?, Format::from_code(fields.u8()?)?);
        let (verdict, _) = (fields.u8()?, fields.u8()?);
        let end = Self {
            stream,
            format,
            verdict,
            sequence: fields.u32()?,
            width: fields.u16()?,
            height: fields.u16()?,
            lines: fields.u32()?,
            bytes: fields.u32()?,
            min_line_bytes: fields.u32()?,
            max_line_bytes: fields.u32()?,
            detail: fields.u32()?,
            overruns: fields.u32()?,
            dropped: fields.u32()?,
            bytes_sent: fields.u32()?,
            crc: fields.u32()?,
            lines_sent: fields.u16()?,
        };
        fields.u16()?;
        Some(end)
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        let mut fields = Writer::new(room);
        fields.u8(self.stream).u8(self.format.code()).u8(self.verdict).u8(0);
        fields.u32(self.sequence).u16(self.width).u16(self.height).u32(self.lines).u32(self.bytes);
        fields.u32(self.min_line_bytes).u32(self.max_line_bytes).u32(self.detail).u32(self.overruns);
        fields.u32(self.dropped).u32(self.bytes_sent).u32(self.crc).u16(self.lines_sent).u16(0).finish()
    }

    /// With the capture's part filled in.
    #[must_use]
    pub fn judged(self, verdict: &Verdict) -> Self {
        let (code, detail) = outcome_code(verdict.outcome);
        Self {
            verdict: code,
            detail,
            lines: verdict.lines,
            bytes: verdict.bytes,
            min_line_bytes: verdict.min_line_bytes,
            max_line_bytes: verdict.max_line_bytes,
            overruns: verdict.overruns,
            dropped: verdict.dropped_before,
            ..self
        }
    }

    /// What came of the capture; `None` for a code that is not known.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        Some(match self.verdict {
            0 => Outcome::Good,
            1 => Outcome::Short { expected: self.detail },
            2 => Outcome::Long { expected: self.detail },
            3 => Outcome::LineCount { expected: self.detail },
            4 => Outcome::LineLength { expected: self.detail },
            5 => Outcome::LinesDropped { lines: self.detail },
            6 => Outcome::Overrun,
            7 => Outcome::SyncError,
            8 => Outcome::DmaError,
            9 => Outcome::DmaStalled,
            10 => Outcome::LateInterrupt,
            _ => return None,
        })
    }
}

/// The verdict of a device that does not know what came of a capture.
pub const VERDICT_UNKNOWN: u8 = 255;

/// An outcome on the wire: its code, and the number that goes with it.
#[must_use]
pub const fn outcome_code(outcome: Outcome) -> (u8, u32) {
    match outcome {
        Outcome::Good => (0, 0),
        Outcome::Short { expected } => (1, expected),
        Outcome::Long { expected } => (2, expected),
        Outcome::LineCount { expected } => (3, expected),
        Outcome::LineLength { expected } => (4, expected),
        Outcome::LinesDropped { lines } => (5, lines),
        Outcome::Overrun => (6, 0),
        Outcome::SyncError => (7, 0),
        Outcome::DmaError => (8, 0),
        Outcome::DmaStalled => (9, 0),
        Outcome::LateInterrupt => (10, 0),
    }
}

/// The cause of a time-out on the wire; 0 is none.
#[must_use]
pub const fn cause_code(cause: Option<Cause>) -> u8 {
    match cause {
        None => 0,
        Some(Cause::NoClock) => 1,
        Some(Cause::NoVsync) => 2,
        Some(Cause::NoData) => 3,
        Some(Cause::ShortFrame { .. }) => 4,
        Some(Cause::DmaStalled) => 5,
        Some(Cause::Overrun { .. }) => 6,
        Some(Cause::Damaged(_)) => 7,
        Some(Cause::Unfinished { .. }) => 8,
        Some(Cause::NoBuffer) => 9,
        Some(Cause::Stopped) => 10,
        Some(Cause::Refused) => 11,
    }
}
