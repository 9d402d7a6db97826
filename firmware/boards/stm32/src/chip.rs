//! Where a chip has what.

use core::ops::Range;

use firmware::port::Part;

/// A chip's camera interface and the stream that serves it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chip {
    /// What they can do.
    pub part: Part,
    /// DCMI's base.
    pub dcmi: u32,
    /// The DMA controller's base.
    pub dma: u32,
    /// The stream, 0 to 7.
    pub stream: u32,
    /// How the stream gets DCMI's requests.
    pub request: Request,
    /// Memory within the controller's reach.
    pub reach: &'static [Range<u32>],
}

/// How a stream is told whose requests it serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// By CHSEL in the stream itself.
    Channel(u32),
    /// By a multiplexer.
    Multiplexer {
        /// The register of the stream's channel.
        register: u32,
        /// DCMI's number.
        request: u32,
    },
}

/// STM32H743: DCMI (RM0433 ch. 29), DMA2 stream 0 behind DMAMUX1 channel 8, request 75 (RM0433 ch. 17).
///
/// DMA1 and DMA2 sit on the D2 matrix and reach AXI SRAM and the SRAMs of D2 and D3, but not the tightly coupled memories,
/// which hang on the core (RM0433 ch. 2).
pub const STM32H743: Chip = Chip {
    part: Part::STM32H7,
    dcmi: 0x4802_0000,
    dma: 0x4002_0400,
    stream: 0,
    request: Request::Multiplexer { register: 0x4002_0800 + 4 * 8, request: 75 },
    reach: &[
        0x2400_0000..0x2408_0000,
        0x3000_0000..0x3004_8000,
        0x3800_0000..0x3801_0000,
        0xC000_0000..0xE000_0000, // SDRAM on FMC, where a board has one
    ],
};

/// STM32F429: DCMI (RM0090 ch. 15), DMA2 stream 1 channel 1 (RM0090 §10.3.3, table 43).
///
/// The core-coupled memory at 0x1000_0000 is out of the DMA's reach (RM0090 §2.3.1); SDRAM on FMC, as on
/// the 32F429IDISCOVERY, is within it.
pub const STM32F429: Chip = Chip {
    part: Part::STM32F4,
    dcmi: 0x5005_0000,
    dma: 0x4002_6400,
    stream: 1,
    request: Request::Channel(1),
    reach: &[0x2000_0000..0x2003_0000, 0xC000_0000..0xE000_0000],
};

impl Chip {
    /// Whether the DMA reaches `words` words from `address` on.
    #[must_use]
    pub fn reaches(&self, address: u32, words: usize) -> bool {
        let end = u64::from(address) + 4 * words as u64;
        self.reach.iter().any(|range| address >= range.start && end <= u64::from(range.end))
    }
}
