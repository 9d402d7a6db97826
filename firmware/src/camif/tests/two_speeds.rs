//! Two speeds, one truth: `run` leaves the block exactly as `step` does, after every call, whatever the configuration,
//! the stream and the bus.

use proptest::prelude::*;

use super::*;
use crate::camif::pins::Samples;
use crate::camif::{Hold, Stall};

/// Samples of a stretch, owned.
#[derive(Clone, Debug)]
enum Data {
    Bytes(Vec<u8>),
    Words(Vec<u16>),
    Repeat(u16, u32),
}

impl Data {
    fn samples(&self) -> Samples<'_> {
        match self {
            Self::Bytes(bytes) => Samples::Bytes(bytes),
            Self::Words(words) => Samples::Words(words),
            &Self::Repeat(value, clocks) => Samples::Repeat { value, clocks },
        }
    }
}

/// What happens next.
#[derive(Clone, Debug)]
enum Act {
    Stretch(Sync, Data),
    Write(Register, u32),
    Read(Register),
    /// As a handler would: both kinds of flags are cleared.
    Acknowledge,
}

#[derive(Clone, Debug)]
struct Setup {
    control: u32,
    extension: u32,
    crop: (u32, u32),
    codes: (u32, u32),
    interrupts: u32,
    dma: u32,
    count: u32,
    second: u32,
    bus: Bus,
}

fn setup() -> impl Strategy<Value = Setup> {
    let bus = (
        0u32..6,
        0u32..4,
        prop::option::of((1u32..20, 0u32..40)),
        prop::option::of((0u64..40, 0u32..80)),
        prop::option::weighted(0.2, 0u64..40),
        any::<u64>(),
    )
        .prop_map(|(latency_min, more, stall, hold, error, seed)| Bus {
            // Half of the buses grant at once, because that is where `run` takes its short cut.
            latency_min: latency_min.saturating_sub(3),
            latency_max: latency_min.saturating_sub(3) + more.saturating_sub(2),
            stall: stall.filter(|_| more == 3).map(|(one_in, clocks)| Stall { one_in, clocks }),
            hold: hold.map(|(request, clocks)| Hold { request, clocks }),
            error,
            seed,
        });
    // CAPTURE and ENABLE are set more often than not; the rarer modes come one at a time.
    let control = (any::<u32>(), 0u32..8).prop_map(|(bits, rare)| {
        let wires = bits & 0xE2 | 0x4001;
        match rare {
            0 => wires | bits & 0x0C00,
            1 => wires | bits & 0x001F_0000,
            2 => wires | 0x10,
            3 => wires | 0x08,
            4 => wires | bits & 0x300,
            5 | 6 => wires | bits & 0x0C04,
            _ => bits,
        }
    });
    let crop = (0u32..24, 0u32..4, 0u32..90, 0u32..4)
        .prop_map(|(x, y, width, height)| (y << 16 | x, height << 16 | width));
    let codes =
        prop_oneof![Just((0xFF9D_80FF, !0)), Just((0x0403_0201, !0)), Just((0x0403_0201, 0x0F0F_0F0F))];
    let dma = (any::<u32>(), 0u32..3, 0u32..3)
        .prop_map(|(bits, mode, burst)| bits & 0x1E | mode << 8 | burst << 12 | u32::from(bits & 0x700 != 0));
    (control, 0u32..2, crop, codes, any::<u32>(), dma, 1u32..80, 0u32..64, bus).prop_map(
        |(control, extension, crop, codes, interrupts, dma, count, second, bus)| Setup {
            control,
            extension,
            crop,
            codes,
            interrupts: interrupts & interrupts >> 8,
            dma,
            count,
            second,
            bus,
        },
    )
}

fn data() -> impl Strategy<Value = Data> {
    // Codes of embedded synchronisation among the bytes, so that they are met at all.
    let piece = prop_oneof![
        6 => prop::collection::vec(any::<u8>(), 0..40),
        3 => prop::sample::select(vec![0x80u8, 0x9D, 0xAB, 1, 2, 3, 4]).prop_map(|code| vec![0xFF, 0, 0, code]),
    ];
    prop_oneof![
        5 => prop::collection::vec(piece, 0..10).prop_map(|pieces| Data::Bytes(pieces.concat())),
        2 => prop::collection::vec(any::<u16>(), 0..120).prop_map(Data::Words),
        2 => (any::<u16>(), 0u32..100).prop_map(|(value, clocks)| Data::Repeat(value, clocks)),
    ]
}

