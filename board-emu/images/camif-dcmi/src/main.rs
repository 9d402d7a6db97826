//! Captures frames of 160 × 120 gray pixels with this project's driver and writes a line of text on USART3 for each: what
//! came of it, and its CRC-32. When no frame came for a while, and something else did, it writes the driver's counts.
//!
//! It does not send the frames themselves, so that it keeps up with the camera and what it counts can be compared with a
//! run on the host, line by line. The chips, the size and the serial port are those of `embassy-dcmi`, its neighbour.
#![no_std]
#![no_main]

use core::fmt::{self, Write};
use core::mem::MaybeUninit;

use chip_support::image::serve::{self, Camera};
use chip_support::image::ticks;
use chip_support::port::DcmiPort;
use chip_support::silicon::Mmio;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::entry;
use embassy_stm32::gpio::{AfType, Flex, Pull};
use embassy_stm32::mode::Blocking;
use embassy_stm32::usart::{self, UartTx};
use embassy_stm32::{bind_interrupts, interrupt, peripherals, rcc};
use firmware::driver::config::{Damaged, Policy, SyncMode};
use firmware::driver::verdict::Statistics;
use firmware::driver::{Config, FrameCamera};
use panic_halt as _;

/// Pixels of a frame.
const SIZE: (u32, u32) = (160, 120);
/// Frame buffers.
const FRAMES: usize = 4;
/// Milliseconds to wait for a frame before the counts are looked at.
const PATIENCE: u64 = 40;

#[cfg(feature = "stm32f429")]
use chip_support::chip::STM32F429 as CHIP;
#[cfg(feature = "stm32h743")]
use chip_support::chip::STM32H743 as CHIP;

/// Clock of core and buses that `embassy_stm32::init` leaves by default, in hertz: HSI.
#[cfg(feature = "stm32h743")]
const CORE_HZ: u32 = 64_000_000;
#[cfg(feature = "stm32f429")]
const CORE_HZ: u32 = 16_000_000;

/// The handler of DCMI's interrupt and of the stream's.
struct Handler;

impl<I: interrupt::typelevel::Interrupt> interrupt::typelevel::Handler<I> for Handler {
    unsafe fn on_interrupt() {
        serve::on_interrupt();
    }
}

bind_interrupts!(struct Interrupts {
    DCMI => Handler;
    #[cfg(feature = "stm32h743")]
    DMA2_STREAM0 => Handler;
    #[cfg(feature = "stm32f429")]
    DMA2_STREAM1 => Handler;
});

/// Text on the serial line.
struct Text(UartTx<'static, Blocking>);

impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.blocking_write(text.as_bytes()).map_err(|_| fmt::Error)
    }
}

#[entry]
fn main() -> ! {
    static mut CAMERA: MaybeUninit<Camera<FRAMES>> = MaybeUninit::uninit();
    let p = embassy_stm32::init(Default::default());
    let Some(core) = cortex_m::Peripherals::take() else { unreachable!("the program starts once") };
    ticks::start(core.SYST, CORE_HZ);
    rcc::enable_and_reset::<peripherals::DCMI>();

    /// Each pin is DCMI's for ever: alternate function 13 on both chips.
    macro_rules! signals {
        ($($pin:ident)*) => {
            $({
                let mut pin = Flex::new(p.$pin);
                pin.set_as_af_unchecked(13, AfType::input(Pull::None));
                core::mem::forget(pin);
            })*
        };
    }
    signals!(PC6 PC7 PC8 PC9 PE4 PD3 PE5 PE6 PB7 PA4 PA6);

    let mut line = usart::Config::default();
    line.baudrate = 1_000_000;
    let Ok(serial) = UartTx::new_blocking(p.USART3, p.PD8, line) else { unreachable!("the divider fits") };
    let mut text = Text(serial);

    const WORDS: usize = (SIZE.0 * SIZE.1 / 4) as usize;
    let memory = cortex_m::singleton!(: [[u32; WORDS]; FRAMES] = [[0; WORDS]; FRAMES]);
    let Some(memory) = memory else { unreachable!("the program starts once") };
    // SAFETY: this is the chip that the feature names; `init` clocks both DMA controllers and `enable_and_reset` DCMI, and
    // nothing else in this program uses DCMI or that stream.
    let silicon = unsafe { Mmio::new() };
    let port = DcmiPort::new(silicon, CHIP);
    let Ok(camera) = FrameCamera::new(port, memory.each_mut().map(|frame| &mut frame[..])) else {
        unreachable!("a new port holds no memory")
    };
    let camera: &'static Camera<FRAMES> = CAMERA.write(camera);
    serve::register(camera);
    for interrupt in [
        interrupt::DCMI,
        #[cfg(feature = "stm32h743")]
        interrupt::DMA2_STREAM0,
        #[cfg(feature = "stm32f429")]
        interrupt::DMA2_STREAM1,
    ] {
        // SAFETY: the handlers stand above, and what they share with the program is behind critical sections.
        unsafe { NVIC::unmask(interrupt) };
    }

    let sync = SyncMode::Gated { hsync_blank_high: false, vsync_blank_high: true };
    let mut config = Config::new(sync, SIZE.0, SIZE.1);
    (config.policy, config.damaged) = (Policy::InOrder, Damaged::Deliver);
    if let Err(refusal) = camera.start(&config) {
        let _ = writeln!(text, "refused: {refusal}");
    }
    let mut told = Statistics::default();
    loop {
        report(camera, &mut text, &mut told);
    }
}

/// A line of text for the next frame, or for the counts if none came and they are others than before.
fn report(camera: &'static Camera<FRAMES>, text: &mut Text, told: &mut Statistics) {
    let started = ticks::now();
    let idle = || {
        cortex_m::asm::wfi();
        u64::from(ticks::now().wrapping_sub(started))
    };
    if let Ok(frame) = camera.wait_frame(PATIENCE, idle) {
        let verdict = frame.verdict();
        let (overruns, dropped) = (verdict.overruns, verdict.dropped_before);
        let crc = frame.crc32();
        let _ =
            writeln!(text, "{verdict}, CRC-32 {crc:08x}, {overruns} overruns and {dropped} frames before it");
    } else {
        let counts = camera.statistics();
        if counts != *told {
            let _ = writeln!(text, "{counts:?}");
            *told = counts;
        }
    }
}
