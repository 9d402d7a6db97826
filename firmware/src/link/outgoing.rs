//! A frame on its way out.

use super::coding;
use super::crc::Checksum;
use super::format::{Choice, Encoding, Format};
use super::framing::{Framer, TooLong};
use super::packet::{End, FrameStart, Line, VERDICT_UNKNOWN};

/// Bytes of a LINE's content before its payload.
const PLACE: usize = 10;

/// Counts what was sent of a frame, and says what its END holds.
#[derive(Clone, Copy, Debug)]
pub struct Outgoing {
    start: FrameStart,
    choice: Choice,
    checksum: Checksum,
    crc: u32,
    bytes: u32,
    lines: u16,
}

impl Outgoing {
    /// Nothing sent yet.
    #[must_use]
    pub fn new(start: FrameStart, choice: Choice, checksum: Checksum) -> Self {
        Self { start, choice, checksum, crc: 0, bytes: 0, lines: 0 }
    }

    /// What the frame began with.
    #[must_use]
    pub fn start(&self) -> &FrameStart {
        &self.start
    }

    /// Takes note of a line that is sent for the first time.
    pub(super) fn count(&mut self, pixels: &[u8]) {
        self.add(pixels);
        self.lines = self.lines.wrapping_add(1);
    }

    fn add(&mut self, pixels: &[u8]) {
        self.crc = (self.checksum)(self.crc, pixels);
        self.bytes = self.bytes.wrapping_add(pixels.len() as u32);
    }

    /// The same for a line of a map, packed as [`Encoding::Bits`].
    pub(super) fn count_bits(&mut self, packed: &[u8], pixels: usize) {
        let mut left = pixels;
        for byte in packed {
            let eight: [u8; 8] = core::array::from_fn(|bit| (byte >> bit & 1).wrapping_neg());
            self.add(eight.get(..left.min(8)).unwrap_or(&eight));
            left = left.saturating_sub(8);
        }
        self.lines = self.lines.wrapping_add(1);
    }

    /// The END so far, with a capture that is not judged; see [`End::judged`].
    #[must_use]
    pub fn end(&self) -> End {
        let start = &self.start;
        End {
            stream: start.stream,
            format: start.format,
            verdict: VERDICT_UNKNOWN,
            sequence: start.sequence,
            width: start.width,
            height: start.height,
            lines: 0,
            bytes: 0,
            min_line_bytes: 0,
            max_line_bytes: 0,
            detail: 0,
            overruns: 0,
            dropped: 0,
            bytes_sent: self.bytes,
            crc: self.crc,
            lines_sent: self.lines,
        }
    }

    /// The place of a line of this frame.
    #[must_use]
    pub fn piece(&self, line: u16, again: bool) -> Piece {
        let FrameStart { stream, format, sequence, .. } = self.start;
        Piece { stream, format, choice: self.choice, again, sequence: sequence as u16, line, first: 0 }
    }
}

/// A piece of a line that is to be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The stream.
    pub stream: u8,
    /// Its pixel format.
    pub format: Format,
    /// Which encoding is asked for.
    pub choice: Choice,
    /// Sent again because it was asked for.
    pub again: bool,
    /// Low 16 bits of the frame's sequence.
    pub sequence: u16,
    /// Number of the line.
    pub line: u16,
    /// First pixel.
    pub first: u16,
}

impl Piece {
    /// Bytes of a line of this format that a packet of the framer takes: whole units.
    #[must_use]
    pub fn bytes_max(&self, framer: &Framer<'_>) -> usize {
        let room = framer.body_max().saturating_sub(Line::AROUND);
        room - room % self.format.unit_bytes()
    }

    /// The piece that begins `bytes` further right.
    pub(super) fn after(self, bytes: usize) -> Self {
        let pixels = bytes / self.format.bytes_per_pixel();
        Self { first: self.first.saturating_add(pixels as u16), ..self }
    }

    /// The packet on the wire, encoded straight into the framer's memory; raw where that is not longer.
    ///
    /// # Errors
    /// [`TooLong`] if there are more pixels than [`Piece::bytes_max`].
    pub fn frame<'f>(&self, framer: &'f mut Framer<'_>, pixels: &[u8]) -> Result<&'f [u8], TooLong> {
        self.put(
            framer,
            |room| {
                let shorter = room.get_mut(..pixels.len().saturating_sub(1));
                if let Some(coded) =
                    shorter.and_then(|room| coding::encode(self.format, self.choice, pixels, room))
                {
                    return Some(coded);
                }
                room.get_mut(..pixels.len())?.copy_from_slice(pixels);
                Some((Encoding::Raw, pixels.len()))
            },
            pixels.len(),
        )
    }

    /// The same for pixels that are packed already, as [`Encoding::Bits`].
    ///
    /// # Errors
    /// [`TooLong`] if the bits do not fit.
    pub fn frame_bits<'f>(
        &self,
        framer: &'f mut Framer<'_>,
        packed: &[u8],
        pixels: usize,
    ) -> Result<&'f [u8], TooLong> {
        let packed = packed.get(..pixels.div_ceil(8)).unwrap_or(packed);
        self.put(
            framer,
            |room| {
                room.get_mut(..packed.len())?.copy_from_slice(packed);
                Some((Encoding::Bits, packed.len()))
            },
            pixels,
        )
    }

    fn put<'f>(
        &self,
        framer: &'f mut Framer<'_>,
        fill: impl FnOnce(&mut [u8]) -> Option<(Encoding, usize)>,
        pixels: usize,
    ) -> Result<&'f [u8], TooLong> {
        framer.frame(Line::KIND, false, |room| {
            let (head, payload) = room.split_first_chunk_mut::<PLACE>()?;
            let (encoding, length) = fill(payload)?;
            let unused = if encoding == Encoding::Bits { coding::unused_bits(pixels) } else { 0 };
            let Self { stream, format, again, sequence, line, first, .. } = *self;
            let payload: &[u8] = &[];
            Line { stream, format, encoding, unused, again, sequence, line, first, payload }.write(head)?;
            Some(PLACE + length)
        })
    }
}
