//! Lines in, lines out.

use proptest::prelude::*;

use super::super::config::Crop;
use super::super::verdict::{Outcome, Verdict};
use super::super::{LineCamera, LineEvent};
use super::random::{Case, case};
use super::*;
use crate::camif::Hold;
use crate::camif::registers::Burst;

/// What came of the wires, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Seen {
    Line(u32, u32, Vec<u8>),
    End(Verdict),
}

/// A camera of `N` line buffers of `words` words, for the length of `body`.
fn with_lines<const N: usize>(
    part: Part,
    bus: Bus,
    words: usize,
    body: impl for<'c, 'm> FnOnce(Model<'c, 'm>, &LineCamera<'m, Model<'c, 'm>, N>),
) {
    let mut memory = vec![0; words * N];
    let mut chunks = memory.chunks_exact_mut(words);
    let buffers: [&mut [u32]; N] = core::array::from_fn(|_| chunks.next().unwrap());
    let model = RefCell::new(Camif::new(part, bus));
    let camera = LineCamera::new(&model, buffers).unwrap();
    body(&model, &camera);
}

/// Plays frames and takes every line as soon as it is there.
fn play(config: &Config, wires: Wires, part: Part, bus: Bus, frames: &[Lines]) -> (Vec<Seen>, u64, u32) {
    let seen = RefCell::new(vec![]);
    let (mut requests, mut overruns) = (0, 0);
    with_lines::<4>(part, bus, config.geometry().line_words() as usize, |model, camera| {
        camera.start(config).unwrap();
        let handler = || {
            camera.on_interrupt();
            while let Some(event) = camera.try_line() {
                seen.borrow_mut().push(match event {
                    LineEvent::Line(line) => Seen::Line(line.frame(), line.index(), line.to_vec()),
                    LineEvent::FrameEnd(verdict) => Seen::End(verdict),
                });
            }
        };
        let mut sender = Sender::new(model, &handler, wires);
        for frame in frames {
            sender.frame(frame);
        }
        sender.close();
        requests = model.borrow().requests();
        overruns = camera.statistics().overruns;
    });
    (seen.into_inner(), requests, overruns)
}

fn good(sequence: u32, line_bytes: u32, lines: u32) -> Seen {
    let (min_line_bytes, max_line_bytes, bytes) = (line_bytes, line_bytes, line_bytes * lines);
    Seen::End(Verdict { sequence, lines, min_line_bytes, max_line_bytes, bytes, ..Verdict::default() })
}

#[test]
fn every_line_arrives_in_order_and_then_the_end() {
    for wires in ALL_WIRES {
        for line_bytes in [16, 17, 4, 63] {
            for part in [Part::CAMIF, Part::STM32F4] {
                if !part.marker && (wires == Wires::Marker || line_bytes % 4 != 0) {
                    continue;
                }
                for line_interrupts in [true, false] {
                    let frames: Vec<Lines> = (0..4).map(|number| picture(number, line_bytes, 5)).collect();
                    let config =
                        Config { line_interrupts, ..Config::new(wires.mode(), line_bytes as u32, 5) };
                    let (seen, _, _) = play(&config, wires, part, Bus::IDEAL, &frames);
                    let mut expected = vec![];
                    for (sequence, frame) in (0..).zip(&frames) {
                        let lines = (0..).zip(frame);
                        expected.extend(lines.map(|(index, line)| Seen::Line(sequence, index, line.clone())));
                        expected.push(good(sequence, line_bytes as u32, 5));
                    }
                    assert_eq!(seen, expected, "{wires:?} {} {line_bytes} {line_interrupts}", part.name);
                }
            }
        }
    }
}

#[test]
fn a_crop_window_line_by_line() {
    let crop = Some(Crop { first_clock: 2, clocks: 8, first_line: 1, lines: 3 });
    let config = Config { crop, ..Config::new(GATED, 16, 6) };
    for part in [Part::CAMIF, Part::STM32F4] {
        let frames: Vec<Lines> = (0..3).map(|number| picture(number, 16, 6)).collect();
        let (seen, _, _) = play(&config, Wires::Gated, part, Bus::IDEAL, &frames);
        let mut expected = vec![];
        for (sequence, frame) in (0..).zip(&frames) {
            let lines = (0..).zip(&frame[1..4]);
            expected.extend(lines.map(|(index, line)| Seen::Line(sequence, index, line[2..10].to_vec())));
            expected.push(good(sequence, 8, 3));
        }
        assert_eq!(seen, expected, "{}", part.name);
    }
}

/// Outcomes of the frames' ends.
fn outcomes(seen: &[Seen]) -> Vec<(u32, Outcome)> {
    let end = |seen: &Seen| match seen {
        Seen::End(verdict) => Some((verdict.sequence, verdict.outcome)),
        Seen::Line(..) => None,
    };
    seen.iter().filter_map(end).collect()
}

#[test]
fn a_short_or_long_line_is_named_and_the_next_frame_is_whole() {
    for (change, bytes) in [(-3_i32, 61), (5, 69)] {
        let mut frames: Vec<Lines> = (0..5).map(|number| picture(number, 16, 4)).collect();
        frames[1][2].resize((16 + change) as usize, 0x77);
        let outcome =
            if change < 0 { Outcome::Short { expected: 64 } } else { Outcome::Long { expected: 64 } };
        for wires in ALL_WIRES {
            let config = Config::new(wires.mode(), 16, 4);
            let (seen, _, _) = play(&config, wires, Part::CAMIF, Bus::IDEAL, &frames);
            let expected: Vec<_> =
                (0..5).map(|number| (number, if number == 1 { outcome } else { Outcome::Good })).collect();
            assert_eq!(outcomes(&seen), expected, "{wires:?}: line by line no other line is touched");
            let lines: Vec<&Vec<u8>> = seen
                .iter()
                .filter_map(|it| if let Seen::Line(1, _, line) = it { Some(line) } else { None })
                .collect();
            assert_eq!(*lines[3], frames[1][3]);
            assert_eq!(lines[2][..], frames[1][2][..frames[1][2].len().min(16)]);
            let end = seen.iter().find_map(|it| match it {
                Seen::End(verdict) if verdict.sequence == 1 => Some(verdict),
                _ => None,
            });
            assert_eq!(end.unwrap().bytes, bytes);
        }
        let (seen, _, _) = play(&Config::new(GATED, 16, 4), Wires::Gated, Part::STM32F4, Bus::IDEAL, &frames);
        let names = outcomes(&seen);
        assert!(matches!(names[1].1, Outcome::Short { .. } | Outcome::Long { .. }), "{names:?}");
        assert_eq!(names[2..], [(2, Outcome::Good), (3, Outcome::Good), (4, Outcome::Good)], "started anew");
    }
}

#[test]
fn an_overrun_at_any_word_tears_no_line() {
    let mut overruns_seen = 0;
    for part in [Part::CAMIF, Part::STM32F4] {
        for wires in ALL_WIRES.into_iter().filter(|&wires| part.marker || wires != Wires::Marker) {
            for burst in [Burst::One, Burst::Two, Burst::Four] {
                let frames: Vec<Lines> = (0..5).map(|number| picture(number, 32, 4)).collect();
                let config = Config { burst, ..Config::new(wires.mode(), 32, 4) };
                let (_, requests, _) = play(&config, wires, part, Bus::IDEAL, &frames);
                for request in 0..requests {
                    let bus = Bus { hold: Some(Hold { request, clocks: 60 }), ..Bus::IDEAL };
                    let (seen, _, overruns) = play(&config, wires, part, bus, &frames);
                    overruns_seen += overruns;
                    let context = format!("{} {wires:?} {burst:?} request {request}", part.name);
                    let mut next = (0, 0);
                    for it in &seen {
                        if let Seen::Line(frame, index, line) = it {
                            assert_eq!(*line, frames[*frame as usize][*index as usize], "{context}");
                            assert!((*frame, *index) >= next, "{context}");
                            next = (*frame, index + 1);
                        }
                    }
                    let whole = outcomes(&seen).iter().filter(|(_, outcome)| outcome.is_good()).count();
                    assert!(whole >= if overruns > 0 { 3 } else { 5 }, "{context}: {:?}", outcomes(&seen));
                }
            }
        }
    }
    assert!(overruns_seen > 300, "only {overruns_seen} overruns were provoked");
}

#[test]
fn lines_without_a_buffer_are_dropped_and_counted() {
    with_lines::<4>(Part::CAMIF, Bus::IDEAL, 4, |model, camera| {
        camera.start(&Config::new(MARKER, 16, 6)).unwrap();
        let handler = || camera.on_interrupt();
        let mut sender = Sender::new(model, &handler, Wires::Marker);
        for number in 0..3 {
            sender.frame(&picture(number, 16, 6));
        }
        // Two lines were kept, two buffers are with the DMA.
        let mut kept = vec![];
        while let Some(event) = camera.try_line() {
            match event {
                LineEvent::Line(line) => kept.push((line.frame(), line.index())),
                LineEvent::FrameEnd(verdict) => {
                    assert_eq!(verdict.outcome, Outcome::LinesDropped { lines: 4 });
                    assert_eq!((verdict.lines, verdict.sequence), (6, 0));
                }
            }
        }
        assert_eq!(kept, [(0, 0), (0, 1)]);
        for number in 3..5 {
            sender.frame(&picture(number, 16, 6));
        }
        sender.close();
        let statistics = camera.statistics();
        assert_eq!(statistics.frames(), 5, "{statistics:?}");
        assert!(statistics.lines_dropped > 10 && statistics.dropped >= 4);
    });
}

/// VGA in RGB888 within 8 KiB, buffers and driver together.
#[test]
fn vga_takes_eight_kibibytes() {
    const WORDS: usize = 640 * 3 / 4;
    let buffers = 4 * WORDS * size_of::<u32>();
    let driver = size_of::<LineCamera<'_, Model<'_, '_>, 4>>();
    assert!(buffers + driver <= 8192, "{buffers} bytes of buffers and {driver} of driver");
    with_lines::<4>(Part::CAMIF, Bus::IDEAL, WORDS, |model, camera| {
        camera.start(&Config::new(MARKER, 1920, 480)).unwrap();
        let lines = RefCell::new(0);
        let frame = picture(0, 1920, 480);
        let handler = || {
            camera.on_interrupt();
            while let Some(event) = camera.try_line() {
                match event {
                    LineEvent::Line(line) => {
                        assert_eq!(*line, *frame[line.index() as usize]);
                        *lines.borrow_mut() += 1;
                    }
                    LineEvent::FrameEnd(verdict) => assert_eq!(verdict.outcome, Outcome::Good),
                }
            }
        };
        let mut sender = Sender::new(model, &handler, Wires::Marker);
        sender.frame(&frame);
        sender.frame(&frame);
        sender.close();
        assert_eq!((lines.take(), camera.statistics().delivered), (960, 2));
    });
}

/// Plays a random case; each line that comes is one that was sent, and a good end follows all lines of its frame.
fn play_case(case: &Case) {
    let sent = case.sent();
    let width = case.config.line_clocks as usize;
    let shortest = sent.iter().flatten().map(Vec::len).min().unwrap_or(0);
    with_lines::<5>(case.part, case.bus, width.div_ceil(4), |model, camera| {
        camera.start(&case.config).unwrap();
        let (step, next, held) = (RefCell::new(0), RefCell::new((0, 0)), RefCell::new(vec![]));
        // Lines of each frame that came.
        let came = RefCell::new(vec![0; sent.len()]);
        let take = || {
            let event = camera.try_line()?;
            match &event {
                LineEvent::Line(line) => {
                    let (frame, index) = (line.frame() as usize, line.index() as usize);
                    assert!(next.replace((frame, index + 1)) <= (frame, index), "out of order");
                    came.borrow_mut()[frame] += 1;
                    // Where lines are packed, one of another length shifts those after it.
                    let whole = sent[frame].iter().all(|line| line.len() == width);
                    if case.part.line_by_line {
                        let line_sent = &sent[frame][index];
                        // Unless a line is measured before the next one ends, its padding counts as line.
                        let padded = 3;
                        let sent_bytes = line_sent.len().min(line.len());
                        assert_eq!(line[..sent_bytes], line_sent[..sent_bytes]);
                        assert!(line.len() <= width && line.len() <= sent_bytes + padded);
                    } else if whole {
                        assert_eq!(**line, sent[frame][index]);
                    }
                }
                LineEvent::FrameEnd(verdict) => {
                    let frame = verdict.sequence as usize;
                    assert!(next.replace((frame + 1, 0)).0 <= frame, "the end comes after its lines");
                    if verdict.outcome.is_good() {
                        assert_eq!(came.borrow()[frame], case.config.lines as usize, "{verdict}");
                        assert_eq!(verdict.bytes as usize / 4, sent[frame].concat().len() / 4, "{verdict}");
                    }
                }
            }
            Some(event)
        };
        let handler = || {
            camera.on_interrupt();
            let index = step.replace_with(|step| *step + 1);
            let mut held = held.borrow_mut();
            match case.consumer[index % case.consumer.len()] {
                0 => held.extend(take()),
                1 if !held.is_empty() => drop(held.remove(0)),
                2 => drop(held.pop()),
                3 => while take().is_some() {},
                _ => {}
            }
        };
        let mut sender = Sender::new(model, &handler, case.wires);
        sender.latency = case.latency.min(shortest / 3);
        for frame in &sent {
            sender.frame(frame);
        }
        sender.close();
        while take().is_some() {}
        // The marker that ends the last frame starts another, which may be lost as well.
        let counted = camera.statistics().frames() as usize;
        let opened = usize::from(case.wires == Wires::Marker);
        assert!((sent.len()..=sent.len() + opened).contains(&counted), "{:?}", camera.statistics());
        held.borrow_mut().clear();
        camera.stop();
        assert_eq!(camera.shared.with(|state| state.machine.ring.free()), 5, "a buffer is lost");
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_lines_are_those_sent(case in case()) {
        // Shorter lines are warned of: the FIFO holds several.
        if case.sent().iter().flatten().all(|line| line.len() > 16) && case.config.line_clocks > 16 {
            play_case(&case);
        }
    }
}
