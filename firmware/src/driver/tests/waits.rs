//! Waiting, blocking and async: frames when they come, and the cause when they don't.

use std::cell::{Cell, RefCell};
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::task::{Context, Poll, Wake, Waker};

use super::super::config::{Crop, Damaged, Policy};
use super::super::deadline::Cause;
use super::super::verdict::Outcome;
use super::super::{LineCamera, LineEvent};
use super::*;
use crate::camif::Hold;
use crate::camif::pins::{Pins, Sync};
use crate::camif::registers::Burst;

const LINE: usize = 16;
const LINES: usize = 4;

fn config(wires: Wires) -> Config {
    Config::new(wires.mode(), LINE as u32, LINES as u32)
}

/// Starts a camera, plays something, and waits in vain; returns the cause.
fn cause(config: &Config, part: Part, bus: Bus, wires: Wires, play: impl Fn(&mut Sender<'_, '_>)) -> Cause {
    let result = Cell::new(None);
    with_camera::<2>(part, bus, LINE * LINES / 4, |model, camera| {
        camera.start(config).unwrap();
        let handler = || camera.on_interrupt();
        let sender = RefCell::new(Sender::new(model, &handler, wires));
        let mut now = 0;
        let waited = camera.wait_frame(10, || {
            play(&mut sender.borrow_mut());
            // The pins are looked at now and then, as a main loop that reports would.
            camera.diagnose();
            now += 1;
            now
        });
        result.set(Some(waited.unwrap_err().cause));
    });
    result.get().unwrap()
}

#[test]
fn no_clock() {
    for part in [Part::CAMIF, Part::STM32F4] {
        assert_eq!(cause(&config(Wires::Gated), part, Bus::IDEAL, Wires::Gated, |_| {}), Cause::NoClock);
    }
}

#[test]
fn no_vsync() {
    // VSYNC is stuck at either level; HSYNC and data go on.
    for (vsync, line_interrupts) in [(true, true), (false, true), (true, false), (false, false)] {
        let config = Config { line_interrupts, ..config(Wires::Gated) };
        let found = cause(&config, Part::CAMIF, Bus::IDEAL, Wires::Gated, |sender| {
            // An odd number of halves of a line at each look.
            sender.samples(false, vsync, &[1; LINE]);
            sender.samples(true, vsync, &[1; 4]);
            sender.samples(false, vsync, &[1; LINE]);
            if (sender.model.borrow().requests() + u64::from(sender.tick())) % 2 == 0 {
                sender.samples(true, vsync, &[1; 4]);
            }
        });
        assert_eq!(found, Cause::NoVsync, "VSYNC stuck at {vsync}, line interrupts {line_interrupts}");
    }
}

#[test]
fn no_data() {
    // HSYNC is stuck at its blanking level.
    let found = cause(&config(Wires::Gated), Part::STM32F4, Bus::IDEAL, Wires::Gated, |sender| {
        sender.samples(true, true, &[1; 9]);
        sender.samples(true, false, &[1; 200]);
    });
    assert!(matches!(found, Cause::NoData | Cause::ShortFrame { .. }), "{found:?}");
    // The crop window lies beside the picture that is sent.
    let crop = Some(Crop { first_clock: 8, clocks: 8, first_line: 0, lines: 4 });
    let found =
        cause(&Config { crop, ..config(Wires::Gated) }, Part::CAMIF, Bus::IDEAL, Wires::Gated, |sender| {
            sender.frame(&picture(0, 4, LINES));
        });
    assert_eq!(found, Cause::ShortFrame { expected: 32 });
}

#[test]
fn short_frames() {
    for part in [Part::CAMIF, Part::STM32F4] {
        for wires in [Wires::Gated, Wires::Embedded] {
            let found = cause(&config(wires), part, Bus::IDEAL, wires, |sender| {
                sender.frame(&picture(0, LINE, LINES - 1));
            });
            assert_eq!(found, Cause::ShortFrame { expected: 64 }, "{} {wires:?}", part.name);
        }
    }
}

