//! Plays scenarios on the rig.

use core::ffi::CStr;

use exercise::replay::consumer;
use exercise::replay::player::Player;
use exercise::replay::scenario::Scenario;
use firmware::driver::{FrameCamera, LineCamera};
use firmware::pipeline::Pipeline;
use firmware::trace::ChunkBuffer;

use crate::file::Input;
use crate::rig::{self, Handler, Recording};
use crate::{exit, tell};

/// Line buffers of the line ring.
pub const LINES: usize = 4;
/// Frame buffers.
pub const FRAMES: usize = 4;

impl<const N: usize> Handler for FrameCamera<'static, Recording, N> {
    fn on_interrupt(&self) {
        self.on_interrupt();
    }
}

impl<const N: usize> Handler for LineCamera<'static, Recording, N> {
    fn on_interrupt(&self) {
        self.on_interrupt();
    }
}

/// Plays a scenario's trace, read into `buffer`.
pub fn player(
    scenario: &Scenario,
    buffer: &'static mut ChunkBuffer,
) -> Player<Input, &'static mut ChunkBuffer> {
    let mut name = [0; 40];
    let (text, suffix) = (scenario.name.as_bytes(), b".camt\0");
    for (to, from) in name.iter_mut().zip(text.iter().chain(suffix)) {
        *to = *from;
    }
    let source = CStr::from_bytes_until_nul(&name).map(Input::open);
    match source.ok().and_then(|source| Player::new(source, buffer)) {
        Some(player) => player,
        None => {
            defmt::error!("{=str} is no trace", scenario.name);
            exit::failure()
        }
    }
}

/// Memory for whole frames.
pub type FrameMemory = [Option<&'static mut [u32]>; FRAMES];

/// A scenario of whole frames; the memory comes back.
pub fn frames(scenario: &Scenario, buffer: &'static mut ChunkBuffer, memory: FrameMemory) -> FrameMemory {
    rig::install(scenario.bus);
    let memory = memory.map(Option::unwrap_or_default);
    let Ok(camera) = FrameCamera::new(rig::port(), memory) else { refused(scenario) };
    if camera.start(&scenario.config()).is_err() {
        refused(scenario);
    }
    let (mut now, settings) = (0, (scenario.patience, scenario.hoard));
    let idle = || {
        now = rig::sleep(now);
        now
    };
    let tell = &mut |told| tell::tell(scenario, &told);
    let _ = rig::play(player(scenario, buffer), &camera, || consumer::frames(&camera, settings, idle, tell));
    tell::accesses(scenario);
    camera.into_parts().1
}

/// A scenario of lines.
pub fn lines(
    scenario: &Scenario,
    buffer: &'static mut ChunkBuffer,
    ring: [&'static mut [u32]; LINES],
    memory: &'static mut [u32],
) {
    rig::install(scenario.bus);
    let Ok(mut pipeline) = Pipeline::new(scenario.settings(), memory) else { refused(scenario) };
    let Ok(camera) = LineCamera::new(rig::port(), ring) else { refused(scenario) };
    if camera.start(&scenario.config()).is_err() {
        refused(scenario);
    }
    let mut now = 0;
    let idle = || {
        now = rig::sleep(now);
        now
    };
    let tell = &mut |told| tell::tell(scenario, &told);
    let body = || consumer::lines(&camera, scenario.patience, &mut pipeline, idle, tell);
    let _ = rig::play(player(scenario, buffer), &camera, body);
    tell::accesses(scenario);
}

fn refused(scenario: &Scenario) -> ! {
    defmt::error!("{=str} is refused", scenario.name);
    exit::failure()
}
