//! Clocks and memory of an STM32F429ZI on Nucleo-F429ZI.
//!
//! **Not run on silicon yet.** Wiring and first light: `docs/board.md`.
#![no_std]

use cortex_m::peripheral::NVIC;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Mco1Source, McoPrescaler, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::{Config, pac};
use firmware::driver::config::Policy;
use stm32::chip::STM32F429;
use stm32::image::memory::FrameMemory;
use stm32::image::wiring::{self, Differs, Parts};
use stm32::port::DcmiPort;
use stm32::silicon::Mmio;

/// Clock of the core, in hertz.
pub const CORE_HZ: u32 = 120_000_000;
/// Clock of the bus matrix, in hertz.
pub const HCLK_HZ: u32 = 120_000_000;
/// The sensor's clock by MCO1, in hertz: the PLL by 5.
pub const SENSOR_HZ: u32 = 24_000_000;
/// Words of a frame: QVGA with two bytes a pixel.
pub const FRAME_WORDS: usize = 320 * 240 * 2 / 4;
/// Frame buffers: one, for a second does not fit beside it. Frames are taken as snapshots.
pub const FRAMES: usize = 1;

/// The frame, in SRAM.
// SAFETY: `memory.x` defines the section in memory that nothing else uses; nothing needs it initialized.
#[unsafe(link_section = ".frames")]
pub static MEMORY: FrameMemory<FRAME_WORDS, FRAMES> = FrameMemory::new();

/// Starts the clocks: HSI by the PLL to 120 MHz, of which a fifth is the sensor's. The core could do 180 MHz, of which no
/// divider of MCO1 makes 24.
fn clocks() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hsi = true;
    rcc.pll_src = PllSource::HSI;
    rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV8,
        mul: PllMul::MUL120,
        divp: Some(PllPDiv::DIV2),
        divq: None,
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = APBPrescaler::DIV4;
    rcc.apb2_pre = APBPrescaler::DIV2;
    config
}

/// Brings the chip up: clocks, the sensor's clock and pins, DCMI and its DMA.
#[must_use]
pub fn init() -> (Parts, DcmiPort<'static, Mmio>) {
    let p = embassy_stm32::init(clocks());
    let differs = Differs {
        chip: STM32F429,
        clock: (Mco1Source::PLL, McoPrescaler::DIV5),
        sensor_hz: SENSOR_HZ,
        hclk_hz: HCLK_HZ,
        policy: Policy::Snapshot,
    };
    // SAFETY: this is an STM32F429, as its reset and the clocks above prove.
    unsafe { wiring::connect(p, differs) }
}

/// Lets the interrupts of DCMI and the stream through.
pub fn unmask() {
    for interrupt in [pac::Interrupt::DCMI, pac::Interrupt::DMA2_STREAM1] {
        // SAFETY: both handlers exist, and what they share with the program is behind critical sections.
        unsafe { NVIC::unmask(interrupt) };
    }
}
