//! The block against the naive model: the same recording gives the same frames.

use camif_tests::oracle::camif::{Clock, Sync as Telling, Wanted, frames};
use firmware::camif::pins::{Pins, Samples, Sync};
use firmware::camif::registers::{
    Burst, BusWidth, ByteSelect, Control, DmaMode, Events, FrameRate, Register, Registers,
};
use firmware::camif::{Bus, Camif, Part};
use firmware::port::{Dma, Target, Transfer};
use proptest::prelude::*;

const WORDS: u32 = 4096;

/// The frames as the block leaves them in memory, each read up to where the DMA stood when FRAME was raised.
fn captured(recording: &[Clock], wanted: &Wanted, at_once: bool, burst: Burst) -> Vec<Vec<u8>> {
    let mut memory = vec![0; WORDS as usize];
    let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
    camif.lend(0, &mut memory).unwrap();
    camif.aim(Target::Zero, 0, 0).unwrap();
    let mode = DmaMode::Single;
    camif.start(Transfer { words: WORDS, mode, burst, line_by_line: false, half_interrupt: false }).unwrap();
    if let Some(((left, width), (top, height))) = wanted.crop {
        camif.write(Register::CropStart, (top << 16 | left) as u32);
        camif.write(Register::CropSize, ((height - 1) << 16 | (width - 1)) as u32);
    }
    if let Telling::Embedded { codes, masks } = wanted.sync {
        camif.write(Register::SyncCode, u32::from_le_bytes(codes));
        camif.write(Register::SyncUnmask, u32::from_le_bytes(masks));
    }
    camif.write(Register::Extension, u32::from(wanted.sync == Telling::Marker));
    camif.write(Register::InterruptEnable, Events::default().with_frame(true).with_error(true).raw_value());
    let (select, odd) = match wanted.bytes_of_four {
        [true, true, true, true] => (ByteSelect::All, false),
        [first, false, _, false] if first => {
            (if wanted.bytes_of_four[2] { ByteSelect::OneOfTwo } else { ByteSelect::OneOfFour }, false)
        }
        [false, true, false, fourth] => {
            (if fourth { ByteSelect::OneOfTwo } else { ByteSelect::OneOfFour }, true)
        }
        [first, ..] => (ByteSelect::TwoOfFour, !first),
    };
    let control = Control::default()
        .with_enable(true)
        .with_capture(true)
        .with_crop(wanted.crop.is_some())
        .with_jpeg(wanted.jpeg)
        .with_embedded_sync(matches!(wanted.sync, Telling::Embedded { .. }))
        .with_hsync_blank_high(wanted.hsync_level)
        .with_vsync_blank_high(wanted.vsync_level)
        .with_bus_width(BusWidth::from_bits(wanted.bits).unwrap())
        .with_frame_rate(match wanted.every {
            1 => FrameRate::All,
            2 => FrameRate::Half,
            _ => FrameRate::Quarter,
        })
        .with_byte_select(select)
        .with_byte_select_odd(odd)
        .with_line_select(wanted.lines_of_two != [true, true])
        .with_line_select_odd(wanted.lines_of_two == [false, true]);
    camif.write(Register::Control, control.raw_value());

    let mut frames = Vec::new();
    let mut start = 0;
    let mut frame_ended = |camif: &mut Camif<'_>| {
        if camif.interrupts().camif {
            camif.elapse(50);
            let events = Events::new_with_raw_value(camif.peek(Register::MaskedInterrupt));
            camif.write(Register::InterruptClear, Events::MASK);
            let end = (WORDS - camif.peek(Register::DmaCount)) as usize;
            let words = &camif.lent(0).unwrap()[start..end];
            if events.frame() {
                frames.push(words.iter().flat_map(|word| word.to_le_bytes()).collect());
            }
            // What a lost frame left behind is skipped.
            start = end;
        }
    };
    let levels = |clock: &Clock| Sync { hsync: clock.hsync, vsync: clock.vsync };
    if at_once {
        for stretch in recording.chunk_by(|a, b| levels(a) == levels(b)) {
            let sync = levels(&stretch[0]);
            let words: Vec<u16> = stretch.iter().map(|clock| clock.data).collect();
            let bytes: Vec<u8> = words.iter().map(|&word| word as u8).collect();
            let samples = if wanted.bits == 8 { Samples::Bytes(&bytes) } else { Samples::Words(&words) };
            let mut played = 0;
            while played < samples.len() {
                played += camif.run(sync, samples.skip(played));
                frame_ended(&mut camif);
            }
        }
    } else {
        for clock in recording {
            camif.step(Pins { sync: levels(clock), data: clock.data });
            frame_ended(&mut camif);
        }
    }
    frames
}

