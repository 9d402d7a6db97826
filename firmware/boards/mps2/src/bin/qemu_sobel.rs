//! VGA RGB888 line by line through the device's pipeline: balance, gray, Gaussian, Sobel.
#![no_std]
#![no_main]

use exercise::replay::scenario::SOBEL;
use firmware::pipeline::Settings;
use firmware::trace::ChunkBuffer;
use mps2::{exit, rig, scene};
use static_cell::ConstStaticCell;

/// Words of a line of the camera.
const LINE: usize = 640 * 3 / 4;
/// Words of the pipeline.
const PIPELINE: usize = Settings::sobel_memory(640);

static RING: ConstStaticCell<[[u32; LINE]; scene::LINES]> = ConstStaticCell::new([[0; LINE]; scene::LINES]);
static MEMORY: ConstStaticCell<[u32; PIPELINE]> = ConstStaticCell::new([0; PIPELINE]);
static BUFFER: ConstStaticCell<ChunkBuffer> = ConstStaticCell::new(ChunkBuffer::new());

#[cortex_m_rt::entry]
fn main() -> ! {
    let (Some(mut core), Some(ring)) = (cortex_m::Peripherals::take(), RING.try_take()) else {
        exit::failure()
    };
    let (Some(memory), Some(buffer)) = (MEMORY.try_take(), BUFFER.try_take()) else { exit::failure() };
    rig::prioritize(&mut core.NVIC);
    scene::lines(&SOBEL, buffer, ring.each_mut().map(|line| &mut line[..]), memory);
    exit::success()
}
