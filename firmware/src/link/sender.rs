//! Packets into a writer.

use super::crc::Checksum;
use super::format::Choice;
use super::framing::{Framer, TooLong};
use super::outgoing::{Outgoing, Piece};
use super::packet::{End, FrameStart, Packet};

/// Why a packet did not leave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SendError<E> {
    /// It does not fit the memory that was lent.
    TooLong,
    /// The writer's own error.
    Write(E),
}

impl<E> From<TooLong> for SendError<E> {
    fn from(TooLong: TooLong) -> Self {
        Self::TooLong
    }
}

impl<E: core::fmt::Display> core::fmt::Display for SendError<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooLong => TooLong.fmt(f),
            Self::Write(error) => error.fmt(f),
        }
    }
}

impl<E: core::fmt::Debug + core::fmt::Display> core::error::Error for SendError<E> {}

/// Sends packets and frames, in memory for one packet.
///
/// With a writer of `embedded_io` the methods are `send`, `begin`, `line`, `bits_line`, `resend` and `end`; with one of
/// `embedded_io_async` their namesakes that end in `_async`.
#[derive(Debug)]
pub struct Sender<'m, W> {
    writer: W,
    packer: Packer<'m>,
    checksum: Checksum,
}

impl<'m, W> Sender<'m, W> {
    /// Sends into `writer`; `memory` is of [`wire_bytes`](super::wire_bytes) of the largest body that is to leave.
    pub fn new(writer: W, memory: &'m mut [u8], checksum: Checksum) -> Self {
        Self {
            writer,
            packer: Packer { framer: Framer::new(memory, checksum), packets: 0, bytes: 0 },
            checksum,
        }
    }

    /// Packets sent; wraps.
    #[must_use]
    pub fn packets(&self) -> u32 {
        self.packer.packets
    }

    /// Bytes put on the wire; wraps.
    #[must_use]
    pub fn bytes(&self) -> u32 {
        self.packer.bytes
    }

    /// Bytes of the largest body that it can send.
    #[must_use]
    pub fn body_max(&self) -> usize {
        self.packer.framer.body_max()
    }

    /// The writer.
    pub fn writer_mut(&mut self) -> &mut W {
        &mut self.writer
    }

    /// Each piece of a line in turn: where it is, and its bytes.
    fn pieces<'p>(
        &self,
        piece: Piece,
        pixels: &'p [u8],
    ) -> impl Iterator<Item = (Piece, &'p [u8])> + use<'p, W> {
        let size = piece.bytes_max(&self.packer.framer).max(1);
        pixels.chunks(size).enumerate().map(move |(at, chunk)| (piece.after(at * size), chunk))
    }
}

/// What both ways of writing share: packets made in the memory, and counted.
#[derive(Debug)]
struct Packer<'m> {
    framer: Framer<'m>,
    packets: u32,
    bytes: u32,
}

impl Packer<'_> {
    fn packet(&mut self, packet: &Packet<'_>) -> Result<&[u8], TooLong> {
        let wire = packet.frame(&mut self.framer)?;
        Ok(counted(wire, &mut self.packets, &mut self.bytes))
    }

    fn piece(&mut self, piece: Piece, pixels: &[u8]) -> Result<&[u8], TooLong> {
        let wire = piece.frame(&mut self.framer, pixels)?;
        Ok(counted(wire, &mut self.packets, &mut self.bytes))
    }

    fn bits(&mut self, piece: Piece, packed: &[u8], pixels: usize) -> Result<&[u8], TooLong> {
        let wire = piece.frame_bits(&mut self.framer, packed, pixels)?;
        Ok(counted(wire, &mut self.packets, &mut self.bytes))
    }
}

/// Counts what is about to go over the wire.
fn counted<'w>(wire: &'w [u8], packets: &mut u32, bytes: &mut u32) -> &'w [u8] {
    *packets = packets.wrapping_add(1);
    *bytes = bytes.wrapping_add(wire.len() as u32);
    wire
}

