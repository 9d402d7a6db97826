//! Overruns and bus errors, put in on purpose at each request that the DMA makes of the bus.

use std::cell::{Cell, RefCell};

use super::super::config::Policy;
use super::super::frame_plan;
use super::*;
use crate::camif::Hold;
use crate::camif::registers::Burst;

const LINE: usize = 16;
const LINES: usize = 8;
const FRAMES: usize = 8;

/// What happened in a run.
#[derive(Default)]
struct Outcomes {
    /// Sequence numbers of the frames received, all of which are as they were sent.
    received: Vec<u32>,
    /// The frames on the wires at the first and the last overrun.
    overrun: Option<(usize, usize)>,
    requests: u64,
    dma_errors: u32,
}

fn run(config: &Config, wires: Wires, part: Part, bus: Bus, latency: usize) -> Outcomes {
    let (outcomes, number, seen) = (RefCell::new(Outcomes::default()), Cell::new(0), Cell::new(0));
    let room = frame_plan(config, part.transfer_limit).unwrap().room() as usize;
    with_camera::<3>(part, bus, room, |model, camera| {
        camera.start(config).unwrap();
        let handler = || {
            camera.on_interrupt();
            let mut outcomes = outcomes.borrow_mut();
            while let Some(frame) = camera.try_frame() {
                let sequence = frame.verdict().sequence;
                assert!(frame.verdict().outcome.is_good());
                let sent = (0..FRAMES).find(|&number| *frame == *picture(number, LINE, LINES).concat());
                let fits = sent == Some(sequence as usize);
                assert!(
                    fits,
                    "frame {sequence} is {sent:?}, latency {latency}, {bus:?}, {:?}",
                    frame.verdict()
                );
                outcomes.received.push(sequence);
            }
            let overruns = camera.statistics().overruns;
            if overruns > seen.replace(overruns) {
                outcomes.overrun.get_or_insert((number.get(), 0)).1 = number.get();
            }
        };
        let mut sender = Sender::new(model, &handler, wires);
        sender.latency = latency;
        for index in 0..FRAMES {
            number.set(index);
            sender.frame(&picture(index, LINE, LINES));
        }
        sender.close();
        outcomes.borrow_mut().requests = model.borrow().requests();
        outcomes.borrow_mut().dma_errors = camera.statistics().dma_errors;
    });
    outcomes.into_inner()
}

#[test]
fn an_overrun_at_any_word_costs_no_more_than_two_frames() {
    let mut overruns = 0;
    for part in [Part::CAMIF, Part::STM32F4] {
        for wires in ALL_WIRES.into_iter().filter(|&wires| part.marker || wires != Wires::Marker) {
            for burst in [Burst::One, Burst::Two, Burst::Four] {
                for policy in [Policy::NewestWins, Policy::InOrder] {
                    let config =
                        Config { burst, policy, ..Config::new(wires.mode(), LINE as u32, LINES as u32) };
                    let clean = run(&config, wires, part, Bus::IDEAL, 0);
                    assert_eq!(clean.received.len(), FRAMES);
                    for request in 0..clean.requests {
                        let bus = Bus { hold: Some(Hold { request, clocks: 100 }), ..Bus::IDEAL };
                        let held = run(&config, wires, part, bus, 0);
                        let context = format!(
                            "{} {wires:?} {burst:?} request {request}: {:?}",
                            part.name, held.received
                        );
                        let Some((first, last)) = held.overrun else {
                            assert_eq!(held.received.len(), FRAMES, "{context}");
                            continue;
                        };
                        overruns += 1;
                        let lost: Vec<u32> =
                            (0..FRAMES as u32).filter(|k| !held.received.contains(k)).collect();
                        let context = format!("{context}, lost {lost:?} at {first} to {last}");
                        // The frame after the last overrun is whole again, two VSYNCs later at most. The frame before
                        // the first is lost if its last words were still in the FIFO.
                        assert!(lost.len() <= 2, "{context}");
                        assert!(
                            lost.iter().all(|&k| (first..=last + 1).contains(&(k as usize + 1))),
                            "{context}"
                        );
                    }
                }
            }
        }
    }
    assert!(overruns > 1000, "only {overruns} overruns were provoked");
}

#[test]
fn a_bus_error_at_any_burst_costs_no_more_than_two_frames() {
    for part in [Part::CAMIF, Part::STM32F4] {
        for wires in ALL_WIRES.into_iter().filter(|&wires| part.marker || wires != Wires::Marker) {
            for policy in [Policy::NewestWins, Policy::InOrder] {
                let config = Config { policy, ..Config::new(wires.mode(), LINE as u32, LINES as u32) };
                let requests = run(&config, wires, part, Bus::IDEAL, 0).requests;
                for request in 0..requests {
                    let bus = Bus { error: Some(request), ..Bus::IDEAL };
                    let Outcomes { received, dma_errors, overrun, .. } = run(&config, wires, part, bus, 0);
                    let context = format!("{} {wires:?} {policy:?} request {request}", part.name);
                    assert_eq!((dma_errors, overrun), (1, None), "{context}");
                    assert!(received.len() + 2 >= FRAMES, "{context}: {received:?}");
                    let last = request < requests * (FRAMES as u64 - 2) / FRAMES as u64;
                    assert!(!last || received.ends_with(&[FRAMES as u32 - 1]), "{context}: {received:?}");
                }
            }
        }
    }
}

#[test]
fn overruns_that_are_served_late_tear_nothing() {
    for wires in ALL_WIRES {
        for latency in [1, 3, 7, 15, 31, 60, 63, 64, 65, 90, 100, 110, 127] {
            let config = Config::new(wires.mode(), LINE as u32, LINES as u32);
            for request in 0..40 {
                let bus = Bus { hold: Some(Hold { request, clocks: 100 }), ..Bus::IDEAL };
                // Each frame received is compared in `run`; how many there are depends on how late the service is.
                let outcomes = run(&config, wires, Part::CAMIF, bus, latency);
                assert!(outcomes.received.is_sorted());
                if latency < 30 {
                    assert!(
                        outcomes.received.len() >= FRAMES - 3,
                        "{wires:?} {latency} {request}: {:?}",
                        outcomes.received
                    );
                }
            }
        }
    }
}

#[test]
fn an_overrun_while_frames_are_taken_one_by_one() {
    for part in [Part::CAMIF, Part::STM32F4] {
        let config = Config { policy: Policy::Snapshot, ..Config::new(GATED, LINE as u32, LINES as u32) };
        for request in 0..20 {
            let bus = Bus { hold: Some(Hold { request, clocks: 100 }), ..Bus::IDEAL };
            with_camera::<1>(part, bus, LINE * LINES / 4, |model, camera| {
                camera.start(&config).unwrap();
                camera.trigger();
                let handler = || camera.on_interrupt();
                let mut sender = Sender::new(model, &handler, Wires::Gated);
                let mut received = vec![];
                for number in 0..6 {
                    sender.frame(&picture(number, LINE, LINES));
                    if let Some(frame) = camera.try_frame() {
                        assert_eq!(*frame, *picture(number, LINE, LINES).concat());
                        received.push(number);
                    }
                }
                assert_eq!(received.len(), 1, "one was asked for, one comes");
                assert!(received[0] <= 1, "the next frame after the overrun");
            });
        }
    }
}
