//! Every fault that the driver recovers from, one after the other, and a check that it has.
#![no_std]
#![no_main]

use exercise::replay::faults::FAULTS;
use exercise::replay::scenario::{SMALL_SIZE, frame_words, line_words};
use firmware::trace::ChunkBuffer;
use mps2::{exit, rig, scene};
use static_cell::ConstStaticCell;

const LINE: usize = line_words(SMALL_SIZE.0);
const WORDS: usize = frame_words(SMALL_SIZE);

static MEMORY: ConstStaticCell<[[u32; WORDS]; scene::FRAMES]> =
    ConstStaticCell::new([[0; WORDS]; scene::FRAMES]);
static RING: ConstStaticCell<[[u32; LINE]; scene::LINES]> = ConstStaticCell::new([[0; LINE]; scene::LINES]);
static BUFFERS: ConstStaticCell<[ChunkBuffer; FAULTS.len()]> =
    ConstStaticCell::new([const { ChunkBuffer::new() }; FAULTS.len()]);

#[cortex_m_rt::entry]
fn main() -> ! {
    let (Some(mut core), Some(memory)) = (cortex_m::Peripherals::take(), MEMORY.try_take()) else {
        exit::failure()
    };
    rig::prioritize(&mut core.NVIC);
    let (Some(buffers), Some(ring)) = (BUFFERS.try_take(), RING.try_take()) else { exit::failure() };
    let mut memory = memory.each_mut().map(|frame| Some(&mut frame[..]));
    let mut ring = ring.each_mut().map(|line| Some(&mut line[..]));
    let mut failed = 0_u32;
    for (scenario, buffer) in FAULTS.iter().zip(buffers) {
        let good;
        if scenario.lines {
            (ring, good) = scene::lines(scenario, buffer, ring);
        } else {
            (memory, good) = scene::frames(scenario, buffer, memory);
        }
        failed += u32::from(!good);
    }
    if failed == 0 { exit::success() } else { exit::failure() }
}
