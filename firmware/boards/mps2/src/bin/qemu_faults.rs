//! What goes wrong with a camera, one after the other, and what the driver makes of it.
#![no_std]
#![no_main]

use exercise::replay::scenario::{FAULTS, SMALL_SIZE};
use firmware::trace::ChunkBuffer;
use mps2::{exit, rig, scene};
use static_cell::ConstStaticCell;

const WORDS: usize = (SMALL_SIZE.0 * SMALL_SIZE.1 * 3 / 4) as usize;

static MEMORY: ConstStaticCell<[[u32; WORDS]; scene::FRAMES]> =
    ConstStaticCell::new([[0; WORDS]; scene::FRAMES]);
static BUFFERS: ConstStaticCell<[ChunkBuffer; FAULTS.len()]> =
    ConstStaticCell::new([const { ChunkBuffer::new() }; FAULTS.len()]);

#[cortex_m_rt::entry]
fn main() -> ! {
    let (Some(mut core), Some(memory)) = (cortex_m::Peripherals::take(), MEMORY.try_take()) else {
        exit::failure()
    };
    rig::prioritize(&mut core.NVIC);
    let Some(buffers) = BUFFERS.try_take() else { exit::failure() };
    let mut memory = memory.each_mut().map(|frame| Some(&mut frame[..]));
    for (scenario, buffer) in FAULTS.iter().zip(buffers) {
        memory = scene::frames(scenario, buffer, memory);
    }
    exit::success()
}
