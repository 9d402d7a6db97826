//! The register map: offsets, bit fields, and the seam through which the driver reaches them.
//!
//! Offsets 0x00–0x28 are those of ST's digital camera interface (DCMI; RM0090 Rev 21 ch. 15, RM0433 ch. 29). From 0x40
//! on stand this block's own extensions: the sync mode, the counters, and the burst DMA, which on STM32 is a separate
//! controller. On a [`Part`](super::Part) without an extension its registers read 0 and ignore writes.

use arbitrary_int::{u3, u13, u14, u28};
use bitbybit::{bitenum, bitfield};

/// A register of the block, by its byte offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u32)]
pub enum Register {
    /// CR: [`Control`].
    Control = 0x00,
    /// SR: [`Status`], read only.
    Status = 0x04,
    /// RIS: [`Events`] as they happened, read only.
    RawInterrupt = 0x08,
    /// IER: [`Events`] that raise the interrupt.
    InterruptEnable = 0x0C,
    /// MIS: [`Events`] that happened and are enabled, read only.
    MaskedInterrupt = 0x10,
    /// ICR: [`Events`] to clear, write 1; reads 0.
    InterruptClear = 0x14,
    /// ESCR: [`SyncCodes`] of embedded synchronisation.
    SyncCode = 0x18,
    /// ESUR: [`SyncCodes`]; a 1 compares this bit of the code.
    SyncUnmask = 0x1C,
    /// CWSTRT: [`CropStart`].
    CropStart = 0x20,
    /// CWSIZE: [`CropSize`].
    CropSize = 0x24,
    /// DR: takes a word out of the FIFO; byte 0 is the least significant.
    Data = 0x28,
    /// XCR: [`Extension`] control.
    Extension = 0x40,
    /// LBCR: bytes captured in the line that ended last, read only.
    LineBytes = 0x44,
    /// FBCR: bytes captured in the frame that ended last, read only.
    FrameBytes = 0x48,
    /// FLCR: lines captured in the frame that ended last, read only.
    FrameLines = 0x4C,
    /// DCR: [`DmaControl`].
    DmaControl = 0x60,
    /// DSR: [`DmaStatus`], read only.
    DmaStatus = 0x64,
    /// DICR: [`DmaStatus`] flags to clear, write 1; reads 0.
    DmaClear = 0x68,
    /// DNDTR: words a transfer; read: words left of the current one.
    DmaCount = 0x6C,
    /// DM0AR: [`DmaAddress`] of target 0.
    DmaTarget0 = 0x70,
    /// DM1AR: [`DmaAddress`] of target 1.
    DmaTarget1 = 0x74,
}

impl Register {
    /// Every register, in the order of the map.
    pub const ALL: [Self; 21] = [
        Self::Control,
        Self::Status,
        Self::RawInterrupt,
        Self::InterruptEnable,
        Self::MaskedInterrupt,
        Self::InterruptClear,
        Self::SyncCode,
        Self::SyncUnmask,
        Self::CropStart,
        Self::CropSize,
        Self::Data,
        Self::Extension,
        Self::LineBytes,
        Self::FrameBytes,
        Self::FrameLines,
        Self::DmaControl,
        Self::DmaStatus,
        Self::DmaClear,
        Self::DmaCount,
        Self::DmaTarget0,
        Self::DmaTarget1,
    ];

    /// Byte offset from the base of the block.
    #[must_use]
    pub const fn offset(self) -> u32 {
        self as u32
    }

    /// The register at a byte offset, if there is one.
    #[must_use]
    pub fn at(offset: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|register| register.offset() == offset)
    }
}

/// Access to the registers of one block: the model's, or memory-mapped ones.
pub trait Registers {
    /// Reads 32 bits. Reading [`Register::Data`] takes a word out of the FIFO.
    fn read(&mut self, register: Register) -> u32;
    /// Writes 32 bits.
    fn write(&mut self, register: Register, value: u32);
}

/// FCRC: which frames a continuous capture takes.
#[bitenum(u2, exhaustive = false)]
#[derive(Debug, PartialEq, Eq)]
pub enum FrameRate {
    /// Every frame.
    All = 0,
    /// Every second frame.
    Half = 1,
    /// Every fourth frame.
    Quarter = 2,
}

