//! Plays scenarios on the rig.

use core::ffi::CStr;

use algos_nostd::quantize::Probe;
use exercise::replay::check::Check;
use exercise::replay::consumer::{self, Told, Work};
use exercise::replay::player::Player;
use exercise::replay::scenario::{COLORS, MOST_FRAMES, Scenario};
use firmware::driver::{FrameCamera, LineCamera};
use firmware::pipeline::Pipeline;
use firmware::trace::ChunkBuffer;

use crate::file::{self, Input};
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

/// What `body` makes of the name of a scenario's file on the host.
fn file_of<R>(scenario: &'static Scenario, extension: &[u8], body: impl FnOnce(&CStr) -> R) -> R {
    let mut name = [0; 40];
    let parts = scenario.name.as_bytes().iter().chain(b".").chain(extension);
    // The last byte stays 0.
    for (to, from) in name.iter_mut().take(39).zip(parts) {
        *to = *from;
    }
    match CStr::from_bytes_until_nul(&name) {
        Ok(name) => body(name),
        Err(_) => refused(scenario),
    }
}

/// Plays a scenario's trace, read into `buffer`.
pub fn player(
    scenario: &'static Scenario,
    buffer: &'static mut ChunkBuffer,
) -> Player<'static, Input, &'static mut ChunkBuffer> {
    match Player::new(file_of(scenario, b"camt", Input::open), buffer, scenario.disturbance.as_ref()) {
        Some(player) => player,
        None => {
            defmt::error!("{=str} is no trace", scenario.name);
            exit::failure()
        }
    }
}

/// The checksums of the frames that the host's sensor sent, before any fault.
struct Sent([u32; MOST_FRAMES], usize);

impl Sent {
    fn read(scenario: &'static Scenario) -> Self {
        let (mut bytes, count) = ([[0; 4]; MOST_FRAMES], (scenario.frames as usize).min(MOST_FRAMES));
        if let Some(bytes) = bytes.get_mut(..count) {
            file_of(scenario, b"sent", |name| file::fill(name, bytes.as_flattened_mut()));
        }
        Self(bytes.map(u32::from_le_bytes), count)
    }

    fn check<'a>(&'a self, scenario: &'a Scenario) -> Check<'a> {
        Check::new(scenario, self.0.get(..self.1).unwrap_or_default())
    }
}

/// The outcome of a check, told if it is not as it is to be. True if it is.
fn checked(scenario: &'static Scenario, check: Check<'_>) -> bool {
    let result = check.finish();
    if let Err(failure) = &result {
        tell::failure(scenario, failure);
    }
    result.is_ok()
}

/// Memory for whole frames.
pub type FrameMemory = [Option<&'static mut [u32]>; FRAMES];

/// A scenario of whole frames; the memory comes back, and whether all came of it that was to.
pub fn frames(
    scenario: &'static Scenario,
    buffer: &'static mut ChunkBuffer,
    memory: FrameMemory,
) -> (FrameMemory, bool) {
    rig::install(scenario.bus);
    let sent = Sent::read(scenario);
    let mut check = sent.check(scenario);
    let memory = memory.map(Option::unwrap_or_default);
    let Ok(camera) = FrameCamera::new(rig::port(), memory) else { refused(scenario) };
    if camera.start(&scenario.config()).is_err() {
        refused(scenario);
    }
    let mut now = 0;
    let idle = || {
        now = rig::sleep(now);
        now
    };
    let tell = &mut |told| {
        check.note(&told);
        tell::tell(scenario, &told);
    };
    let _ = rig::play(player(scenario, buffer), &camera, || consumer::frames(&camera, scenario, idle, tell));
    tell::accesses(scenario);
    (camera.into_parts().1, checked(scenario, check))
}

/// Memory for the lines of a ring.
pub type LineMemory = [Option<&'static mut [u32]>; LINES];

/// A scenario of lines that go nowhere; the memory comes back, and whether all came of it that was to.
pub fn lines(
    scenario: &'static Scenario,
    buffer: &'static mut ChunkBuffer,
    ring: LineMemory,
) -> (LineMemory, bool) {
    let sent = Sent::read(scenario);
    let mut check = sent.check(scenario);
    let ring = play_lines(scenario, buffer, ring, Work::Nothing, |told| check.note(told));
    (ring, checked(scenario, check))
}

/// A scenario of lines through the pipeline.
pub fn vision(
    scenario: &'static Scenario,
    buffer: &'static mut ChunkBuffer,
    ring: LineMemory,
    memory: &'static mut [u32],
) {
    let mut probes = [Probe::EMPTY; COLORS.len()];
    let Ok(mut pipeline) = Pipeline::new(scenario.settings(&mut probes), memory) else { refused(scenario) };
    play_lines(scenario, buffer, ring, Work::Pipeline(&mut pipeline), |_| {});
}

fn play_lines(
    scenario: &'static Scenario,
    buffer: &'static mut ChunkBuffer,
    ring: LineMemory,
    work: Work<'_, '_>,
    mut note: impl FnMut(&Told),
) -> LineMemory {
    rig::install(scenario.bus);
    let Ok(camera) = LineCamera::new(rig::port(), ring.map(Option::unwrap_or_default)) else {
        refused(scenario)
    };
    if camera.start(&scenario.config()).is_err() {
        refused(scenario);
    }
    let mut now = 0;
    let idle = || {
        now = rig::sleep(now);
        now
    };
    let tell = &mut |told| {
        note(&told);
        tell::tell(scenario, &told);
    };
    let _ =
        rig::play(player(scenario, buffer), &camera, || consumer::lines(&camera, scenario, work, idle, tell));
    tell::accesses(scenario);
    camera.into_parts().1
}

fn refused(scenario: &'static Scenario) -> ! {
    defmt::error!("{=str} is refused", scenario.name);
    exit::failure()
}
