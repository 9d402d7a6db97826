//! Clocks, pins, buses and memory of an STM32H743ZI on Nucleo-H743ZI and Nucleo-H743ZI2.
//!
//! **Not run on silicon yet.** Wiring and first light: `docs/board.md`.
#![no_std]

use core::ptr::addr_of;

use cortex_m::peripheral::{CPUID, MPU, NVIC, SCB};
use embassy_stm32::gpio::{AfType, AnyPin, Flex, Level, Output, Pull, Speed};
use embassy_stm32::i2c::{self, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::peripherals::{DCMI, USART3};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, HSIPrescaler, Mco, Mco1Source, McoConfig, McoPrescaler, Pll, PllDiv, PllMul,
    PllPreDiv, PllSource, Sysclk, VoltageScale,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, BufferedUart, BufferedUartRx, BufferedUartTx};
use embassy_stm32::{Config, Peri, bind_interrupts, dcmi, pac};
use embassy_time::Duration;
use firmware::driver::config::Policy;
use static_cell::ConstStaticCell;
use stm32::chip::STM32H743;
use stm32::device::Window;
use stm32::image::application::Board;
use stm32::image::memory::FrameMemory;
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

/// Bits a second on USART3, whose wires are those of the ST-LINK's virtual COM port.
pub const BAUD: u32 = 921_600;

/// Bytes that wait to leave, and commands that wait to be read: a frame's line, and the largest command twice.
const OUT: usize = 1_024;
const IN: usize = 1_024;

bind_interrupts!(struct Interrupts {
    USART3 => usart::BufferedInterruptHandler<USART3>;
});

/// A sensor's pins and bus, and the serial line.
pub type Sensor = Board<
    I2c<'static, Blocking, Master>,
    Output<'static>,
    Output<'static>,
    BufferedUartTx<'static>,
    BufferedUartRx<'static>,
>;

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

/// A pin for DCMI. It is never given back, so it stays as it is.
fn signal(pin: Peri<'static, AnyPin>, function: u8) {
    let mut pin = Flex::new(pin);
    pin.set_as_af_unchecked(function, AfType::input(Pull::None));
    core::mem::forget(pin);
}

/// Brings the chip up: clocks, caches, the sensor's clock and pins, DCMI and its DMA.
#[must_use]
pub fn init(mpu: &mut MPU, scb: &mut SCB, cpuid: &mut CPUID) -> (Sensor, DcmiPort<'static, Mmio>) {
    let p = embassy_stm32::init(clocks());
    keep_frames_out_of_the_cache(mpu);
    scb.enable_icache();
    scb.enable_dcache(cpuid);

    let mut clock = McoConfig::default();
    clock.prescaler = McoPrescaler::DIV2;
    // It runs for ever.
    let _ = Mco::new(p.MCO1, p.PA8, Mco1Source::HSI48, clock);

    /// The pin's function number, known by its type.
    macro_rules! signals {
        ($($signal:ident $pin:ident),* $(,)?) => {
            $({
                let function = dcmi::$signal::<DCMI>::af_num(&*p.$pin);
                signal(p.$pin.into(), function);
            })*
        };
    }
    signals!(
        PixClkPin PA6, HSyncPin PA4, VSyncPin PG9,
        D0Pin PC6, D1Pin PC7, D2Pin PC8, D3Pin PC9, D4Pin PE4, D5Pin PD3, D6Pin PE5, D7Pin PE6,
    );
    pac::RCC.ahb2enr().modify(|enable| enable.set_dcmien(true));
    pac::RCC.ahb1enr().modify(|enable| enable.set_dma2en(true));
    // A read after the enable, for the clock takes two cycles to arrive (RM0433 ch. 8).
    let _ = pac::RCC.ahb1enr().read();
    debug_assert_eq!(pac::DCMI.as_ptr() as u32, STM32H743.dcmi);
    debug_assert_eq!(pac::DMA2.as_ptr() as u32, STM32H743.dma);

    let mut bus = i2c::Config::default();
    bus.frequency = Hertz::khz(100);
    // A bus that is held low, or has no pull-ups, is an error and not a wait for ever: a transfer takes under 1 ms.
    bus.timeout = Duration::from_millis(10);
    let i2c = I2c::new_blocking(p.I2C1, p.PB8, p.PB9, bus);
    let mut line = usart::Config::default();
    line.baudrate = BAUD;
    static OUTGOING: ConstStaticCell<[u8; OUT]> = ConstStaticCell::new([0; OUT]);
    static INCOMING: ConstStaticCell<[u8; IN]> = ConstStaticCell::new([0; IN]);
    let (outgoing, incoming) = (OUTGOING.take(), INCOMING.take());
    let serial = BufferedUart::new(p.USART3, p.PD9, p.PD8, outgoing, incoming, Interrupts, line);
    let Ok(serial) = serial else { unreachable!("the divider for this rate fits") };
    let (serial, commands) = serial.split();
    let sensor = Board {
        i2c,
        reset: Output::new(p.PD15, Level::Low, Speed::Low),
        power_down: Output::new(p.PD14, Level::High, Speed::Low),
        sensor_hz: SENSOR_HZ,
        hclk_hz: HCLK_HZ,
        policy: Policy::NewestWins,
        serial,
        commands,
        // SAFETY: as below, but for DCMI's registers alone, of which none says where the DMA writes. The driver and a host
        // that pokes them may disagree about what is captured, and never about memory.
        registers: Window::new(unsafe { Mmio::new() }, &STM32H743),
        baud: BAUD,
    };
    // SAFETY: this is an STM32H743 as its reset and the clocks above prove; DCMI and DMA2 are clocked; embassy's drivers for
    // them are not used, and `init` takes the peripherals, so it does not come here twice.
    let silicon = unsafe { Mmio::new() };
    (sensor, DcmiPort::new(silicon, STM32H743))
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
