//! Pixel clocks a second of the block alone, beside a copy of the same bytes.
//!
//! One VGA RGB888 frame (921,600 clocks, marker mode) into a double buffer of whole frames, with LINE, FRAME and DMA
//! interrupts enabled and acknowledged as a handler does.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use firmware::camif::pins::{Pins, Samples, Sync};
use firmware::camif::registers::{Burst, Control, DmaMode, Events, Extension, Register, Registers};
use firmware::camif::{Bus, Camif, Part};
use firmware::port::{Dma, Target, Transfer};
use std::hint::black_box;

const LINE: usize = 640 * 3;
const LINES: usize = 480;
const WORDS: u32 = (LINE * LINES / 4) as u32;

fn block<'m>(bus: Bus, first: &'m mut [u32], second: &'m mut [u32]) -> Camif<'m> {
    let mut camif = Camif::new(Part::CAMIF, bus);
    camif.lend(0, first).ok().unwrap();
    camif.lend(1, second).ok().unwrap();
    camif.aim(Target::Zero, 0, 0).unwrap();
    camif.aim(Target::One, 1, 0).unwrap();
    let (mode, burst) = (DmaMode::Double, Burst::Four);
    camif.start(Transfer { words: WORDS, mode, burst, line_by_line: false, half_interrupt: false }).unwrap();
    camif.write(Register::Extension, Extension::default().with_marker(true).raw_value());
    camif.write(Register::InterruptEnable, Events::MASK);
    let control = Control::default().with_enable(true).with_capture(true);
    camif.write(
        Register::Control,
        control.with_hsync_blank_high(true).with_vsync_blank_high(true).raw_value(),
    );
    camif
}

fn acknowledge(camif: &mut Camif<'_>) {
    if camif.interrupts().any() {
        let raised = camif.read(Register::MaskedInterrupt);
        camif.write(Register::InterruptClear, raised);
        let events = camif.events();
        camif.acknowledge(events);
    }
}

fn play(camif: &mut Camif<'_>, sync: Sync, mut samples: Samples<'_>) {
    while !samples.is_empty() {
        let played = camif.run(sync, samples);
        samples = samples.skip(played);
        acknowledge(camif);
    }
}

fn frame(camif: &mut Camif<'_>, picture: &[u8]) {
    for (number, line) in picture.chunks_exact(LINE).enumerate() {
        let (marked, rest) = line.split_at(1);
        play(camif, Sync { hsync: true, vsync: number == 0 }, Samples::Bytes(marked));
        play(camif, Sync::default(), Samples::Bytes(rest));
    }
}

fn bench(criterion: &mut Criterion) {
    let picture: Vec<u8> = (0..LINE * LINES).map(|i| (i * 7 + i / 1920) as u8).collect();
    let mut group = criterion.benchmark_group("vga-rgb888 frame");
    group.throughput(Throughput::Elements(picture.len() as u64));
    group.bench_function("memcpy of its bytes", |bencher| {
        let mut copy = vec![0; picture.len()];
        bencher.iter(|| black_box(&mut copy).copy_from_slice(black_box(&picture)));
    });
    for (name, bus) in [
        ("run, ideal bus", Bus::IDEAL),
        ("run, bus latency 0 to 3", Bus { latency_max: 3, seed: 1, ..Bus::IDEAL }),
    ] {
        group.bench_function(name, |bencher| {
            let (mut first, mut second) = (vec![0; WORDS as usize], vec![0; WORDS as usize]);
            let mut camif = block(bus, &mut first, &mut second);
            bencher.iter(|| frame(&mut camif, black_box(&picture)));
        });
    }
    group.bench_function("step", |bencher| {
        let (mut first, mut second) = (vec![0; WORDS as usize], vec![0; WORDS as usize]);
        let mut camif = block(Bus::IDEAL, &mut first, &mut second);
        bencher.iter(|| {
            for (number, line) in black_box(&picture).chunks_exact(LINE).enumerate() {
                let mut sync = Sync { hsync: true, vsync: number == 0 };
                for &byte in line {
                    camif.step(Pins { sync, data: u16::from(byte) });
                    acknowledge(&mut camif);
                    sync = Sync::default();
                }
            }
        });
    });
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
