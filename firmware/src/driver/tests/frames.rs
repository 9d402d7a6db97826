//! Frames in, frames out.

use super::super::config::{Crop, LineSelect, Policy};
use super::super::deadline::Cause;
use super::super::verdict::Outcome;
use super::super::{StartError, frame_plan};
use super::*;
use crate::camif::registers::{ByteSelect, FrameRate};

/// What of a frame the sender sent must be in memory.
fn bytes(lines: &[Vec<u8>]) -> Vec<u8> {
    lines.concat()
}

#[test]
fn every_frame_arrives_in_order_whatever_the_wires() {
    for wires in ALL_WIRES {
        for (line_bytes, lines) in [(16, 4), (24, 7), (8, 9), (20, 4)] {
            let words = line_bytes * lines / 4;
            with_camera::<3>(Part::CAMIF, Bus::IDEAL, words, |model, camera| {
                camera.start(&Config::new(wires.mode(), line_bytes as u32, lines as u32)).unwrap();
                let handler = || camera.on_interrupt();
                let mut sender = Sender::new(model, &handler, wires);
                let mut received = 0;
                let mut check = |sent: usize| {
                    while let Some(frame) = camera.try_frame() {
                        assert_eq!(
                            *frame,
                            *bytes(&picture(received, line_bytes, lines)),
                            "{wires:?} {line_bytes}"
                        );
                        let verdict = *frame.verdict();
                        assert_eq!(verdict.outcome, Outcome::Good);
                        assert_eq!(verdict.sequence as usize, received, "after {sent} frames");
                        assert_eq!(
                            (verdict.lines as usize, verdict.max_line_bytes as usize),
                            (lines, line_bytes)
                        );
                        received += 1;
                    }
                };
                for number in 0..10 {
                    sender.frame(&picture(number, line_bytes, lines));
                    check(number);
                }
                sender.close();
                check(10);
                assert_eq!(received, 10, "{wires:?} {line_bytes} × {lines}: {:?}", camera.statistics());
            });
        }
    }
}

/// Sends `count` frames and returns the sequence numbers of those that arrived, each of which must be as it was sent.
fn received<const N: usize>(config: &Config, wires: Wires, part: Part, count: usize) -> Vec<u32> {
    let (line_bytes, lines) = (config.line_clocks as usize, config.lines as usize);
    let room = frame_plan(config, part.transfer_limit).unwrap().room() as usize;
    let mut sequences = vec![];
    with_camera::<N>(part, Bus::IDEAL, room, |model, camera| {
        camera.start(config).unwrap();
        let handler = || camera.on_interrupt();
        let mut sender = Sender::new(model, &handler, wires);
        let mut take = || {
            while let Some(frame) = camera.try_frame() {
                let number = frame.verdict().sequence;
                assert!(frame.verdict().outcome.is_good());
                assert_eq!(*frame, *bytes(&picture(number as usize, line_bytes, lines)), "frame {number}");
                sequences.push(number);
            }
        };
        for number in 0..count {
            sender.frame(&picture(number, line_bytes, lines));
            take();
        }
        sender.close();
        take();
    });
    sequences
}

#[test]
fn frames_that_equal_transfers_do_not_fill_are_taken_one_at_a_time() {
    let config = Config::new(GATED, 12, 3);
    assert_eq!(
        received::<2>(&config, Wires::Gated, Part::CAMIF, 6),
        [0, 1, 2, 3, 4, 5],
        "blanking is time enough"
    );
    assert_eq!(received::<2>(&config, Wires::Gated, Part::STM32F4, 6), [0, 1, 2, 3, 4, 5]);
    let config = Config::new(MARKER, 12, 3);
    assert_eq!(
        received::<2>(&config, Wires::Marker, Part::CAMIF, 6),
        [0, 2, 4],
        "no blanking: every other one"
    );
}

#[test]
fn frames_around_the_transfer_limit() {
    for words in [65_534, 65_535, 65_536, 65_537, 131_070] {
        let config = Config::new(GATED, words * 4, 1);
        assert_eq!(received::<2>(&config, Wires::Gated, Part::STM32F4, 4), [0, 1, 2, 3], "{words} words");
    }
}

#[test]
fn a_buffer_too_small_says_how_many_words_it_takes() {
    with_camera::<2>(Part::STM32F4, Bus::IDEAL, 65_537, |_, camera| {
        let error = camera.start(&Config::new(GATED, 65_537 * 4, 1)).unwrap_err();
        assert_eq!(error, StartError::BufferTooSmall { buffer: 0, needed: 65_538, words: 65_537 });
        let text = "buffer 0 has 65537 words and 65538 are needed; make it larger, or crop";
        assert_eq!(error.to_string(), text);
        assert!(matches!(camera.start(&Config::new(MARKER, 64, 4)), Err(StartError::Refused(_))));
        assert_eq!(camera.diagnose().cause, Cause::Stopped);
    });
}