fn act() -> impl Strategy<Value = Act> {
    let sync = (any::<bool>(), any::<bool>()).prop_map(|(hsync, vsync)| Sync { hsync, vsync });
    prop_oneof![
        16 => (sync, data()).prop_map(|(sync, data)| Act::Stretch(sync, data)),
        3 => Just(Act::Acknowledge),
        1 => (prop::sample::select(&Register::ALL[..]), any::<u32>()).prop_map(|(register, value)| Act::Write(register, value)),
        1 => prop::sample::select(&Register::ALL[..]).prop_map(Act::Read),
        1 => prop::sample::select(vec![0, 0x0201, 0x1201, 0x2217]).prop_map(|dma| Act::Write(Register::DmaControl, dma)),
    ]
}

fn prepare<'m>(setup: &Setup, memory: &'m mut [u32]) -> Camif<'m> {
    let mut camif = Camif::new(Part::CAMIF, setup.bus);
    camif.lend(0, memory).unwrap();
    camif.write(Register::Extension, setup.extension);
    camif.write(Register::CropStart, setup.crop.0);
    camif.write(Register::CropSize, setup.crop.1);
    camif.write(Register::SyncCode, setup.codes.0);
    camif.write(Register::SyncUnmask, setup.codes.1);
    camif.write(Register::InterruptEnable, setup.interrupts);
    camif.write(Register::DmaCount, setup.count);
    camif.write(Register::DmaTarget1, setup.second);
    camif.write(Register::DmaControl, setup.dma);
    camif.write(Register::Control, setup.control);
    camif
}

/// What `run` is to do, a clock at a time.
fn run_by_steps(camif: &mut Camif<'_>, sync: Sync, samples: Samples<'_>) -> usize {
    let before = camif.interrupts();
    for clock in 0..samples.len() {
        camif.step(Pins { sync, data: samples.get(clock).unwrap() });
        let after = camif.interrupts();
        if after.camif && !before.camif || after.dma && !before.dma {
            return clock + 1;
        }
    }
    samples.len()
}

fn check(setup: &Setup, acts: &[Act]) -> Result<(), TestCaseError> {
    let (mut slow_memory, mut fast_memory) = ([0; 128], [0; 128]);
    let mut slow = prepare(setup, &mut slow_memory);
    let mut fast = prepare(setup, &mut fast_memory);
    for act in acts {
        match act {
            Act::Stretch(sync, data) => {
                let samples = data.samples();
                let mut played = 0;
                while played < samples.len() {
                    let by_steps = run_by_steps(&mut slow, *sync, samples.skip(played));
                    let at_once = fast.run(*sync, samples.skip(played));
                    prop_assert_eq!(by_steps, at_once, "clocks played");
                    prop_assert_eq!(&slow, &fast);
                    played += at_once;
                }
            }
            Act::Write(register, value) => {
                slow.write(*register, *value);
                fast.write(*register, *value);
            }
            Act::Read(register) => prop_assert_eq!(slow.read(*register), fast.read(*register)),
            Act::Acknowledge => {
                for camif in [&mut slow, &mut fast] {
                    camif.write(Register::InterruptClear, !0);
                    camif.write(Register::DmaClear, !0);
                }
            }
        }
        // Registers, interrupts, FIFO, memory, requests, time: all of the state.
        prop_assert_eq!(&slow, &fast);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    #[test]
    fn run_is_step_after_every_call(setup in setup(), acts in prop::collection::vec(act(), 1..30)) {
        check(&setup, &acts)?;
    }

    /// Long undisturbed lines, where the short cuts are taken most.
    #[test]
    fn run_is_step_on_whole_frames(
        setup in setup(),
        frames in prop::collection::vec((1u32..6, prop::collection::vec(any::<u8>(), 1..300), 0u32..20), 1..4),
    ) {
        let h = setup.control & 1 << 6 != 0;
        let v = setup.control & 1 << 7 != 0;
        let marker = setup.extension & 1 != 0;
        let mut acts = vec![Act::Stretch(Sync { hsync: h, vsync: v }, Data::Repeat(0, 5))];
        for (lines, line, blank) in frames {
            for _ in 0..lines {
                acts.push(Act::Stretch(Sync { hsync: !h, vsync: !v }, Data::Bytes(line.clone())));
                acts.push(Act::Stretch(Sync { hsync: h, vsync: !v }, Data::Repeat(7, if marker { 1 } else { blank })));
                acts.push(Act::Acknowledge);
            }
            acts.push(Act::Stretch(Sync { hsync: h, vsync: v }, Data::Repeat(7, if marker { 1 } else { 1 + blank })));
            acts.push(Act::Acknowledge);
        }
        check(&setup, &acts)?;
    }
}
