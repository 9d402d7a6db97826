//! A trace from the host through the block, its interrupt, the driver and the main loop: whole frames.
#![no_std]
#![no_main]

use exercise::replay::scenario::{FRAMES, SMALL_SIZE, frame_words};
use firmware::trace::ChunkBuffer;
use mps2::{exit, rig, scene};
use static_cell::ConstStaticCell;

const WORDS: usize = frame_words(SMALL_SIZE);

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
    let (_, good) = scene::frames(&FRAMES, buffer, memory.each_mut().map(|frame| Some(&mut frame[..])));
    if good { exit::success() } else { exit::failure() }
}