impl<W: embedded_io::Write> Sender<'_, W> {
    /// Sends a packet.
    ///
    /// # Errors
    /// [`SendError`]; nothing was sent if it is [`SendError::TooLong`].
    pub fn send(&mut self, packet: &Packet<'_>) -> Result<(), SendError<W::Error>> {
        let wire = self.packer.packet(packet)?;
        self.writer.write_all(wire).map_err(SendError::Write)
    }

    /// Begins a frame.
    ///
    /// # Errors
    /// As [`Sender::send`].
    pub fn begin(&mut self, start: FrameStart, choice: Choice) -> Result<Outgoing, SendError<W::Error>> {
        self.send(&Packet::Frame(start))?;
        Ok(Outgoing::new(start, choice, self.checksum))
    }

    /// Sends a line, cut into pieces where it does not fit a packet.
    ///
    /// # Errors
    /// As [`Sender::send`].
    pub fn line(
        &mut self,
        frame: &mut Outgoing,
        number: u16,
        pixels: &[u8],
    ) -> Result<(), SendError<W::Error>> {
        frame.count(pixels);
        self.put_line(frame.piece(number, false), pixels)
    }

    /// Sends a line once more because it was asked for.
    ///
    /// # Errors
    /// As [`Sender::send`].
    pub fn resend(
        &mut self,
        frame: &Outgoing,
        number: u16,
        pixels: &[u8],
    ) -> Result<(), SendError<W::Error>> {
        self.put_line(frame.piece(number, true), pixels)
    }

    fn put_line(&mut self, piece: Piece, pixels: &[u8]) -> Result<(), SendError<W::Error>> {
        for (piece, pixels) in self.pieces(piece, pixels) {
            let wire = self.packer.piece(piece, pixels)?;
            self.writer.write_all(wire).map_err(SendError::Write)?;
        }
        Ok(())
    }

    /// Sends a line of a map of `pixels` bits, packed as [`Encoding::Bits`](super::Encoding::Bits) has it.
    ///
    /// # Errors
    /// As [`Sender::send`].
    pub fn bits_line(
        &mut self,
        frame: &mut Outgoing,
        number: u16,
        packed: &[u8],
        pixels: usize,
    ) -> Result<(), SendError<W::Error>> {
        frame.count_bits(packed, pixels);
        let wire = self.packer.bits(frame.piece(number, false), packed, pixels)?;
        self.writer.write_all(wire).map_err(SendError::Write)
    }

    /// Ends a frame; [`Outgoing::end`] and [`End::judged`] say with what.
    ///
    /// # Errors
    /// As [`Sender::send`].
    pub fn end(&mut self, end: End) -> Result<(), SendError<W::Error>> {
        self.send(&Packet::End(end))
    }
}

impl<W: embedded_io_async::Write> Sender<'_, W> {
    /// Sends a packet.
    ///
    /// # Errors
    /// [`SendError`]; nothing was sent if it is [`SendError::TooLong`].
    pub async fn send_async(&mut self, packet: &Packet<'_>) -> Result<(), SendError<W::Error>> {
        let wire = self.packer.packet(packet)?;
        self.writer.write_all(wire).await.map_err(SendError::Write)
    }

    /// Begins a frame.
    ///
    /// # Errors
    /// As [`Sender::send_async`].
    pub async fn begin_async(
        &mut self,
        start: FrameStart,
        choice: Choice,
    ) -> Result<Outgoing, SendError<W::Error>> {
        self.send_async(&Packet::Frame(start)).await?;
        Ok(Outgoing::new(start, choice, self.checksum))
    }

    /// Sends a line, cut into pieces where it does not fit a packet.
    ///
    /// # Errors
    /// As [`Sender::send_async`].
    pub async fn line_async(
        &mut self,
        frame: &mut Outgoing,
        number: u16,
        pixels: &[u8],
    ) -> Result<(), SendError<W::Error>> {
        frame.count(pixels);
        self.put_line_async(frame.piece(number, false), pixels).await
    }

    /// Sends a line once more because it was asked for.
    ///
    /// # Errors
    /// As [`Sender::send_async`].
    pub async fn resend_async(
        &mut self,
        frame: &Outgoing,
        number: u16,
        pixels: &[u8],
    ) -> Result<(), SendError<W::Error>> {
        self.put_line_async(frame.piece(number, true), pixels).await
    }

    async fn put_line_async(&mut self, piece: Piece, pixels: &[u8]) -> Result<(), SendError<W::Error>> {
        for (piece, pixels) in self.pieces(piece, pixels) {
            let wire = self.packer.piece(piece, pixels)?;
            self.writer.write_all(wire).await.map_err(SendError::Write)?;
        }
        Ok(())
    }

    /// Sends a line of a map of `pixels` bits, packed as [`Encoding::Bits`](super::Encoding::Bits) has it.
    ///
    /// # Errors
    /// As [`Sender::send_async`].
    pub async fn bits_line_async(
        &mut self,
        frame: &mut Outgoing,
        number: u16,
        packed: &[u8],
        pixels: usize,
    ) -> Result<(), SendError<W::Error>> {
        frame.count_bits(packed, pixels);
        let wire = self.packer.bits(frame.piece(number, false), packed, pixels)?;
        self.writer.write_all(wire).await.map_err(SendError::Write)
    }

    /// Ends a frame; [`Outgoing::end`] and [`End::judged`] say with what.
    ///
    /// # Errors
    /// As [`Sender::send_async`].
    pub async fn end_async(&mut self, end: End) -> Result<(), SendError<W::Error>> {
        self.send_async(&Packet::End(end)).await
    }
}