#[test]
fn frames_that_are_damaged_otherwise() {
    let long = cause(&config(Wires::Marker), Part::CAMIF, Bus::IDEAL, Wires::Marker, |sender| {
        sender.frame(&picture(0, LINE, LINES + 1));
    });
    assert_eq!(long, Cause::Damaged(Outcome::Long { expected: 64 }));
    let uneven = cause(&config(Wires::Gated), Part::CAMIF, Bus::IDEAL, Wires::Gated, |sender| {
        let mut lines = picture(0, LINE, LINES);
        let moved = lines[1].pop().unwrap();
        lines[2].push(moved);
        sender.frame(&lines);
    });
    assert_eq!(uneven, Cause::Damaged(Outcome::LineLength { expected: 16 }));
    let lines = cause(&config(Wires::Gated), Part::CAMIF, Bus::IDEAL, Wires::Gated, |sender| {
        sender.frame(&picture(0, LINE * 2, LINES / 2));
    });
    assert_eq!(lines, Cause::Damaged(Outcome::LineCount { expected: 4 }));
    let errors = cause(&config(Wires::Embedded), Part::CAMIF, Bus::IDEAL, Wires::Embedded, |sender| {
        sender.samples(false, false, &[0xFF, 0, 0, 0xB6, 0xFF, 0, 0, 0x80, 1, 2, 3, 4, 0xFF, 0, 0, 0x80]);
    });
    assert_eq!(errors, Cause::Damaged(Outcome::SyncError));
}

#[test]
fn a_dma_that_stalls() {
    // The first burst is never granted.
    let bus = Bus { hold: Some(Hold { request: 0, clocks: u32::MAX }), ..Bus::IDEAL };
    for part in [Part::CAMIF, Part::STM32F4] {
        let found = cause(&config(Wires::Gated), part, bus, Wires::Gated, |sender| {
            sender.frame(&picture(0, LINE, LINES));
        });
        assert_eq!(found, Cause::DmaStalled, "{}", part.name);
        // Data too little to overrun waits for ever.
        let found = cause(&config(Wires::Gated), part, bus, Wires::Gated, |sender| {
            if sender.tick() == 1 {
                sender.samples(true, true, &[1; 4]);
                sender.samples(false, false, &[1; 16]);
            }
        });
        assert_eq!(found, Cause::DmaStalled, "{}", part.name);
    }
}

#[test]
fn overruns() {
    // The bus is slower than the sensor, but moves something.
    let bus = Bus { latency_min: 8, latency_max: 12, ..Bus::IDEAL };
    let config = Config { burst: Burst::One, ..config(Wires::Gated) };
    let found = cause(&config, Part::CAMIF, bus, Wires::Gated, |sender| {
        sender.frame(&picture(0, LINE, LINES));
    });
    assert!(matches!(found, Cause::Overrun { overruns: 5.. }), "{found:?}");
}

#[test]
fn a_deadline_shorter_than_a_frame() {
    let found = cause(&config(Wires::Gated), Part::CAMIF, Bus::IDEAL, Wires::Gated, |sender| {
        if sender.tick() == 1 {
            sender.samples(true, true, &[1; 4]);
            sender.samples(false, false, &[1; 41]);
        }
    });
    assert_eq!(found, Cause::Unfinished { words: 8, expected: 16 });
}

#[test]
fn no_buffer_and_not_running() {
    with_camera::<1>(Part::CAMIF, Bus::IDEAL, 16, |model, camera| {
        assert_eq!(camera.diagnose().cause, Cause::Stopped);
        camera.start(&config(Wires::Gated)).unwrap();
        let handler = || camera.on_interrupt();
        let mut sender = Sender::new(model, &handler, Wires::Gated);
        sender.frame(&picture(0, LINE, LINES));
        let held = camera.try_frame().unwrap();
        for number in 1..4 {
            sender.frame(&picture(number, LINE, LINES));
        }
        assert_eq!(camera.diagnose().cause, Cause::NoBuffer);
        assert_eq!(camera.diagnose().evidence.vsyncs, 3);
        drop(held);
        sender.frame(&picture(4, LINE, LINES));
        let frame = camera.try_frame().unwrap();
        assert_eq!((frame.verdict().sequence, frame.verdict().dropped_before), (4, 3));
        assert_eq!(*frame, *picture(4, LINE, LINES).concat());
        assert_eq!((camera.statistics().dropped, camera.statistics().lost), (3, 0));
    });
}