/// EDM: data wires in use.
#[bitenum(u2, exhaustive = true)]
#[derive(Debug, PartialEq, Eq)]
pub enum BusWidth {
    /// D0 to D7.
    Bits8 = 0,
    /// D0 to D9.
    Bits10 = 1,
    /// D0 to D11.
    Bits12 = 2,
    /// D0 to D13.
    Bits14 = 3,
}

impl BusWidth {
    /// Wires.
    #[must_use]
    pub const fn bits(self) -> u32 {
        match self {
            Self::Bits8 => 8,
            Self::Bits10 => 10,
            Self::Bits12 => 12,
            Self::Bits14 => 14,
        }
    }

    /// The width with this many wires, if there is one.
    #[must_use]
    pub const fn from_bits(bits: u32) -> Option<Self> {
        match bits {
            8 => Some(Self::Bits8),
            10 => Some(Self::Bits10),
            12 => Some(Self::Bits12),
            14 => Some(Self::Bits14),
            _ => None,
        }
    }

    /// Bytes that a sample takes in memory: wider ones are zero-extended to 16 bits.
    #[must_use]
    pub const fn bytes_per_sample(self) -> u32 {
        match self {
            Self::Bits8 => 1,
            Self::Bits10 | Self::Bits12 | Self::Bits14 => 2,
        }
    }
}

/// BSM: which bytes of a line are taken (8-bit bus, newer parts).
#[bitenum(u2, exhaustive = true)]
#[derive(Debug, PartialEq, Eq)]
pub enum ByteSelect {
    /// All of them.
    All = 0,
    /// Every second byte.
    OneOfTwo = 1,
    /// Every fourth byte.
    OneOfFour = 2,
    /// Two bytes out of four.
    TwoOfFour = 3,
}

/// CR: what is captured, and how the pins are read.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct Control {
    /// CAPTURE: take frames from the next frame start on.
    #[bit(0, rw)]
    capture: bool,
    /// CM: one frame, then CAPTURE clears.
    #[bit(1, rw)]
    snapshot: bool,
    /// CROP: take the crop window only.
    #[bit(2, rw)]
    crop: bool,
    /// JPEG: HSYNC is data enable, and the last word is padded with zeros.
    #[bit(3, rw)]
    jpeg: bool,
    /// ESS: synchronisation codes in the data rather than wires.
    #[bit(4, rw)]
    embedded_sync: bool,
    /// PCKPOL: pins are sampled on the rising edge.
    #[bit(5, rw)]
    sample_on_rising: bool,
    /// HSPOL: the level of HSYNC at which data is not valid is high.
    #[bit(6, rw)]
    hsync_blank_high: bool,
    /// VSPOL: the level of VSYNC at which data is not valid is high.
    #[bit(7, rw)]
    vsync_blank_high: bool,
    /// FCRC.
    #[bits(8..=9, rw)]
    frame_rate: Option<FrameRate>,
    /// EDM.
    #[bits(10..=11, rw)]
    bus_width: BusWidth,
    /// ENABLE: off holds the capture side in reset.
    #[bit(14, rw)]
    enable: bool,
    /// BSM.
    #[bits(16..=17, rw)]
    byte_select: ByteSelect,
    /// OEBS: start the byte selection with the second byte.
    #[bit(18, rw)]
    byte_select_odd: bool,
    /// LSM: take one line out of two.
    #[bit(19, rw)]
    line_select: bool,
    /// OELS: start the line selection with the second line.
    #[bit(20, rw)]
    line_select_odd: bool,
}

/// SR: the state of the pins and the FIFO.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct Status {
    /// HSYNC: 1 between lines (the wire is at its blanking level), whatever the polarity.
    #[bit(0, rw)]
    hsync: bool,
    /// VSYNC: 1 between frames.
    #[bit(1, rw)]
    vsync: bool,
    /// FNE: the FIFO holds a word.
    #[bit(2, rw)]
    fifo_not_empty: bool,
}

/// RIS, IER, MIS, ICR: one bit an event.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct Events {
    /// FRAME: a frame, or the crop window, is complete.
    #[bit(0, rw)]
    frame: bool,
    /// OVR: a word came while the FIFO was full.
    #[bit(1, rw)]
    overrun: bool,
    /// ERR: an embedded synchronisation code out of order.
    #[bit(2, rw)]
    error: bool,
    /// VSYNC: a frame ended on the wires, captured or not.
    #[bit(3, rw)]
    vsync: bool,
    /// LINE: a line ended on the wires, inside the crop window or not.
    #[bit(4, rw)]
    line: bool,
}

