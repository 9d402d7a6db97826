//! Random configurations, senders with faults, slow buses, late handlers and consumers that hold frames: whatever comes,
//! no frame is torn, each is counted once, and no buffer is lost.

use std::cell::{Cell, RefCell};

use proptest::prelude::*;

use super::super::config::{Damaged, Policy};
use super::super::frame_plan;
use super::super::verdict::{Outcome, Verdict};
use super::*;
use crate::camif::Stall;
use crate::camif::registers::Burst;

/// What the sender does to a frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fault {
    None,
    ShortLine { line: usize, by: usize },
    LongLine { line: usize, by: usize },
    MissingLine { line: usize },
    ExtraLine,
}

impl Fault {
    fn apply(self, mut lines: Lines) -> Lines {
        let count = lines.len();
        match self {
            Self::None => {}
            // A frame without lines is no frame.
            Self::MissingLine { .. } if count == 1 => lines[0].push(1),
            Self::ShortLine { line, by } => {
                let line = &mut lines[line % count];
                // Two samples are the least that a marker leaves an edge between.
                line.truncate(line.len().saturating_sub(by).max(2));
            }
            Self::LongLine { line, by } => lines[line % count].extend((0..by).map(|x| x as u8 + 1)),
            Self::MissingLine { line } => drop(lines.remove(line % count)),
            Self::ExtraLine => lines.push(lines[0].clone()),
        }
        lines
    }
}

#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) config: Config,
    pub(super) wires: Wires,
    pub(super) part: Part,
    pub(super) bus: Bus,
    pub(super) latency: usize,
    pub(super) faults: Vec<Fault>,
    /// What the consumer does each time the handler has run: 0 takes, 1 drops the oldest, 2 the newest, else nothing.
    pub(super) consumer: Vec<u8>,
}

impl Case {
    /// The frames as they are on the wires.
    pub(super) fn sent(&self) -> Vec<Lines> {
        let (line_bytes, lines) = (self.config.line_clocks as usize, self.config.lines as usize);
        let frames = (0..).zip(&self.faults);
        frames.map(|(number, fault)| fault.apply(picture(number, line_bytes, lines))).collect()
    }
}

fn fault() -> impl Strategy<Value = Fault> {
    prop_oneof![
        6 => Just(Fault::None),
        1 => (0_usize..9, 1_usize..40).prop_map(|(line, by)| Fault::ShortLine { line, by }),
        1 => (0_usize..9, 1_usize..40).prop_map(|(line, by)| Fault::LongLine { line, by }),
        1 => (0_usize..9).prop_map(|line| Fault::MissingLine { line }),
        1 => Just(Fault::ExtraLine),
    ]
}

fn bus() -> impl Strategy<Value = Bus> {
    let stall = prop::option::weighted(0.3, (5_u32..60, 1_u32..90));
    (0_u32..4, 0_u32..6, stall, any::<u64>()).prop_map(|(least, spread, stall, seed)| Bus {
        latency_min: least,
        latency_max: least + spread,
        stall: stall.map(|(one_in, clocks)| Stall { one_in, clocks }),
        seed,
        ..Bus::IDEAL
    })
}

pub(super) fn case() -> impl Strategy<Value = Case> {
    let choice = (
        prop::sample::select(&ALL_WIRES[..]),
        prop::sample::select(&[Burst::One, Burst::Two, Burst::Four][..]),
        prop::sample::select(&[Policy::NewestWins, Policy::InOrder][..]),
        prop::sample::select(&[Damaged::Discard, Damaged::Deliver][..]),
        any::<bool>(),
        any::<bool>(),
    );
    let size = (1_u32..12, 1_u32..9);
    let rest =
        (bus(), 0_usize..24, prop::collection::vec(fault(), 4..14), prop::collection::vec(0_u8..6, 1..40));
    (choice, size, rest).prop_map(|(choice, (line_words, lines), (bus, latency, faults, consumer))| {
        let (wires, burst, policy, damaged, line_interrupts, counters) = choice;
        let part = if counters || wires == Wires::Marker { Part::CAMIF } else { Part::STM32F4 };
        let config = Config {
            burst,
            policy,
            damaged,
            line_interrupts,
            ..Config::new(wires.mode(), line_words * 4, lines)
        };
        Case { config, wires, part, bus, latency, faults, consumer }
    })
}

