//! A device on a serial line: a trace plays again and again into the block, frames leave over UART 0, commands come in.
#![no_std]
#![no_main]

use core::convert::Infallible;

use exercise::replay::consumer::END;
use exercise::replay::scenario::{STREAM, STREAM_SIZE, frame_words};
use firmware::driver::{Frame, FrameCamera};
use firmware::link::packet::{Level, Meaning};
use firmware::link::{Format, SendError};
use firmware::station::{Identity, Memory, Order, Picture, Stages, Station};
use firmware::trace::ChunkBuffer;
use mps2::rig::{OnBlock, Recording};
use mps2::uart::Uart;
use mps2::{exit, rig, scene, uptime};
use static_cell::ConstStaticCell;

const WORDS: usize = frame_words(STREAM_SIZE);
/// Frame buffers: one that fills, one that is sent, one that is held for lines that are asked for again.
const FRAMES: usize = 3;
/// Words of the stages, whatever they are.
const VISION: usize = Stages::memory(STREAM_SIZE.0 as usize, STREAM_SIZE.1 as usize);
/// What is told of the stack whenever capture stops.
const STACK: &str = "stack high-water mark, bytes";
/// Milliseconds from frame to frame, at first.
const PERIOD: u16 = 100;

static FRAMES_MEMORY: ConstStaticCell<[[u32; WORDS]; FRAMES]> = ConstStaticCell::new([[0; WORDS]; FRAMES]);
static VISION_MEMORY: ConstStaticCell<[u32; VISION]> = ConstStaticCell::new([0; VISION]);
static BUFFER: ConstStaticCell<ChunkBuffer> = ConstStaticCell::new(ChunkBuffer::new());
static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::new());

#[cortex_m_rt::entry]
fn main() -> ! {
    let (Some(mut core), Some(frames)) = (cortex_m::Peripherals::take(), FRAMES_MEMORY.try_take()) else {
        exit::failure()
    };
    let (Some(vision), Some(buffer)) = (VISION_MEMORY.try_take(), BUFFER.try_take()) else { exit::failure() };
    let Some(memory) = MEMORY.try_take() else { exit::failure() };
    rig::prioritize(&mut core.NVIC);
    rig::install(STREAM.bus);
    uptime::start();
    let Ok(camera) = FrameCamera::new(rig::port(), frames.each_mut().map(|frame| &mut frame[..])) else {
        exit::failure()
    };
    let picture = Picture {
        name: "raw",
        width: STREAM_SIZE.0 as u16,
        height: STREAM_SIZE.1 as u16,
        format: Format::RGB888,
        meaning: Meaning::default(),
    };
    let session = uptime::microseconds() as u32 | 1;
    let mut station = Station::new(
        (Uart::start(), memory, &mut vision[..]),
        (OnBlock, picture, PERIOD),
        Identity { name: concat!("camif qemu_stream ", env!("CARGO_PKG_VERSION")), session, baud: 0 },
        uptime::microseconds,
    );
    sent(station.announce());
    let mut held: Option<Frame<'_, 'static, Recording, FRAMES>> = None;
    let (mut due, mut buffer) = (0, Some(buffer));
    loop {
        let Some(memory) = buffer.take() else { exit::failure() };
        let ((), player) = rig::play(scene::player(&STREAM, memory), &camera, || {
            let mut now = 0;
            while now != END {
                station.tell(
                    camera.statistics(),
                    station.control.is_capturing().then(|| camera.diagnose().cause),
                );
                sent(station.serve());
                match station.control.take_order() {
                    Some(Order::Start) => {
                        held = None;
                        if camera.start(&STREAM.config()).is_err() {
                            sent(station.log(Level::Error, format_args!("capture does not start")));
                        }
                    }
                    Some(Order::Stop) => {
                        camera.stop();
                        let used = mps2::stack::high_water();
                        sent(station.log(Level::Information, format_args!("{STACK} {used}")));
                    }
                    None => {}
                }
                if let Some(frame) = &held {
                    sent(station.send_again(frame.bytes()));
                }
                if !station.control.is_capturing() || uptime::microseconds() < due {
                    cortex_m::asm::wfi();
                    continue;
                }
                now = rig::sleep(now);
                if let Some(frame) = camera.try_frame() {
                    due = uptime::microseconds() + 1_000 * u64::from(station.control.period_ms());
                    drop(held.take());
                    sent(station.frame(frame.bytes(), frame.verdict()));
                    held = Some(frame);
                }
            }
        });
        buffer = player.map(|player| player.into_buffer());
    }
}

/// The line takes everything; only a packet that is too long fails, and none is.
fn sent(result: Result<(), SendError<Infallible>>) {
    if result.is_err() {
        defmt::error!("a packet is too long");
        exit::failure()
    }
}
