use crate::link::coding;
use crate::link::fields::{Reader, Writer};
use crate::link::format::{Encoding, Format};

/// LINE: a line, or a piece of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<'a> {
    /// The stream.
    pub stream: u8,
    /// Its pixel format.
    pub format: Format,
    /// How the payload is coded.
    pub encoding: Encoding,
    /// Bits of the last byte that are no pixels ([`Encoding::Bits`] only).
    pub unused: u8,
    /// Sent again because it was asked for.
    pub again: bool,
    /// Low 16 bits of the frame's sequence.
    pub sequence: u16,
    /// Number of the line from 0 at the top.
    pub line: u16,
    /// First pixel from 0 at the left.
    pub first: u16,
    /// The pixels, coded.
    pub payload: &'a [u8],
}

impl<'a> Line<'a> {
    pub(in crate::link) const KIND: u8 = 0x05;
    /// Bytes of a body around the payload.
    pub const AROUND: usize = 18;

    pub(super) fn read(content: &'a [u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let (stream, format, coding) = (fields.u8()?, Format::from_code(fields.u8()?)?, fields.u8()?);
        let encoding = Encoding::from_code(coding & 0x0F)?;
        let unused = if encoding == Encoding::Bits { coding >> 4 & 7 } else { 0 };
        let again = fields.u8()? & 1 != 0;
        let (sequence, line, first) = (fields.u16()?, fields.u16()?, fields.u16()?);
        let payload = fields.0;
        (unused == 0 || !payload.is_empty()).then_some(Self {
            stream,
            format,
            encoding,
            unused,
            again,
            sequence,
            line,
            first,
            payload,
        })
    }

    pub(in crate::link) fn write(&self, room: &mut [u8]) -> Option<usize> {
        let mut fields = Writer::new(room);
        let coding = self.encoding.code() | self.unused << 4;
        fields.u8(self.stream).u8(self.format.code()).u8(coding).u8(self.again.into());
        fields.u16(self.sequence).u16(self.line).u16(self.first).bytes(self.payload).finish()
    }

    /// Writes the pixels' bytes to `pixels`, and says how many there are.
    ///
    /// `None` if the payload is malformed or has more pixels than there is room for.
    #[must_use]
    pub fn decode(&self, pixels: &mut [u8]) -> Option<usize> {
        coding::decode(self.format, self.encoding, self.unused, self.payload, pixels)
    }
}