/// A frame that was handed out is what its verdict says it is.
fn check(case: &Case, sent: &[Lines], latency: usize, verdict: &Verdict, frame: &[u8]) {
    let mut bytes = sent[verdict.sequence as usize].concat();
    if !case.part.counters {
        // An incomplete word at the end does not reach memory, and without counters nothing tells of it.
        bytes.truncate(bytes.len() / 4 * 4);
    }
    let expected = case.config.geometry().bytes() as usize;
    match verdict.outcome {
        Outcome::Good => {
            assert_eq!(frame, bytes, "{verdict}");
            assert_eq!(verdict.bytes as usize, bytes.len());
        }
        Outcome::Short { .. } => {
            assert!(
                bytes.len() < expected && frame.len() == bytes.len() / 4 * 4,
                "{verdict} of {}",
                bytes.len()
            );
            assert_eq!(frame, &bytes[..frame.len()]);
        }
        Outcome::Long { .. } => {
            assert!(
                bytes.len() > expected && frame.len() == expected / 4 * 4,
                "{verdict} of {}",
                bytes.len()
            );
            assert_eq!(frame, &bytes[..frame.len()]);
        }
        Outcome::LineCount { .. } | Outcome::LineLength { .. } => {
            assert_eq!(frame, bytes, "{verdict}: in place, if not as configured");
        }
        outcome => panic!("{outcome} was handed out"),
    }
    // A handler that is later than a line may take the next one's length for it, and then is too strict.
    let lines = &sent[verdict.sequence as usize];
    let in_time = sent.iter().flatten().all(|line| line.len() > latency);
    if case.part.counters && case.config.line_interrupts {
        let even = lines.iter().all(|line| line.len() == case.config.line_clocks as usize);
        let good = even && lines.len() == case.config.lines as usize;
        let judged = verdict.outcome.is_good();
        assert!(judged == good || !in_time && !judged, "{verdict}");
    }
}

fn play<const N: usize>(case: &Case) {
    let sent = case.sent();
    // A handler that is later than a frame can't count frames.
    let shortest = sent.iter().map(|lines| lines.concat().len()).min().unwrap_or(0);
    let latency = case.latency.min(shortest / 4);
    let plan = frame_plan(&case.config, case.part.transfer_limit).unwrap();
    with_camera::<N>(case.part, case.bus, plan.room() as usize, |model, camera| {
        camera.start(&case.config).unwrap();
        let held = RefCell::new(Vec::new());
        let (step, last, overruns, dropped_before) =
            (Cell::new(0), Cell::new(None), Cell::new(0), Cell::new(0));
        let take = || {
            let frame = camera.try_frame()?;
            let sequence = frame.verdict().sequence;
            assert!(last.replace(Some(sequence)).is_none_or(|last| last < sequence), "out of order");
            check(case, &sent, latency, frame.verdict(), frame.bytes());
            overruns.set(overruns.get() + frame.verdict().overruns);
            dropped_before.set(dropped_before.get() + frame.verdict().dropped_before);
            Some(frame)
        };
        let handler = || {
            camera.on_interrupt();
            let index = step.get();
            step.set(index + 1);
            let mut held = held.borrow_mut();
            match case.consumer[index % case.consumer.len()] {
                0 => held.extend(take()),
                1 if !held.is_empty() => drop(held.remove(0)),
                2 => drop(held.pop()),
                _ => {}
            }
        };
        let mut sender = Sender::new(model, &handler, case.wires);
        sender.latency = latency;
        for frame in &sent {
            sender.frame(frame);
        }
        sender.close();
        for _ in 0..2 * N {
            model.borrow_mut().elapse(1000);
            camera.on_interrupt();
            held.borrow_mut().extend(take());
        }
        let statistics = camera.statistics();
        let taken = last.get().map_or(0, |last| last + 1);
        // The marker that ends the last frame starts another, which may be lost as well.
        let counted = camera.statistics().frames() as usize;
        let opened = usize::from(case.wires == Wires::Marker);
        assert!((sent.len()..=sent.len() + opened).contains(&counted), "{:?}", camera.statistics());
        assert_eq!(statistics.delivered + dropped_before.get(), taken, "gaps are told");
        assert!(overruns.get() <= statistics.overruns);
        held.borrow_mut().clear();
        camera.stop();
        assert_eq!(camera.shared.with(|state| state.machine.pool.free()), N, "a buffer is lost");
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn frames_are_whole_counted_once_and_no_buffer_is_lost(case in case(), buffers in 1_usize..5) {
        match buffers {
            1 => play::<1>(&case),
            2 => play::<2>(&case),
            3 => play::<3>(&case),
            _ => play::<4>(&case),
        }
    }
}
