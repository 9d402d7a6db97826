use super::frame::Meaning;
use crate::link::fields::{Reader, Writer};
use crate::link::format::{Choice, Format};

/// STREAM: what a stream carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream<'a> {
    /// The stream.
    pub stream: u8,
    /// Its pixel format.
    pub format: Format,
    /// The encoding asked for.
    pub encoding: Choice,
    /// It is on.
    pub on: bool,
    /// Width in pixels.
    pub width: u16,
    /// Height in lines.
    pub height: u16,
    /// What the format leaves open.
    pub meaning: Meaning,
    /// The pipeline that makes it of the raw frame, at most 255 bytes.
    pub pipeline: &'a str,
    /// Its name.
    pub name: &'a str,
}

impl<'a> Stream<'a> {
    pub(super) const KIND: u8 = 0x02;

    pub(super) fn read(content: &'a [u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let stream = fields.u8()?;
        let format = Format::from_code(fields.u8()?)?;
        let encoding = Choice::from_code(fields.u8()?)?;
        let on = fields.u8()? & 1 != 0;
        let (width, height) = (fields.u16()?, fields.u16()?);
        let meaning = Meaning::from_code(fields.u8()?);
        let length = fields.u8()?;
        fields.u16()?;
        let pipeline = Reader(fields.bytes(length.into())?).text()?;
        let name = fields.text()?;
        Some(Self { stream, format, encoding, on, width, height, meaning, pipeline, name })
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        let length = u8::try_from(self.pipeline.len()).ok()?;
        let mut fields = Writer::new(room);
        fields.u8(self.stream).u8(self.format.code()).u8(self.encoding.code()).u8(self.on.into());
        fields.u16(self.width).u16(self.height).u8(self.meaning.code()).u8(length).u16(0);
        fields.bytes(self.pipeline.as_bytes()).bytes(self.name.as_bytes()).finish()
    }
}

/// PALETTE: the colours of a stream of [`Format::Index8`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette<'a> {
    /// The stream.
    pub stream: u8,
    /// Red, green and blue of 1 to 256 colours.
    pub colors: &'a [[u8; 3]],
}

impl<'a> Palette<'a> {
    pub(super) const KIND: u8 = 0x03;

    pub(super) fn read(content: &'a [u8]) -> Option<Self> {
        let mut fields = Reader(content);
        let (stream, _, count) = (fields.u8()?, fields.u8()?, usize::from(fields.u16()?));
        let (colors, rest) = fields.0.as_chunks::<3>();
        ((1..=256).contains(&count) && colors.len() == count && rest.is_empty())
            .then_some(Self { stream, colors })
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        if !(1..=256).contains(&self.colors.len()) {
            return None;
        }
        let mut fields = Writer::new(room);
        fields.u8(self.stream).u8(0).u16(self.colors.len() as u16);
        fields.bytes(self.colors.as_flattened()).finish()
    }
}
