//! Pins, buses and clocks that are the same on every board: the Nucleo-144 boards have the camera on the same pins.
//!
//! The types are those of `embassy-stm32` for the chip that the board's package has chosen, so that a pin that cannot carry
//! its signal on that chip does not compile.

use cortex_m::peripheral::NVIC;
use embassy_stm32::gpio::{AfType, AnyPin, Flex, Level, Output, Pull, Speed};
use embassy_stm32::i2c::{self, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::peripherals::{DCMI, USART3};
use embassy_stm32::rcc::{Mco, Mco1Source, McoConfig, McoPrescaler};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, BufferedUart};
use embassy_stm32::{Peri, Peripherals, bind_interrupts, dcmi, pac};
use embassy_time::Duration;
use firmware::driver::config::Policy;
use static_cell::ConstStaticCell;

use super::application;
use crate::chip::Chip;
use crate::device::Window;
use crate::port::DcmiPort;
use crate::silicon::Mmio;

/// Bits a second on USART3, whose wires are those of the ST-LINK's virtual COM port.
pub const BAUD: u32 = 921_600;

/// Bytes that wait to leave, and commands that wait to be read: a frame's line, and the largest command twice.
const OUT: usize = 1_024;
const IN: usize = 1_024;

bind_interrupts!(struct Interrupts {
    USART3 => usart::BufferedInterruptHandler<USART3>;
});

/// USART3, which goes on sending whatever comes between.
///
/// `BufferedUart` asks for the interrupt that sends only if its buffer was empty when it looked, before it put bytes in. If the
/// handler sent the last byte in between, it has gone to rest, nobody asks for it, and a full buffer is waited for without an
/// end. Seen on the emulated F429; so the interrupt is asked for after every write.
pub struct Serial(BufferedUart<'static>);

impl embedded_io::ErrorType for Serial {
    type Error = usart::Error;
}

impl embedded_io::Read for Serial {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, usart::Error> {
        embedded_io::Read::read(&mut self.0, bytes)
    }
}

impl embedded_io::ReadReady for Serial {
    fn read_ready(&mut self) -> Result<bool, usart::Error> {
        embedded_io::ReadReady::read_ready(&mut self.0)
    }
}

impl embedded_io::Write for Serial {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, usart::Error> {
        // What fits an empty buffer: a write never waits for room with the handler at rest.
        let bytes = bytes.get(..OUT / 4).unwrap_or(bytes);
        let written = embedded_io::Write::write(&mut self.0, bytes);
        NVIC::pend(pac::Interrupt::USART3);
        written
    }

    fn flush(&mut self) -> Result<(), usart::Error> {
        embedded_io::Write::flush(&mut self.0)
    }
}

/// A sensor's pins and bus, and the serial line.
pub type Parts = application::Parts<I2c<'static, Blocking, Master>, Output<'static>, Output<'static>, Serial>;

/// What differs from board to board.
pub struct Differs {
    /// The chip.
    pub chip: Chip,
    /// Where MCO1 takes the sensor's clock from, and how it divides it.
    pub clock: (Mco1Source, McoPrescaler),
    /// The sensor's clock that comes of it, in hertz.
    pub sensor_hz: u32,
    /// Clock of the bus matrix, in hertz.
    pub hclk_hz: u32,
    /// How frames are taken.
    pub policy: Policy,
}

/// A pin for DCMI. It is never given back, so it stays as it is.
fn signal(pin: Peri<'static, AnyPin>, function: u8) {
    let mut pin = Flex::new(pin);
    pin.set_as_af_unchecked(function, AfType::input(Pull::None));
    core::mem::forget(pin);
}

/// The sensor's clock and pins, its bus, the serial line, DCMI and its DMA. The chip's clocks run already.
///
/// # Safety
/// This runs on the chip that `differs` names.
pub unsafe fn connect(p: Peripherals, differs: Differs) -> (Parts, DcmiPort<'static, Mmio>) {
    let Differs { chip, clock: (source, prescaler), sensor_hz, hclk_hz, policy } = differs;
    let mut clock = McoConfig::default();
    clock.prescaler = prescaler;
    // It runs for ever.
    let _ = Mco::new(p.MCO1, p.PA8, source, clock);

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
    // A read after the enable, for the clock takes two cycles to arrive (RM0433 ch. 8, RM0090 ch. 6).
    let _ = pac::RCC.ahb1enr().read();
    debug_assert_eq!(pac::DCMI.as_ptr() as u32, chip.dcmi);
    debug_assert_eq!(pac::DMA2.as_ptr() as u32, chip.dma);

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
    // SAFETY: as below, but for DCMI's registers alone, of which none says where the DMA writes. The driver and a host that
    // pokes them may disagree about what is captured, and never about memory.
    let looked_at = unsafe { Mmio::new() };
    let parts = Parts {
        i2c,
        reset: Output::new(p.PD15, Level::Low, Speed::Low),
        power_down: Output::new(p.PD14, Level::High, Speed::Low),
        sensor_hz,
        hclk_hz,
        policy,
        serial: Serial(serial),
        baud: BAUD,
        registers: Window::new(looked_at, &chip),
    };
    // SAFETY: the caller promises the chip; DCMI and DMA2 are clocked; embassy's drivers for them are not used, and there is
    // one set of peripherals, so this is called once.
    let silicon = unsafe { Mmio::new() };
    (parts, DcmiPort::new(silicon, chip))
}