#[test]
fn snapshots_come_when_asked_for() {
    for part in [Part::CAMIF, Part::STM32F4] {
        let config = Config { policy: Policy::Snapshot, ..config(Wires::Gated) };
        with_camera::<2>(part, Bus::IDEAL, 16, |model, camera| {
            camera.start(&config).unwrap();
            let handler = || camera.on_interrupt();
            let mut sender = Sender::new(model, &handler, Wires::Gated);
            for number in 0..6 {
                if number % 3 == 1 {
                    assert_eq!(camera.diagnose().cause, Cause::Stopped, "nothing was asked for");
                    camera.trigger();
                }
                sender.frame(&picture(number, LINE, LINES));
                let frame = camera.try_frame();
                assert_eq!(frame.is_some(), number % 3 == 1);
                if let Some(frame) = frame {
                    assert_eq!(*frame, *picture(number, LINE, LINES).concat());
                    assert_eq!(frame.verdict().sequence as usize, number);
                }
            }
            assert_eq!(camera.statistics().skipped, 3, "{:?}", camera.statistics());
        });
    }
}

#[test]
fn policies_differ_in_what_a_slow_consumer_gets() {
    let run = |policy| {
        let mut got = vec![];
        with_camera::<3>(Part::CAMIF, Bus::IDEAL, 16, |model, camera| {
            camera.start(&Config { policy, ..config(Wires::Gated) }).unwrap();
            let handler = || camera.on_interrupt();
            let mut sender = Sender::new(model, &handler, Wires::Gated);
            for number in 0..9 {
                sender.frame(&picture(number, LINE, LINES));
                if number % 4 == 3 {
                    got.extend(camera.try_frame().map(|frame| frame.verdict().sequence));
                }
            }
            let statistics = camera.statistics();
            got.extend([statistics.delivered, statistics.dropped, statistics.lost]);
        });
        got
    };
    assert_eq!(run(Policy::NewestWins), [3, 7, 2, 6, 0], "the newest each time");
    assert_eq!(run(Policy::InOrder), [0, 1, 2, 4, 0], "the oldest each time, and pauses between");
}

#[test]
fn damaged_frames_are_delivered_on_request() {
    for part in [Part::CAMIF, Part::STM32F4] {
        with_camera::<3>(part, Bus::IDEAL, 16, |model, camera| {
            camera.start(&Config { damaged: Damaged::Deliver, ..config(Wires::Gated) }).unwrap();
            let handler = || camera.on_interrupt();
            let mut sender = Sender::new(model, &handler, Wires::Gated);
            for (number, lines) in [4, 3, 4, 6, 4].into_iter().enumerate() {
                sender.frame(&picture(number, LINE, lines));
                let frame = camera.try_frame().unwrap();
                let sent = picture(number, LINE, lines).concat();
                assert_eq!(*frame, sent[..sent.len().min(64)], "{}", part.name);
                assert_eq!(frame.verdict().bytes as usize, sent.len());
                assert_eq!(frame.verdict().outcome.is_good(), lines == 4);
                assert_eq!(frame.crc32(), super::super::crc32(&sent[..sent.len().min(64)]));
            }
        });
    }
    assert_eq!(super::super::crc32(b"123456789"), 0xCBF4_3926, "the check value of CRC-32/ISO-HDLC");
}

/// Counts how often it is woken.
#[derive(Default)]
struct Count(AtomicU32);

impl Wake for Count {
    fn wake(self: Arc<Self>) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

impl Count {
    fn new() -> (Arc<Self>, Waker) {
        let count = Arc::new(Self::default());
        (count.clone(), Waker::from(count))
    }