impl Events {
    /// The bits that exist.
    pub const MASK: u32 = 0x1F;
}

/// ESCR and ESUR: codes of embedded synchronisation, and the bits of them that are compared.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct SyncCodes {
    /// FSC: frame start.
    #[bits(0..=7, rw)]
    frame_start: u8,
    /// LSC: line start.
    #[bits(8..=15, rw)]
    line_start: u8,
    /// LEC: line end.
    #[bits(16..=23, rw)]
    line_end: u8,
    /// FEC: frame end.
    #[bits(24..=31, rw)]
    frame_end: u8,
}

/// CWSTRT: where the crop window starts.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct CropStart {
    /// HOFFCNT: pixel clocks of a line before the window.
    #[bits(0..=13, rw)]
    clocks: u14,
    /// VST: lines of a frame before the window.
    #[bits(16..=28, rw)]
    line: u13,
}

/// CWSIZE: how large the crop window is.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct CropSize {
    /// CAPCNT: pixel clocks of a line in the window, less one.
    #[bits(0..=13, rw)]
    clocks_less_one: u14,
    /// VLINE: lines in the window, less one.
    #[bits(16..=29, rw)]
    lines_less_one: u14,
}

/// XCR: what DCMI does not have.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct Extension {
    /// MARKER: every pixel clock carries data, and the sync wires mark the ends of lines and frames.
    #[bit(0, rw)]
    marker: bool,
}

/// Words a DMA burst moves.
#[bitenum(u2, exhaustive = false)]
#[derive(Debug, PartialEq, Eq)]
pub enum Burst {
    /// A word a grant.
    One = 0,
    /// Two words.
    Two = 1,
    /// Four words: the whole FIFO.
    Four = 2,
}

impl Burst {
    /// Words.
    #[must_use]
    pub const fn words(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
        }
    }
}

/// What the DMA does at the end of a transfer.
#[bitenum(u2, exhaustive = false)]
#[derive(Debug, PartialEq, Eq)]
pub enum DmaMode {
    /// Stops.
    Single = 0,
    /// Starts again at the same target: a circular buffer.
    Circular = 1,
    /// Goes on at the other target.
    Double = 2,
}

/// DCR: the burst DMA.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct DmaControl {
    /// EN. Setting it loads the count and starts at target 0; it clears when a single transfer ends, or on an error.
    #[bit(0, rw)]
    enable: bool,
    /// HTIE: interrupt when half of a transfer is done.
    #[bit(1, rw)]
    half_interrupt: bool,
    /// TCIE: interrupt when a transfer is done.
    #[bit(2, rw)]
    complete_interrupt: bool,
    /// TEIE: interrupt on an error.
    #[bit(3, rw)]
    error_interrupt: bool,
    /// LBL: a transfer is a line; a shorter line ends it early, the rest of a longer one is dropped.
    #[bit(4, rw)]
    line_by_line: bool,
    /// MODE.
    #[bits(8..=9, rw)]
    mode: Option<DmaMode>,
    /// BURST.
    #[bits(12..=13, rw)]
    burst: Option<Burst>,
}

/// DSR and DICR: the burst DMA's flags.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct DmaStatus {
    /// HTIF: half of a transfer is done.
    #[bit(1, rw)]
    half: bool,
    /// TCIF: a transfer is done.
    #[bit(2, rw)]
    complete: bool,
    /// TEIF: the target lies outside lent memory.
    #[bit(3, rw)]
    error: bool,
    /// CT: the target in use is 1.
    #[bit(8, rw)]
    target: bool,
    /// CW: words that the last completed line had, of a transfer line by line.
    #[bits(16..=31, rw)]
    line_words: u16,
}

impl DmaStatus {
    /// The flags that can be cleared.
    pub const MASK: u32 = 0b1110;
}

/// DM0AR, DM1AR: a place in the memory that was lent to the DMA.
#[bitfield(u32, default = 0)]
#[derive(Debug, PartialEq, Eq)]
pub struct DmaAddress {
    /// First word in the slot, low bits.
    #[bits(0..=27, rw)]
    word: u28,
    /// Slot of lent memory.
    #[bits(28..=30, rw)]
    slot: u3,
}