/// Lines and blankings as a sensor sends them, more or less.
fn recording(hsync_level: bool, vsync_level: bool) -> impl Strategy<Value = Vec<Clock>> {
    let stretch = (0u8..16, prop::collection::vec(any::<u16>(), 1..60)).prop_map(move |(kind, data)| {
        let (h, v, clocks) = match kind {
            0..=6 => (false, false, data.len()),
            7..=11 => (true, false, 1 + data.len() % 3),
            12 => (false, true, 1 + data.len() % 3),
            _ => (true, true, 1 + data.len() % 5),
        };
        let wires = Clock { hsync: h == hsync_level, vsync: v == vsync_level, data: 0 };
        data[..clocks.min(data.len())].iter().map(|&data| Clock { data, ..wires }).collect::<Vec<_>>()
    });
    prop::collection::vec(stretch, 1..40).prop_map(|stretches| stretches.concat())
}

/// Bytes with codes among them, mostly in an order that makes sense.
fn coded() -> impl Strategy<Value = Vec<Clock>> {
    let piece = prop_oneof![
        4 => prop::collection::vec(any::<u8>(), 0..30),
        1 => prop::sample::select(vec![1u8, 2, 3, 4, 0x80, 0x9D, 0xAB, 0x12]).prop_map(|code| vec![0xFF, 0, 0, code]),
        4 => prop::collection::vec(1u8..0xFF, 0..30).prop_map(|line| [&[0xFF, 0, 0, 2][..], &line, &[0xFF, 0, 0, 3]].concat()),
        4 => prop::collection::vec(1u8..0xFF, 0..30).prop_map(|line| [&[0xFF, 0, 0, 0x80][..], &line, &[0xFF, 0, 0, 0x9D]].concat()),
        2 => Just(vec![0xFF, 0, 0, 4, 9, 9, 0xFF, 0, 0, 1]),
        2 => Just(vec![0xFF, 0, 0, 0xAB, 9, 9]),
    ];
    prop::collection::vec(piece, 1..40).prop_map(|pieces| {
        pieces
            .concat()
            .into_iter()
            .map(|byte| Clock { hsync: false, vsync: false, data: u16::from(byte) })
            .collect()
    })
}

fn wanted() -> impl Strategy<Value = Wanted> {
    let sync = prop_oneof![
        3 => Just(Telling::Gated),
        3 => Just(Telling::Marker),
        1 => Just(Telling::Embedded { codes: [0xFF, 0x80, 0x9D, 0xFF], masks: [0xFF; 4] }),
        1 => Just(Telling::Embedded { codes: [1, 2, 3, 4], masks: [0xFF; 4] }),
        1 => Just(Telling::Embedded { codes: [1, 2, 3, 4], masks: [0x0F; 4] }),
    ];
    let crop = prop::option::of(((0usize..20, 1usize..40), (0usize..4, 1usize..5)));
    let patterns = vec![
        [true; 4],
        [true; 4],
        [true, false, true, false],
        [false, true, false, true],
        [true, false, false, false],
        [false, true, false, false],
        [true, true, false, false],
        [false, false, true, true],
    ];
    let lines = vec![[true, true], [true, true], [true, false], [false, true]];
    (
        (sync, any::<bool>(), any::<bool>(), prop::sample::select(vec![8u32, 8, 8, 10, 12, 14])),
        (prop::sample::select(vec![1usize, 1, 2, 4]), crop, prop::sample::select(patterns)),
        (prop::sample::select(lines), 0u8..8),
    )
        .prop_map(|((sync, hsync_level, vsync_level, bits), (every, crop, bytes), (lines, rare))| {
            let embedded = matches!(sync, Telling::Embedded { .. });
            let bits = if embedded { 8 } else { bits };
            let jpeg = rare == 0 && sync == Telling::Gated;
            let bytes_of_four = if bits > 8 { [true; 4] } else { bytes };
            let crop = crop.filter(|_| rare < 5);
            Wanted {
                sync,
                hsync_level,
                vsync_level,
                bits,
                every,
                crop,
                bytes_of_four,
                lines_of_two: lines,
                jpeg,
            }
        })
}

fn scene() -> impl Strategy<Value = (Wanted, Vec<Clock>)> {
    wanted().prop_flat_map(|wanted| {
        let recording = if matches!(wanted.sync, Telling::Embedded { .. }) {
            coded().boxed()
        } else {
            recording(wanted.hsync_level, wanted.vsync_level).boxed()
        };
        (Just(wanted), recording)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn step_and_run_agree_with_the_naive_model((wanted, recording) in scene()) {
        let expected = frames(&recording, &wanted);
        for burst in [Burst::One, Burst::Four] {
            prop_assert_eq!(&captured(&recording, &wanted, false, burst), &expected, "step, {:?}", burst);
            prop_assert_eq!(&captured(&recording, &wanted, true, burst), &expected, "run, {:?}", burst);
        }
    }
}

#[test]
fn the_scenes_of_that_property_hold_frames() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let found: usize = (0..300)
        .map(|_| scene().new_tree(&mut runner).unwrap().current())
        .map(|(wanted, recording)| {
            frames(&recording, &wanted).iter().filter(|frame| !frame.is_empty()).count()
        })
        .sum();
    assert!(found > 300, "{found} frames in 300 recordings");
}
