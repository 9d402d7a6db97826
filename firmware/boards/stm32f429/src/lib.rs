//! Clocks, pins, buses and memory of an STM32F429ZI on Nucleo-F429ZI.
//!
//! **Not run on silicon yet.** Wiring and first light: `docs/board.md`.
#![no_std]

use cortex_m::peripheral::NVIC;
use embassy_stm32::gpio::{AfType, AnyPin, Flex, Level, Output, Pull, Speed};
use embassy_stm32::i2c::{self, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::peripherals::{DCMI, USART3};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Mco, Mco1Source, McoConfig, McoPrescaler, Pll, PllMul, PllPDiv, PllPreDiv,
    PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, BufferedUart, BufferedUartRx, BufferedUartTx};
use embassy_stm32::{Config, Peri, bind_interrupts, dcmi, pac};
use embassy_time::Duration;
use firmware::driver::config::Policy;
use static_cell::ConstStaticCell;
use stm32::chip::STM32F429;
use stm32::device::Window;
use stm32::image::application::Board;
use stm32::image::memory::FrameMemory;
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

/// A pin for DCMI. It is never given back, so it stays as it is.
fn signal(pin: Peri<'static, AnyPin>, function: u8) {
    let mut pin = Flex::new(pin);
    pin.set_as_af_unchecked(function, AfType::input(Pull::None));
    core::mem::forget(pin);
}

/// Brings the chip up: clocks, the sensor's clock and pins, DCMI and its DMA.
#[must_use]
pub fn init() -> (Sensor, DcmiPort<'static, Mmio>) {
    let p = embassy_stm32::init(clocks());

    let mut clock = McoConfig::default();
    clock.prescaler = McoPrescaler::DIV5;
    // It runs for ever.
    let _ = Mco::new(p.MCO1, p.PA8, Mco1Source::PLL, clock);

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
    // A read after the enable, for the clock takes two cycles to arrive (RM0090 ch. 6).
    let _ = pac::RCC.ahb1enr().read();
    debug_assert_eq!(pac::DCMI.as_ptr() as u32, STM32F429.dcmi);
    debug_assert_eq!(pac::DMA2.as_ptr() as u32, STM32F429.dma);

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
        policy: Policy::Snapshot,
        serial,
        commands,
        // SAFETY: as below, but for DCMI's registers alone, of which none says where the DMA writes. The driver and a host
        // that pokes them may disagree about what is captured, and never about memory.
        registers: Window::new(unsafe { Mmio::new() }, &STM32F429),
        baud: BAUD,
    };
    // SAFETY: this is an STM32F429 as its reset and the clocks above prove; DCMI and DMA2 are clocked; embassy's drivers for
    // them are not used, and `init` takes the peripherals, so it does not come here twice.
    let silicon = unsafe { Mmio::new() };
    (sensor, DcmiPort::new(silicon, STM32F429))
}

/// Lets the interrupts of DCMI and the stream through.
pub fn unmask() {
    for interrupt in [pac::Interrupt::DCMI, pac::Interrupt::DMA2_STREAM1] {
        // SAFETY: both handlers exist, and what they share with the program is behind critical sections.
        unsafe { NVIC::unmask(interrupt) };
    }
}