#[test]
fn wide_buses_crops_and_selections() {
    let base = Config::new(GATED, 32, 8);
    let crop = Some(Crop { first_clock: 4, clocks: 16, first_line: 2, lines: 5 });
    let cases = [
        Config { crop, ..base },
        Config { line_select: LineSelect::Odd, ..base },
        Config { crop, line_select: LineSelect::Even, ..base },
        Config { byte_select: ByteSelect::OneOfTwo, byte_select_odd: true, ..base },
        Config { byte_select: ByteSelect::TwoOfFour, ..base },
        Config { crop: Some(Crop { first_clock: 0, clocks: 32, first_line: 0, lines: 8 }), ..base },
    ];
    let sent = |number| picture(number, 32, 8);
    for (case, policy) in cases.iter().flat_map(|case| [(case, Policy::InOrder), (case, Policy::NewestWins)])
    {
        let config = Config { policy, ..*case };
        let words = config.geometry().words() as usize;
        with_camera::<3>(Part::CAMIF, Bus::IDEAL, words, |model, camera| {
            camera.start(&config).unwrap();
            let handler = || camera.on_interrupt();
            let mut sender = Sender::new(model, &handler, Wires::Gated);
            for number in 0..5 {
                sender.frame(&sent(number));
                let frame = camera.try_frame().unwrap_or_else(|| panic!("{config:?}: {}", camera.diagnose()));
                assert_eq!(frame.verdict().sequence as usize, number);
                assert_eq!(*frame, *selected(&config, &sent(number)), "{config:?}");
                assert_eq!(frame.verdict().max_line_bytes, config.geometry().line_bytes);
            }
        });
    }
}

/// What a configuration takes of a picture, sample by sample.
fn selected(config: &Config, lines: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = vec![];
    for (y, line) in lines.iter().enumerate() {
        for (x, &byte) in line.iter().enumerate() {
            let inside = config.crop.is_none_or(|crop| {
                let first = (crop.first_clock as usize, crop.first_line as usize);
                (first.0..first.0 + crop.clocks as usize).contains(&x)
                    && (first.1..first.1 + crop.lines as usize).contains(&y)
            });
            let line = match config.line_select {
                LineSelect::All => true,
                LineSelect::Even => y % 2 == 0,
                LineSelect::Odd => y % 2 == 1,
            };
            let odd = usize::from(config.byte_select_odd);
            let clock = match config.byte_select {
                ByteSelect::All => true,
                ByteSelect::OneOfTwo => x % 2 == odd,
                ByteSelect::OneOfFour => x % 4 == odd,
                ByteSelect::TwoOfFour => x % 4 / 2 == odd,
            };
            if inside && line && clock {
                bytes.push(byte);
            }
        }
    }
    bytes
}

#[test]
fn compressed_frames_of_any_length() {
    let config = Config { jpeg: true, ..Config::new(GATED, 64, 1) };
    for part in [Part::CAMIF, Part::STM32F4] {
        with_camera::<2>(part, Bus::IDEAL, 16, |model, camera| {
            camera.start(&config).unwrap();
            let handler = || camera.on_interrupt();
            let mut sender = Sender::new(model, &handler, Wires::Gated);
            for (number, length) in [1, 5, 64, 33, 68, 80, 16, 64].into_iter().enumerate() {
                let data = picture(number, length, 1);
                sender.frame(&data);
                if length > 64 {
                    assert!(camera.try_frame().is_none());
                    let long = Cause::Damaged(Outcome::Long { expected: 64 });
                    assert_eq!(camera.diagnose().cause, long, "{}", part.name);
                    continue;
                }
                let frame = camera.try_frame().unwrap();
                assert_eq!(frame.bytes()[..length], data[0], "{}", part.name);
                let padded = if part.counters { length } else { length.next_multiple_of(4) };
                assert_eq!(frame.len(), padded, "counters know the length to the byte");
            }
        });
    }
}

#[test]
fn frame_rates_leave_frames_out() {
    for (frame_rate, step) in [(FrameRate::Half, 2), (FrameRate::Quarter, 4)] {
        let config = Config { frame_rate, ..Config::new(GATED, 16, 4) };
        let expected: Vec<u32> = (0..12).step_by(step).collect();
        assert_eq!(received::<3>(&config, Wires::Gated, Part::CAMIF, 12), expected);
        assert_eq!(received::<3>(&config, Wires::Gated, Part::STM32F4, 12), expected);
    }
}
