//! A trace from the host through the block, its interrupt, the driver and the main loop: whole frames.
#![no_std]
#![no_main]

use exercise::replay::scenario::{FRAMES, SMALL_SIZE};
use firmware::trace::ChunkBuffer;
use mps2::{exit, rig, scene};
use static_cell::ConstStaticCell;

const WORDS: usize = (SMALL_SIZE.0 * SMALL_SIZE.1 * 3 / 4) as usize;

static MEMORY: ConstStaticCell<[[u32; WORDS]; scene::FRAMES]> =
    ConstStaticCell::new([[0; WORDS]; scene::FRAMES]);
static BUFFER: ConstStaticCell<ChunkBuffer> = ConstStaticCell::new(ChunkBuffer::new());

#[cortex_m_rt::entry]
fn main() -> ! {
    let (Some(mut core), Some(memory)) = (cortex_m::Peripherals::take(), MEMORY.try_take()) else {
        exit::failure()
    };
    rig::prioritize(&mut core.NVIC);
    let Some(buffer) = BUFFER.try_take() else { exit::failure() };
    scene::frames(&FRAMES, buffer, memory.each_mut().map(|frame| Some(&mut frame[..])));
    exit::success()
}
