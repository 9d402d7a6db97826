//! Lines into frames: each pixel in its place, and a mark for each line that is missing.

use core::cmp::Ordering;

use super::crc::Checksum;
use super::format::Format;
use super::packet::{End, FrameStart, Line, Packet};

/// Bytes of a picture.
#[must_use]
pub const fn picture_bytes(format: Format, width: usize, height: usize) -> usize {
    format.line_bytes(width) * height
}

/// Words of marks, one bit a line.
#[must_use]
pub const fn marks_words(height: usize) -> usize {
    height.div_ceil(32)
}

/// A frame as far as it came.
#[derive(Clone, Copy, Debug)]
pub struct Assembled<'a> {
    /// Number of the captured frame; only the low 16 bits if nothing but lines came of the first frame.
    pub sequence: u32,
    /// Pixel format.
    pub format: Format,
    /// Width in pixels.
    pub width: u16,
    /// Height in lines.
    pub height: u16,
    /// Line after line, in the format; missing lines are zero.
    pub picture: &'a [u8],
    /// Its FRAME, if that came.
    pub start: Option<FrameStart>,
    /// Its END, if that came.
    pub end: Option<End>,
    /// The frame CRC is right, or wrong; `None` if lines that were sent are missing, or END is.
    pub crc: Option<bool>,
    /// It was handed out before, with lines missing that have come since.
    pub repaired: bool,
    marks: &'a [u32],
}

impl Assembled<'_> {
    /// This line has not come.
    #[must_use]
    pub fn is_missing(&self, line: u16) -> bool {
        !is_marked(self.marks, line)
    }

    /// Lines that have not come, top to bottom.
    pub fn missing(&self) -> impl Iterator<Item = u16> {
        (0..self.height).filter(|&line| self.is_missing(line))
    }
}

fn is_marked(marks: &[u32], line: u16) -> bool {
    marks.get(usize::from(line / 32)).is_some_and(|word| word >> (line % 32) & 1 != 0)
}

/// What a picture looks like in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Geometry {
    format: Format,
    width: u16,
    height: u16,
}

impl Geometry {
    fn line_bytes(self) -> usize {
        self.format.line_bytes(self.width.into())
    }

    fn bytes(self) -> usize {
        picture_bytes(self.format, self.width.into(), self.height.into())
    }
}

/// The frame that is being put together, or was last.
#[derive(Clone, Copy, Debug)]
struct Current {
    sequence: u32,
    geometry: Geometry,
    start: Option<FrameStart>,
    end: Option<End>,
    /// It was handed out.
    ended: bool,
    /// There is memory for it.
    fits: bool,
    /// Lines that have come.
    lines: u16,
    /// The line that is coming in pieces, and its next pixel.
    piece: (u16, u16),
}

/// What did not become part of a picture; wraps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Lines outside the picture, of another format, or malformed.
    pub unfit: u32,
    /// Lines that were there already.
    pub doubled: u32,
    /// Lines of frames that are no longer kept.
    pub late: u32,
    /// Lines before the size of the picture was known.
    pub unplaced: u32,
    /// Frames for which there is not enough memory.
    pub too_large: u32,
}

/// Puts the frames of one stream together, in memory for one.
#[derive(Debug)]
pub struct Assembler<'m> {
    stream: u8,
    picture: &'m mut [u8],
    marks: &'m mut [u32],
    checksum: Checksum,
    session: Option<u32>,
    known: Option<Geometry>,
    current: Option<Current>,
    dropped: Dropped,
}

impl<'m> Assembler<'m> {
    /// Of this stream, in memory of [`picture_bytes`] and [`marks_words`].
    pub fn new(stream: u8, picture: &'m mut [u8], marks: &'m mut [u32], checksum: Checksum) -> Self {
        let dropped = Dropped::default();
        Self { stream, picture, marks, checksum, session: None, known: None, current: None, dropped }
    }

