use crate::link::fields::{Reader, Writer};

/// What every HELLO begins with.
const MAGIC: [u8; 4] = *b"CAMI";

/// HELLO: who a device is and what it can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello<'a> {
    /// Oldest protocol version that it speaks.
    pub oldest: u8,
    /// Newest protocol version that it speaks.
    pub newest: u8,
    /// Bytes of the largest body that it takes.
    pub takes: u16,
    /// Bytes of the largest body that it sends.
    pub sends: u16,
    /// Number of streams.
    pub streams: u8,
    /// Commands that it knows: bit *c* for command *c*.
    pub commands: u32,
    /// Encodings that it can send: bit *e* for encoding *e*.
    pub encodings: u16,
    /// Another number after every start.
    pub session: u32,
    /// Name and version of the device, for people.
    pub name: &'a str,
}

impl<'a> Hello<'a> {
    pub(super) const KIND: u8 = 0x01;

    pub(super) fn read(content: &'a [u8]) -> Option<Self> {
        let mut fields = Reader(content);
        if fields.bytes(MAGIC.len())? != MAGIC {
            return None;
        }
        let (oldest, newest) = (fields.u8()?, fields.u8()?);
        let (takes, sends) = (fields.u16()?, fields.u16()?);
        let (streams, _) = (fields.u8()?, fields.u8()?);
        let commands = fields.u32()?;
        let (encodings, _) = (fields.u16()?, fields.u16()?);
        let session = fields.u32()?;
        let name = fields.text()?;
        Some(Self { oldest, newest, takes, sends, streams, commands, encodings, session, name })
    }

    /// The oldest and the newest version spoken, which stand in the same place in every version.
    pub(super) fn versions(content: &[u8]) -> Option<(u8, u8)> {
        let mut fields = Reader(content);
        (fields.bytes(MAGIC.len())? == MAGIC).then_some((fields.u8()?, fields.u8()?))
    }

    pub(super) fn write(&self, room: &mut [u8]) -> Option<usize> {
        let mut fields = Writer::new(room);
        fields.bytes(&MAGIC).u8(self.oldest).u8(self.newest).u16(self.takes).u16(self.sends);
        fields.u8(self.streams).u8(0).u32(self.commands).u16(self.encodings).u16(0).u32(self.session);
        fields.bytes(self.name.as_bytes()).finish()
    }
}
