//! What the host makes of a scenario, in the very words in which the images tell it.

use std::cell::RefCell;

use algos_nostd::quantize::Probe;
use anyhow::{Result, anyhow};
use exercise::replay::check::Check;
use exercise::replay::consumer::{self, END, Told, Work};
use exercise::replay::player::{Clocked, Player, Tick};
use exercise::replay::record::{Record, Recorded};
use exercise::replay::scenario::{COLORS, Scenario, frame_words, line_words};
use firmware::camif::pins::{Samples, Sync};
use firmware::camif::{Bus, Camif, Part};
use firmware::driver::{FrameCamera, LineCamera};
use firmware::pipeline::Pipeline;
use firmware::trace::ChunkBuffer;

use super::traces;

/// The block, and its handler as an interrupt controller calls it.
struct Block<'a, 'm, F: FnMut()> {
    camif: &'a RefCell<Camif<'m>>,
    handler: F,
    masked: bool,
    pending: bool,
}

impl<F: FnMut()> Clocked for Block<'_, '_, F> {
    fn run(&mut self, sync: Sync, samples: Samples<'_>) -> (usize, bool) {
        let mut camif = self.camif.borrow_mut();
        let played = camif.run(sync, samples);
        (played, camif.interrupts().any())
    }

    fn interrupt(&mut self) {
        self.pending = true;
        self.mask(self.masked);
    }

    fn mask(&mut self, masked: bool) {
        self.masked = masked;
        if !masked && std::mem::take(&mut self.pending) {
            (self.handler)();
        }
    }

    fn change_bus(&mut self, bus: Bus) -> Bus {
        std::mem::replace(self.camif.borrow_mut().bus_mut(), bus)
    }
}

/// What is told of a scenario, and held to what is to come of it.
///
/// # Errors
/// If there is no such trace, the driver refuses to start, or something else comes of it.
pub fn fault(scenario: &Scenario) -> Result<Vec<String>> {
    let sent = traces::sent(scenario)?;
    let mut check = Check::new(scenario, &sent);
    let told = if scenario.lines {
        lines(scenario, Vision::None, &mut check)
    } else {
        frames(scenario, &mut check)
    }?;
    check.finish().map_err(|failure| anyhow!("{}: {failure} of\n{}", scenario.name, told.join("\n")))?;
    Ok(told)
}

/// What is told of whole frames.
///
/// # Errors
/// If there is no such trace, or the driver refuses to start.
pub fn frames(scenario: &Scenario, check: &mut Check<'_>) -> Result<Vec<String>> {
    let trace = traces::trace(scenario)?;
    let config = scenario.config();
    let mut memory: [Vec<u32>; 4] = std::array::from_fn(|_| vec![0; frame_words(scenario.size())]);
    let camif = RefCell::new(Camif::new(Part::CAMIF, scenario.bus));
    let record = RefCell::new(Record::new());
    let port = Recorded { port: &camif, log: &record };
    let camera = FrameCamera::new(port, memory.each_mut().map(Vec::as_mut_slice))?;
    camera.start(&config)?;
    let mut told = Vec::new();
    let mut tell = |what: Told| {
        check.note(&what);
        told.push(say(scenario, &what));
    };
    let idle = ticks(scenario, &trace, &camif, || camera.on_interrupt())?;
    consumer::frames(&camera, scenario, idle, &mut tell);
    told.extend(accesses(scenario, &record.borrow()));
    Ok(told)
}

/// Whether lines go through the scenario's pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vision {
    /// They don't.
    None,
    /// They do.
    Pipeline,
}

/// What is told of lines.
///
/// # Errors
/// As [`frames`].
pub fn lines(scenario: &Scenario, vision: Vision, check: &mut Check<'_>) -> Result<Vec<String>> {
    let trace = traces::trace(scenario)?;
    let config = scenario.config();
    let mut memory: [Vec<u32>; 4] = std::array::from_fn(|_| vec![0; line_words(scenario.size().0)]);
    let camif = RefCell::new(Camif::new(Part::CAMIF, scenario.bus));
    let record = RefCell::new(Record::new());
    let port = Recorded { port: &camif, log: &record };
    let camera = LineCamera::new(port, memory.each_mut().map(Vec::as_mut_slice))?;
    camera.start(&config)?;
    let mut probes = [Probe::EMPTY; COLORS.len()];
    let settings = scenario.settings(&mut probes);
    let mut lent = vec![0; settings.memory()];
    let mut pipeline = Pipeline::new(settings, &mut lent)?;
    let work = match vision {
        Vision::None => Work::Nothing,
        Vision::Pipeline => Work::Pipeline(&mut pipeline),
    };
    let mut told = Vec::new();
    let mut tell = |what: Told| {
        check.note(&what);
        told.push(say(scenario, &what));
    };
    let idle = ticks(scenario, &trace, &camif, || camera.on_interrupt())?;
    consumer::lines(&camera, scenario, work, idle, &mut tell);
    told.extend(accesses(scenario, &record.borrow()));
    Ok(told)
}

/// A tick a call: what a timer does on the boards.
fn ticks<'a>(
    scenario: &'a Scenario,
    trace: &'a [u8],
    camif: &'a RefCell<Camif<'_>>,
    handler: impl FnMut() + 'a,
) -> Result<impl FnMut() -> u64 + 'a> {
    let player = Player::new(trace, Box::new(ChunkBuffer::new()), scenario.disturbance.as_ref());
    let mut player = player.ok_or_else(|| anyhow!("the trace has no header"))?;
    let mut block = Block { camif, handler, masked: false, pending: false };
    let mut now = 0;
    Ok(move || {
        now += 1;
        match player.tick(&mut block) {
            Tick::Played => now,
            Tick::Ended | Tick::Broken => END,
        }
    })
}

/// The words of the images.
fn say(scenario: &Scenario, told: &Told) -> String {
    let name = scenario.name;
    match told {
        Told::Frame(number, outcome, checksum) => format!("{name}: frame {number} {outcome}, {checksum:08x}"),
        Told::Lost(damage) => format!("{name}: lost a frame: {damage}"),
        Told::Timeout(cause) => format!("{name}: nothing came: {cause}"),
        Told::Refused => format!("{name}: a line of another length"),
        Told::Total([delivered, dropped, lost, skipped, overruns]) => format!(
            "{name}: {delivered} delivered, {dropped} dropped, {lost} lost, {skipped} skipped, {overruns} overruns"
        ),
    }
}

fn accesses(scenario: &Scenario, record: &Record) -> Vec<String> {
    let name = scenario.name;
    let told = record
        .told(scenario)
        .iter()
        .map(|access| format!("{name}: {} {:x} {:08x}", access.kind.name(), access.place, access.value));
    let sum = format!("{name}: {} accesses, {:08x}", record.count, record.checksum());
    told.chain([sum]).collect()
}