    /// What did not become part of a picture.
    #[must_use]
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Takes a packet; those of other streams too. `on_frame` gets each frame when it ends, and once more when lines that
    /// were asked for again have made it whole.
    pub fn push(&mut self, packet: &Packet<'_>, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        match packet {
            Packet::Hello(hello) if self.session != Some(hello.session) => {
                self.restart(hello.session, on_frame);
            }
            Packet::Heartbeat(beat) if self.session.is_some_and(|session| session != beat.session) => {
                self.restart(beat.session, on_frame);
            }
            Packet::Heartbeat(beat) => self.session = Some(beat.session),
            Packet::Stream(s) if s.stream == self.stream => {
                self.known = Some(Geometry { format: s.format, width: s.width, height: s.height });
            }
            Packet::Frame(start) if start.stream == self.stream => self.start(start, on_frame),
            Packet::Line(line) if line.stream == self.stream => self.line(line, on_frame),
            Packet::End(end) if end.stream == self.stream => self.end(end, on_frame),
            _ => {}
        }
    }

    /// Ends the open frame, as at the end of a recording.
    pub fn finish(&mut self, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        if self.current.is_some_and(|current| !current.ended) {
            self.hand_out(None, on_frame);
        }
    }

    fn restart(&mut self, session: u32, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        self.finish(on_frame);
        self.current = None;
        self.session = Some(session);
    }

    /// How a frame stands to the current one: `Greater` is newer, and so is every one if there is none.
    fn age(&self, sequence: u16) -> Ordering {
        self.current.map_or(Ordering::Greater, |current| {
            (sequence.wrapping_sub(current.sequence as u16) as i16).cmp(&0)
        })
    }

    fn begin(&mut self, sequence: u32, geometry: Geometry, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        self.finish(on_frame);
        let words = marks_words(geometry.height.into());
        let fits = geometry.bytes() <= self.picture.len() && words <= self.marks.len();
        if !fits {
            self.dropped.too_large = self.dropped.too_large.wrapping_add(1);
        }
        self.marks.fill(0);
        self.known = Some(geometry);
        let (start, end, ended, lines, piece) = (None, None, false, 0, (0, 0));
        self.current = Some(Current { sequence, geometry, start, end, ended, fits, lines, piece });
    }

    fn start(&mut self, start: &FrameStart, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        let geometry = Geometry { format: start.format, width: start.width, height: start.height };
        match self.age(start.sequence as u16) {
            Ordering::Greater => self.begin(start.sequence, geometry, on_frame),
            Ordering::Equal => {}
            Ordering::Less => return,
        }
        if let Some(current) = &mut self.current
            && current.geometry == geometry
            && !current.ended
        {
            current.start = Some(*start);
            current.sequence = start.sequence;
        }
    }

    fn line(&mut self, line: &Line<'_>, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        match self.age(line.sequence) {
            Ordering::Greater => {
                let Some(geometry) = self.known else {
                    self.dropped.unplaced = self.dropped.unplaced.wrapping_add(1);
                    return;
                };
                let sequence = self.current.map_or(line.sequence.into(), |current| {
                    let ahead = line.sequence.wrapping_sub(current.sequence as u16);
                    current.sequence.wrapping_add(ahead.into())
                });
                self.begin(sequence, geometry, on_frame);
            }
            Ordering::Equal => {}
            Ordering::Less => {
                self.dropped.late = self.dropped.late.wrapping_add(1);
                return;
            }
        }
        if is_marked(self.marks, line.line) {
            self.dropped.doubled = self.dropped.doubled.wrapping_add(1);
            return;
        }
        let whole = self.place(line);
        let Some(current) = &mut self.current else { return };
        match whole {
            None => self.dropped.unfit = self.dropped.unfit.wrapping_add(1),
            Some(false) => {}
            Some(true) => {
                current.lines += 1;
                if current.ended && current.lines == current.geometry.height {
                    self.hand_out(None, on_frame);
                }
            }
        }
    }

    /// Puts a piece in its place: true if its line is whole now, `None` if it does not fit.
    fn place(&mut self, line: &Line<'_>) -> Option<bool> {
        let current = self.current.as_mut()?;
        let Geometry { format, width, height } = current.geometry;
        let first = usize::from(line.first);
        let fits = current.fits && line.format == format && line.line < height && line.first < width;
        if !fits || !first.is_multiple_of(format.unit_pixels()) {
            return None;
        }
        if line.first != 0 && current.piece != (line.line, line.first) {
            return Some(false);
        }
        let line_bytes = current.geometry.line_bytes();
        let row = self.picture.get_mut(usize::from(line.line) * line_bytes..)?.get_mut(..line_bytes)?;
        let count = line.decode(row.get_mut(format.line_bytes(first)..)?)? / format.bytes_per_pixel();
        let next = line.first.saturating_add(count as u16);
        current.piece = (line.line, next);
        if next == width {
            *self.marks.get_mut(usize::from(line.line / 32))? |= 1 << (line.line % 32);
        }
        Some(next == width)
    }

    fn end(&mut self, end: &End, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        let geometry = Geometry { format: end.format, width: end.width, height: end.height };
        match self.age(end.sequence as u16) {
            Ordering::Greater => self.begin(end.sequence, geometry, on_frame),
            Ordering::Equal => {}
            Ordering::Less => return,
        }
        let Some(current) = self.current else { return };
        if current.ended {
            return;
        }
        if current.geometry != geometry {
            // What was placed by another size is not where it belongs.
            self.current = None;
            self.begin(end.sequence, geometry, on_frame);
        }
        self.hand_out(Some(end), on_frame);
    }

    fn hand_out(&mut self, end: Option<&End>, on_frame: &mut dyn FnMut(Assembled<'_>)) {
        let Some(current) = &mut self.current else { return };
        let repaired = core::mem::replace(&mut current.ended, true);
        if let Some(end) = end {
            current.end = Some(*end);
            current.sequence = end.sequence;
        }
        let Geometry { format, width, height } = current.geometry;
        let Some(picture) = self.picture.get_mut(..current.geometry.bytes()) else { return };
        if !current.fits {
            return;
        }
        let size = current.geometry.line_bytes().max(1);
        if current.lines < height {
            for (line, row) in picture.chunks_mut(size).enumerate() {
                if !is_marked(self.marks, line as u16) {
                    row.fill(0);
                }
            }
        }
        let crc = current.end.filter(|end| end.lines_sent == current.lines).map(|end| {
            let present = picture.chunks(size).enumerate();
            let present = present.filter(|&(line, _)| is_marked(self.marks, line as u16));
            present.fold(0, |crc, (_, row)| (self.checksum)(crc, row)) == end.crc
        });
        let Current { sequence, start, end, .. } = *current;
        let marks = self.marks.get(..marks_words(height.into())).unwrap_or_default();
        on_frame(Assembled { sequence, format, width, height, picture, start, end, crc, repaired, marks });
    }
}
