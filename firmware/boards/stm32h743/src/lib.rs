//! Clocks and memory of an STM32H743ZI on Nucleo-H743ZI and Nucleo-H743ZI2.
//!
//! **Not run on silicon yet.** Wiring and first light: `docs/board.md`.
#![no_std]

use core::ptr::addr_of;

use cortex_m::peripheral::{CPUID, MPU, NVIC, SCB};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, HSIPrescaler, Mco1Source, McoPrescaler, Pll, PllDiv, PllMul, PllPreDiv,
    PllSource, Sysclk, VoltageScale,
};
use embassy_stm32::{Config, pac};
use firmware::driver::config::Policy;
use stm32::chip::STM32H743;
use stm32::image::memory::FrameMemory;
use stm32::image::wiring::{self, Differs, Parts};
use stm32::port::DcmiPort;
use stm32::silicon::Mmio;

/// Clock of the core, in hertz.
pub const CORE_HZ: u32 = 400_000_000;
/// Clock of the bus matrix, in hertz.
pub const HCLK_HZ: u32 = 200_000_000;
/// The sensor's clock by MCO1, in hertz: HSI48 by 2.
pub const SENSOR_HZ: u32 = 24_000_000;
/// Words of a frame: QVGA with two bytes a pixel.
pub const FRAME_WORDS: usize = 320 * 240 * 2 / 4;
/// Frame buffers: two that the DMA fills in turn, one that is read.
pub const FRAMES: usize = 3;

/// The frames, in AXI SRAM.
// SAFETY: `memory.x` defines the section in memory that nothing else uses; nothing needs it initialized.
#[unsafe(link_section = ".frames")]
pub static MEMORY: FrameMemory<FRAME_WORDS, FRAMES> = FrameMemory::new();

/// Bounds of AXI SRAM.
const AXI: u32 = 0x2400_0000;
/// 2 to this power is its size less one: 512 KiB.
const AXI_SIZE: u32 = 18;

/// Starts the clocks: HSI by PLL1 to 400 MHz, half of it for the buses; HSI48 for the sensor.
fn clocks() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hsi = Some(HSIPrescaler::DIV1);
    rcc.pll1 = Some(Pll {
        source: PllSource::HSI,
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL50,
        fracn: None,
        divp: Some(PllDiv::DIV2),
        divq: Some(PllDiv::DIV8),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = VoltageScale::Scale1;
    config
}

/// Brings the chip up: clocks, caches, the sensor's clock and pins, DCMI and its DMA.
#[must_use]
pub fn init(mpu: &mut MPU, scb: &mut SCB, cpuid: &mut CPUID) -> (Parts, DcmiPort<'static, Mmio>) {
    let p = embassy_stm32::init(clocks());
    keep_frames_out_of_the_cache(mpu);
    scb.enable_icache();
    scb.enable_dcache(cpuid);
    let differs = Differs {
        chip: STM32H743,
        clock: (Mco1Source::HSI48, McoPrescaler::DIV2),
        sensor_hz: SENSOR_HZ,
        hclk_hz: HCLK_HZ,
        policy: Policy::NewestWins,
    };
    // SAFETY: this is an STM32H743, as its reset and the clocks above prove.
    unsafe { wiring::connect(p, differs) }
}

/// Lets the interrupts of DCMI and the stream through.
pub fn unmask() {
    for interrupt in [pac::Interrupt::DCMI, pac::Interrupt::DMA2_STREAM0] {
        // SAFETY: both handlers exist, and what they share with the program is behind critical sections.
        unsafe { NVIC::unmask(interrupt) };
    }
}

/// AXI SRAM as memory that is not cached and not executed: what the DMA wrote is what the core reads, without cleaning or
/// invalidating, and no dirty line of the cache can fall on top of it.
///
/// Armv7-M Architecture Reference Manual, B3.5: region 0, TEX = 1, C = 0, B = 0 (normal, not cacheable), shareable, full
/// access, execute never. All else stays as it is by PRIVDEFENA.
fn keep_frames_out_of_the_cache(mpu: &mut MPU) {
    const EXECUTE_NEVER: u32 = 1 << 28;
    const FULL_ACCESS: u32 = 0b011 << 24;
    const NORMAL_NOT_CACHED: u32 = 0b001 << 19;
    const SHAREABLE: u32 = 1 << 18;
    const ENABLE: u32 = 1;
    const PRIVILEGED_DEFAULT: u32 = 1 << 2;
    debug_assert_eq!(addr_of!(MEMORY) as u32 & 0xFF00_0000, AXI);
    cortex_m::asm::dmb();
    let attributes = EXECUTE_NEVER | FULL_ACCESS | NORMAL_NOT_CACHED | SHAREABLE | AXI_SIZE << 1 | ENABLE;
    // SAFETY: the caches are still off and the region holds frames only, so no access in flight changes its meaning.
    unsafe { mpu.rnr.write(0) };
    // SAFETY: as above.
    unsafe { mpu.rbar.write(AXI) };
    // SAFETY: as above.
    unsafe { mpu.rasr.write(attributes) };
    // SAFETY: as above; PRIVDEFENA leaves the rest of the map as it is.
    unsafe { mpu.ctrl.write(PRIVILEGED_DEFAULT | ENABLE) };
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
