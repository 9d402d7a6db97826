//! What stands where in a `.camt` file. All numbers are little-endian.
//!
//! ```text
//! header  0 "CAMT" │ 4 version │ 5 bus bits │ 6 vsync active level │ 7 zero │ 8 pclk_hz │ 12 CRC-32 of 0..12
//! chunk   0 type │ 1 flags │ 2 payload length │ 4 payload │ CRC-32 of everything before it
//! ```

use super::checksum::Checksum;
use super::error::Problem;

/// First bytes of every file.
pub const MAGIC: [u8; 4] = *b"CAMT";
/// The version that is read and written.
pub const VERSION: u8 = 1;
/// Bytes of the file header.
pub const HEADER_BYTES: usize = 16;
/// Bytes of the largest chunk, with head and checksum.
pub const CHUNK_BYTES: usize = 4096;
/// Bytes before a chunk's payload.
pub const CHUNK_HEAD: usize = 4;
/// Bytes after a chunk's payload.
pub const CHUNK_TAIL: usize = 4;
/// Bytes of the largest payload.
pub const PAYLOAD_BYTES: usize = CHUNK_BYTES - CHUNK_HEAD - CHUNK_TAIL;
/// Bytes of profile text that a file may carry.
pub const PROFILE_BYTES: usize = 65_536;
/// Bytes of one mark in an INDEX chunk: file offset, clock.
pub const MARK_BYTES: usize = 16;
/// Bytes before the marks in an INDEX chunk: offset of the INDEX before it, number of its first mark.
pub const INDEX_HEAD: usize = 16;
/// Payload of END: clocks, marks, offset of the last INDEX.
pub const END_BYTES: usize = 24;
/// Chunk flag: a reader that does not know the type may go on without it.
pub const FLAG_SKIPPABLE: u8 = 1;

/// Chunk types that version 1 knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChunkType {
    /// UTF-8 text of the profile.
    Profile,
    /// Clock number of the first sample, then records.
    Data,
    /// Where frames begin.
    Index,
    /// Totals; nothing follows.
    End,
}

impl ChunkType {
    /// The byte in the file.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Profile => b'P',
            Self::Data => b'D',
            Self::Index => b'I',
            Self::End => b'E',
        }
    }

    /// The type of that byte, if version 1 knows it.
    #[must_use]
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            b'P' => Self::Profile,
            b'D' => Self::Data,
            b'I' => Self::Index,
            b'E' => Self::End,
            _ => return None,
        })
    }
}

/// What a file says of itself before its first clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Width of the data bus: 8, 10, 12 or 14.
    pub bus_bits: u8,
    /// VSYNC's active (blanking) level: frames are marked where VSYNC goes to it.
    pub vsync_active: bool,
    /// Pixel clock in hertz; 0 if unknown.
    pub pclk_hz: u32,
}

impl Header {
    /// The header as bytes.
    #[must_use]
    pub fn to_bytes<C: Checksum>(&self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[..4].copy_from_slice(&MAGIC);
        bytes[4] = VERSION;
        bytes[5] = self.bus_bits;
        bytes[6] = u8::from(self.vsync_active);
        bytes[8..12].copy_from_slice(&self.pclk_hz.to_le_bytes());
        let crc = C::crc32(&bytes[..12]);
        bytes[12..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }

    /// The header that these bytes are.
    ///
    /// # Errors
    /// [`Problem::Magic`], [`Problem::Version`], [`Problem::Damaged`] or [`Problem::Header`].
    pub fn from_bytes<C: Checksum>(bytes: &[u8; HEADER_BYTES]) -> Result<Self, Problem> {
        if bytes[..4] != MAGIC {
            return Err(Problem::Magic);
        }
        if C::crc32(&bytes[..12]) != u32_at(bytes, 12) {
            return Err(Problem::Damaged);
        }
        if bytes[4] != VERSION {
            return Err(Problem::Version { found: bytes[4] });
        }
        let (bus_bits, level) = (bytes[5], bytes[6]);
        if !matches!(bus_bits, 8 | 10 | 12 | 14) || level > 1 || bytes[7] != 0 {
            return Err(Problem::Header);
        }
        Ok(Self { bus_bits, vsync_active: level == 1, pclk_hz: u32_at(bytes, 8) })
    }

    /// Bytes of one sample in a record: 1 for an 8-bit bus, else 2.
    #[must_use]
    pub const fn sample_bytes(&self) -> usize {
        if self.bus_bits == 8 { 1 } else { 2 }
    }

    /// The largest sample of the bus.
    #[must_use]
    pub const fn sample_max(&self) -> u16 {
        match self.bus_bits {
            8 => 0xFF,
            10 => 0x3FF,
            12 => 0xFFF,
            _ => 0x3FFF,
        }
    }
}

/// What a file holds, from its END.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Pixel clocks.
    pub clocks: u64,
    /// Marks: one at clock 0 (if there is a clock), and one at each edge of VSYNC to its active level.
    pub marks: u64,
    /// File offset of the last INDEX chunk; 0 if there is none.
    pub last_index: u64,
}

impl Totals {
    /// END's payload.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; END_BYTES] {
        let mut bytes = [0; END_BYTES];
        bytes[..8].copy_from_slice(&self.clocks.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.marks.to_le_bytes());
        bytes[16..].copy_from_slice(&self.last_index.to_le_bytes());
        bytes
    }

    /// The totals that this payload is, if it has the right length.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        (bytes.len() == END_BYTES).then(|| Self {
            clocks: u64_at(bytes, 0),
            marks: u64_at(bytes, 8),
            last_index: u64_at(bytes, 16),
        })
    }
}

/// Where a frame begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mark {
    /// File offset of the DATA chunk whose first sample is the frame's.
    pub offset: u64,
    /// Number of that sample's clock, from 0.
    pub clock: u64,
}

/// The 4 KiB that a reader or writer borrows: one chunk, aligned so that 16-bit samples are handed on in place.
#[derive(Clone, Debug)]
pub struct ChunkBuffer(pub(super) [u16; CHUNK_BYTES / 2]);

impl ChunkBuffer {
    /// An empty buffer.
    #[must_use]
    pub const fn new() -> Self {
        Self([0; CHUNK_BYTES / 2])
    }

    pub(super) fn bytes(&self) -> &[u8; CHUNK_BYTES] {
        bytemuck::cast_ref(&self.0)
    }

    pub(super) fn bytes_mut(&mut self) -> &mut [u8; CHUNK_BYTES] {
        bytemuck::cast_mut(&mut self.0)
    }
}

impl Default for ChunkBuffer {
    fn default() -> Self {
        Self::new()
    }
}

/// The number at `at`; missing bytes count as 0 (callers have checked the length).
pub(super) fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    if let Some(found) = bytes.get(at..at + 8) {
        word.copy_from_slice(found);
    }
    u64::from_le_bytes(word)
}

/// The number at `at`; missing bytes count as 0 (callers have checked the length).
pub(super) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut word = [0; 4];
    if let Some(found) = bytes.get(at..at + 4) {
        word.copy_from_slice(found);
    }
    u32::from_le_bytes(word)
}

/// The number at `at`; missing bytes count as 0 (callers have checked the length).
pub(super) fn u16_at(bytes: &[u8], at: usize) -> u16 {
    let mut word = [0; 2];
    if let Some(found) = bytes.get(at..at + 2) {
        word.copy_from_slice(found);
    }
    u16::from_le_bytes(word)
}
