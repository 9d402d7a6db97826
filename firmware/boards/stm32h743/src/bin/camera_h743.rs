//! Finds the sensor, captures QVGA frames, sends them and what the stages make of them, and does what the link asks for.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use cortex_m::Peripherals;
use cortex_m_rt::entry;
use defmt_rtt as _;
use embassy_stm32::pac::interrupt;
use firmware::driver::FrameCamera;
use firmware::station::Memory;
use panic_probe as _;
use static_cell::ConstStaticCell;
use stm32::image::application::{self, STAGES};
use stm32::image::serve::{self, Camera};
use stm32::image::ticks;
use stm32h743::{CORE_HZ, FRAMES, MEMORY};

#[interrupt]
fn DCMI() {
    serve::on_interrupt();
}

#[interrupt]
fn DMA2_STREAM0() {
    serve::on_interrupt();
}

#[entry]
fn main() -> ! {
    static LINE: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::new());
    static VISION: ConstStaticCell<[u32; STAGES]> = ConstStaticCell::new([0; STAGES]);
    static mut CAMERA: MaybeUninit<Camera<FRAMES>> = MaybeUninit::uninit();
    let Some(mut core) = Peripherals::take() else { unreachable!("the program starts once") };
    let (parts, port) = stm32h743::init(&mut core.MPU, &mut core.SCB, &mut core.CPUID);
    ticks::start(core.SYST, CORE_HZ);
    // SAFETY: the only call, for the program starts once.
    let frames = unsafe { MEMORY.claim() };
    let Ok(camera) = FrameCamera::new(port, frames) else { unreachable!("a new port holds no memory") };
    let camera = CAMERA.write(camera);
    stm32h743::unmask();
    application::run(parts, camera, LINE.take(), VISION.take())
}
