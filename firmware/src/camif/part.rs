//! What a part can do: the model plays any of them, and the driver refuses what a part can't take.

/// Abilities of one part's camera interface and of the DMA beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Part {
    /// The part's name, for messages.
    pub name: &'static str,
    /// Byte and line selection (BSM, OEBS, LSM, OELS) exist.
    pub selection: bool,
    /// The `marker` sync mode exists.
    pub marker: bool,
    /// The line and frame counters exist (LBCR, FBCR, FLCR).
    pub counters: bool,
    /// The DMA can end a transfer at a line's end.
    pub line_by_line: bool,
    /// Words that one DMA transfer moves at most.
    pub transfer_limit: u32,
    /// HCLK must be at least this many tenths of PCLK.
    pub bus_clock_tenths: u32,
}

impl Part {
    /// This project's own block, with every extension.
    pub const CAMIF: Self = Self {
        name: "CAMIF",
        selection: true,
        marker: true,
        counters: true,
        line_by_line: true,
        transfer_limit: (1 << 28) - 1,
        bus_clock_tenths: 25,
    };
    /// STM32F4 (RM0090): DCMI without selection, DMA2 with a 16-bit count.
    pub const STM32F4: Self = Self {
        name: "STM32F4",
        selection: false,
        marker: false,
        counters: false,
        line_by_line: false,
        transfer_limit: 65_535,
        bus_clock_tenths: 25,
    };
    /// STM32H7 (RM0433): DCMI with selection, DMA1/2 with a 16-bit count.
    pub const STM32H7: Self = Self { name: "STM32H7", selection: true, ..Self::STM32F4 };
}
