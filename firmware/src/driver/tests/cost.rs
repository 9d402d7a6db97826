//! What the handler costs: how often it is called, and how many accesses to the block and the DMA it makes.

use std::cell::Cell;

use super::super::config::Policy;
use super::super::engine::POLLS;
use super::*;
use crate::camif::Hold;
use crate::port::{Dma, DmaError, DmaEvents, Port, Register, Registers, Target, Transfer};

/// A port that counts accesses.
struct Counted<'c, 'm> {
    model: Model<'c, 'm>,
    accesses: &'c Cell<u32>,
}

impl<'c, 'm> Counted<'c, 'm> {
    fn model(&mut self) -> &mut Model<'c, 'm> {
        self.accesses.set(self.accesses.get() + 1);
        &mut self.model
    }
}

impl Registers for Counted<'_, '_> {
    fn read(&mut self, register: Register) -> u32 {
        self.model().read(register)
    }
    fn write(&mut self, register: Register, value: u32) {
        self.model().write(register, value);
    }
}

impl<'m> Dma<'m> for Counted<'_, 'm> {
    fn lend(&mut self, slot: usize, memory: &'m mut [u32]) -> Result<(), &'m mut [u32]> {
        self.model().lend(slot, memory)
    }
    fn take_back(&mut self, slot: usize) -> Option<&'m mut [u32]> {
        self.model().take_back(slot)
    }
    fn aim(&mut self, target: Target, slot: usize, start: usize) -> Result<(), DmaError> {
        self.model().aim(target, slot, start)
    }
    fn start(&mut self, transfer: Transfer) -> Result<(), DmaError> {
        self.model().start(transfer)
    }
    fn stop(&mut self) {
        self.model().stop();
    }
    fn events(&mut self) -> DmaEvents {
        self.model().events()
    }
    fn acknowledge(&mut self, events: DmaEvents) {
        self.model().acknowledge(events);
    }
    fn target(&mut self) -> Target {
        self.model().target()
    }
    fn remaining(&mut self) -> u32 {
        self.model().remaining()
    }
}

impl<'m> Port<'m> for Counted<'_, 'm> {
    fn part(&self) -> Part {
        Port::part(&self.model)
    }
}

/// Calls of the handler and the most accesses of one call, over some frames of 40 lines.
fn cost(config: &Config, part: Part, bus: Bus, wires: Wires) -> (u32, u32) {
    let mut memory = vec![0; 3 * 320];
    let mut chunks = memory.chunks_exact_mut(320);
    let buffers: [&mut [u32]; 3] = core::array::from_fn(|_| chunks.next().unwrap());
    let (accesses, calls, most) = (Cell::new(0), Cell::new(0), Cell::new(0));
    let model = RefCell::new(Camif::new(part, bus));
    let camera = FrameCamera::new(Counted { model: &model, accesses: &accesses }, buffers).unwrap();
    camera.start(config).unwrap();
    let handler = || {
        accesses.set(0);
        camera.on_interrupt();
        calls.set(calls.get() + 1);
        most.set(most.get().max(accesses.get()));
        drop(camera.try_frame());
    };
    let mut sender = Sender::new(&model, &handler, wires);
    for number in 0..4 {
        sender.frame(&picture(number, 32, 40));
    }
    sender.close();
    (calls.get(), most.get())
}

#[test]
fn line_interrupts_can_be_left_off() {
    for (wires, part) in [(Wires::Marker, Part::CAMIF), (Wires::Gated, Part::STM32F4)] {
        let config = Config::new(wires.mode(), 32, 40);
        let (with, _) = cost(&config, part, Bus::IDEAL, wires);
        let (without, _) = cost(&Config { line_interrupts: false, ..config }, part, Bus::IDEAL, wires);
        // Two transfers and the frame's end for each of four frames; an end and a transfer may share a call.
        assert!(without <= 12, "{without} calls");
        assert!((4 * 39..=4 * 43).contains(&with), "{with} calls");
    }
}

#[test]
fn a_call_makes_a_bounded_number_of_accesses() {
    for (wires, part) in
        [(Wires::Marker, Part::CAMIF), (Wires::Gated, Part::CAMIF), (Wires::Gated, Part::STM32F4)]
    {
        for policy in [Policy::NewestWins, Policy::InOrder] {
            let config = Config { policy, ..Config::new(wires.mode(), 32, 40) };
            let (_, clean) = cost(&config, part, Bus::IDEAL, wires);
            let most = (0..80).map(|request| {
                let bus = Bus { hold: Some(Hold { request, clocks: 100 }), ..Bus::IDEAL };
                cost(&config, part, bus, wires).1
            });
            let most = most.max().unwrap_or(0);
            // Without counters the handler watches the FIFO drain after a frame, for as long as the bus stalls.
            let bound = if part.counters { 16 } else { 4 * POLLS };
            assert!(clean <= 12 && most <= bound, "{} {wires:?}: {clean}, with overruns {most}", part.name);
        }
    }
}
