//! Captures frames of 160 × 120 gray pixels with embassy's own DCMI driver and sends them over USART3, each behind a header
//! of `FRAM`, or `OVER` and `ERRO` for what the driver returns instead. It is written as embassy's examples are, knows
//! nothing of camif, and would run on a NUCLEO-H743ZI or a NUCLEO-F429ZI.
#![no_std]
#![no_main]

use embassy_executor::Spawner;
use embassy_stm32::dcmi::{
    self, Dcmi, Error, HSyncDataInvalidLevel, PixelClockPolarity, VSyncDataInvalidLevel,
};
use embassy_stm32::usart::{self, Uart};
use embassy_stm32::{bind_interrupts, dma, peripherals};
use panic_halt as _;

/// Words of a frame.
const WORDS: usize = 160 * 120 / 4;

#[cfg(feature = "stm32h743")]
type CameraDma = peripherals::DMA1_CH0;
#[cfg(feature = "stm32f429")]
type CameraDma = peripherals::DMA2_CH1;

bind_interrupts!(struct Interrupts {
    DCMI => dcmi::InterruptHandler<peripherals::DCMI>;
    #[cfg(feature = "stm32h743")]
    DMA1_STREAM0 => dma::InterruptHandler<CameraDma>;
    #[cfg(feature = "stm32f429")]
    DMA2_STREAM1 => dma::InterruptHandler<CameraDma>;
});

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let p = embassy_stm32::init(Default::default());
    let mut serial_config = usart::Config::default();
    serial_config.baudrate = 1_000_000;
    let mut serial = Uart::new_blocking(p.USART3, p.PD9, p.PD8, serial_config).unwrap();
    #[cfg(feature = "stm32h743")]
    let channel = p.DMA1_CH0;
    #[cfg(feature = "stm32f429")]
    let channel = p.DMA2_CH1;
    let mut config = dcmi::Config::default();
    config.vsync_level = VSyncDataInvalidLevel::High;
    config.hsync_level = HSyncDataInvalidLevel::Low;
    config.pixclk_polarity = PixelClockPolarity::RisingEdge;
    let mut camera = Dcmi::new_8bit(
        p.DCMI, channel, Interrupts, p.PC6, p.PC7, p.PC8, p.PC9, p.PE4, p.PD3, p.PE5, p.PE6, p.PB7, p.PA4,
        p.PA6, config,
    );
    let mut frame = [0u32; WORDS];
    loop {
        let header = match camera.capture(&mut frame).await {
            Ok(()) => b"FRAM",
            Err(Error::Overrun) => b"OVER",
            Err(_) => b"ERRO",
        };
        serial.blocking_write(header).unwrap();
        if header == b"FRAM" {
            for word in &frame {
                serial.blocking_write(&word.to_le_bytes()).unwrap();
            }
        }
    }
}
