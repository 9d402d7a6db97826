//! What the host makes of a scenario, in the very words in which the images tell it.

use std::cell::RefCell;

use anyhow::{Result, anyhow};
use exercise::replay::consumer::{self, END, Told};
use exercise::replay::player::{Clocked, Player, Tick};
use exercise::replay::record::{KEPT, Record, Recorded};
use exercise::replay::scenario::Scenario;
use firmware::camif::pins::{Samples, Sync};
use firmware::camif::{Camif, Part};
use firmware::driver::{FrameCamera, LineCamera};
use firmware::pipeline::Pipeline;
use firmware::trace::ChunkBuffer;

use super::traces;

/// Bus clocks that pass in a tick without a pixel clock.
struct Block<'a, 'm, F: FnMut()> {
    camif: &'a RefCell<Camif<'m>>,
    handler: F,
}

impl<F: FnMut()> Clocked for Block<'_, '_, F> {
    fn run(&mut self, sync: Sync, samples: Samples<'_>) -> (usize, bool) {
        let mut camif = self.camif.borrow_mut();
        let played = camif.run(sync, samples);
        (played, camif.interrupts().any())
    }

    fn interrupt(&mut self) {
        (self.handler)();
    }
}

/// What is told of whole frames.
///
/// # Errors
/// If there is no such trace, or the driver refuses to start.
pub fn frames(scenario: &Scenario) -> Result<Vec<String>> {
    let trace = traces::trace(scenario)?;
    let config = scenario.config();
    let words = firmware::driver::frame_plan(&config, u32::MAX).ok_or_else(|| anyhow!("no frame"))?.room();
    let mut memory: [Vec<u32>; 4] = std::array::from_fn(|_| vec![0; words as usize]);
    let camif = RefCell::new(Camif::new(Part::CAMIF, scenario.bus));
    let record = RefCell::new(Record::new());
    let port = Recorded { port: &camif, log: &record };
    let camera = FrameCamera::new(port, memory.each_mut().map(Vec::as_mut_slice))?;
    camera.start(&config)?;
    let mut told = Vec::new();
    let mut tell = |what: Told| told.push(say(scenario, &what));
    let patience = (scenario.patience, scenario.hoard);
    consumer::frames(&camera, patience, ticks(&trace, &camif, || camera.on_interrupt())?, &mut tell);
    told.extend(accesses(scenario, &record.borrow()));
    Ok(told)
}

/// What is told of lines through the pipeline.
///
/// # Errors
/// As [`frames`].
pub fn lines(scenario: &Scenario) -> Result<Vec<String>> {
    let trace = traces::trace(scenario)?;
    let config = scenario.config();
    let mut memory: [Vec<u32>; 4] = std::array::from_fn(|_| vec![0; config.geometry().line_words() as usize]);
    let camif = RefCell::new(Camif::new(Part::CAMIF, scenario.bus));
    let record = RefCell::new(Record::new());
    let port = Recorded { port: &camif, log: &record };
    let camera = LineCamera::new(port, memory.each_mut().map(Vec::as_mut_slice))?;
    camera.start(&config)?;
    let mut lent = vec![0; scenario.settings().memory()];
    let mut pipeline = Pipeline::new(scenario.settings(), &mut lent)?;
    let mut told = Vec::new();
    let mut tell = |what: Told| told.push(say(scenario, &what));
    let idle = ticks(&trace, &camif, || camera.on_interrupt())?;
    consumer::lines(&camera, scenario.patience, &mut pipeline, idle, &mut tell);
    told.extend(accesses(scenario, &record.borrow()));
    Ok(told)
}

/// A tick a call: what a timer does on the boards.
fn ticks<'a>(
    trace: &'a [u8],
    camif: &'a RefCell<Camif<'_>>,
    handler: impl FnMut() + 'a,
) -> Result<impl FnMut() -> u64 + 'a> {
    let player = Player::new(trace, Box::new(ChunkBuffer::new()));
    let mut player = player.ok_or_else(|| anyhow!("the trace has no header"))?;
    let mut block = Block { camif, handler };
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
        Told::Timeout(cause) => format!("{name}: nothing came: {cause}"),
        Told::Refused => format!("{name}: a line of another length"),
        Told::Total([delivered, dropped, lost, skipped, overruns]) => format!(
            "{name}: {delivered} delivered, {dropped} dropped, {lost} lost, {skipped} skipped, {overruns} overruns"
        ),
    }
}

fn accesses(scenario: &Scenario, record: &Record) -> Vec<String> {
    let name = scenario.name;
    let first = &record.first[..KEPT.min(record.count as usize)];
    let told = first
        .iter()
        .map(|access| format!("{name}: {} {:x} {:08x}", access.kind.name(), access.place, access.value));
    let sum = format!("{name}: {} accesses, {:08x}", record.count, record.checksum());
    told.chain([sum]).collect()
}