    fn get(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}

#[test]
fn a_task_is_woken_by_a_frame_and_by_its_deadline() {
    with_camera::<2>(Part::CAMIF, Bus::IDEAL, 16, |model, camera| {
        camera.start(&config(Wires::Gated)).unwrap();
        let handler = || camera.on_interrupt();
        let mut sender = Sender::new(model, &handler, Wires::Gated);
        let (woken, waker) = Count::new();
        let mut context = Context::from_waker(&waker);
        {
            let mut next = pin!(camera.next_frame(100));
            assert!(next.as_mut().poll(&mut context).is_pending());
            sender.frame(&picture(0, LINE, LINES));
            assert_eq!(woken.get(), 1, "once, when the frame is ready");
            let Poll::Ready(Ok(frame)) = next.as_mut().poll(&mut context) else { panic!("a frame is there") };
            assert_eq!(*frame, *picture(0, LINE, LINES).concat());
        }
        let mut next = pin!(camera.next_frame(100));
        assert!(next.as_mut().poll(&mut context).is_pending());
        camera.advance(99);
        assert_eq!(woken.get(), 1);
        camera.advance(100);
        assert_eq!(woken.get(), 2);
        let Poll::Ready(Err(timeout)) = next.as_mut().poll(&mut context) else { panic!("it is too late") };
        assert_eq!(timeout.cause, Cause::NoClock);
        // Two tasks: the one that is displaced is woken, and can register again.
        let (other, other_waker) = Count::new();
        let mut first = pin!(camera.next_frame(u64::MAX));
        let mut second = pin!(camera.next_frame(u64::MAX));
        assert!(first.as_mut().poll(&mut context).is_pending());
        assert!(second.as_mut().poll(&mut Context::from_waker(&other_waker)).is_pending());
        assert_eq!((woken.get(), other.get()), (3, 0));
        sender.frame(&picture(1, LINE, LINES));
        assert_eq!((woken.get(), other.get()), (3, 1));
    });
}

#[test]
fn a_task_is_woken_when_the_drop_of_a_lease_finds_a_frame() {
    with_camera::<3>(Part::CAMIF, Bus::IDEAL, 16, |model, camera| {
        camera.start(&config(Wires::Gated)).unwrap();
        let handler = || camera.on_interrupt();
        Sender::new(model, &handler, Wires::Gated).frame(&picture(0, LINE, LINES));
        let lease = camera.try_frame().unwrap();
        let (woken, waker) = Count::new();
        let mut next = pin!(camera.next_frame(u64::MAX));
        assert!(next.as_mut().poll(&mut Context::from_waker(&waker)).is_pending());
        // The next frame; its end is not served.
        let blank = |hsync, vsync| {
            for _ in 0..8 {
                model.borrow_mut().step(Pins { sync: Sync { hsync, vsync }, data: 0 });
            }
        };
        for line in picture(1, LINE, LINES) {
            for byte in line {
                model.borrow_mut().step(Pins { sync: Sync::default(), data: u16::from(byte) });
                camera.on_interrupt();
            }
            blank(true, false);
            camera.on_interrupt();
        }
        blank(true, true);
        assert_eq!(woken.get(), 0, "the frame is not known to have ended");
        drop(lease);
        assert_eq!(woken.get(), 1);
        assert!(camera.try_frame().is_some());
    });
}

#[test]
fn lines_are_awaited_and_waited_for() {
    let mut memory = [[0_u32; 4]; 4];
    let mut buffers = memory.iter_mut();
    let buffers: [&mut [u32]; 4] = core::array::from_fn(|_| &mut buffers.next().unwrap()[..]);
    let model = RefCell::new(Camif::new(Part::CAMIF, Bus::IDEAL));
    let camera = LineCamera::new(&model, buffers).unwrap();
    camera.start(&config(Wires::Gated)).unwrap();
    let handler = || camera.on_interrupt();
    let mut sender = Sender::new(&model, &handler, Wires::Gated);
    let timeout = camera
        .wait_line(3, {
            let mut now = 0;
            move || {
                now += 1;
                now
            }
        })
        .unwrap_err();
    assert_eq!(timeout.cause, Cause::NoClock);
    assert!(timeout.to_string().starts_with("no frame in time: no pixel clock"));
    let (woken, waker) = Count::new();
    let mut next = pin!(camera.next_line(1));
    assert!(next.as_mut().poll(&mut Context::from_waker(&waker)).is_pending());
    sender.samples(true, true, &[0; 4]);
    sender.samples(false, false, &picture(0, LINE, 1)[0]);
    sender.samples(true, false, &[0; 40]);
    assert_eq!(woken.get(), 1);
    let Poll::Ready(Ok(LineEvent::Line(line))) = next.as_mut().poll(&mut Context::from_waker(&waker)) else {
        panic!("a line is there");
    };
    assert_eq!((line.index(), &*line), (0, &*picture(0, LINE, 1)[0]));
}

#[test]
fn a_camera_gives_its_parts_back() {
    let mut memory = [[0_u32; 16]; 2];
    let [first, second] = &mut memory;
    let model = RefCell::new(Camif::new(Part::CAMIF, Bus::IDEAL));
    let camera = FrameCamera::new(&model, [&mut first[..], &mut second[..]]).unwrap();
    camera.start(&config(Wires::Gated)).unwrap();
    let (_, buffers) = camera.into_parts();
    assert_eq!(buffers.map(|buffer| buffer.map(|words| words.len())), [Some(16); 2]);
}
