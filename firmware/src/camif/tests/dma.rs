//! The burst DMA and the bus.

use super::*;
use crate::camif::Stall;
use crate::camif::registers::{DmaControl, DmaStatus};
use crate::port::DmaError;

fn flags(bench: &mut Bench<'_>) -> String {
    let events = bench.camif.events();
    bench.camif.acknowledge(events);
    [(events.half, "half"), (events.complete, "complete"), (events.error, "error")]
        .iter()
        .filter_map(|&(set, name)| set.then_some(name))
        .collect::<Vec<_>>()
        .join(" ")
}

#[test]
fn a_single_transfer_stops_and_then_the_fifo_overruns() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(2), &mut memory);
    bench.play("==abcde");
    assert_eq!(flags(&mut bench), "half");
    bench.play("fghi");
    assert_eq!(flags(&mut bench), "complete");
    bench.play("jklmnopqrstuvwxyz...");
    assert_eq!(bench.events(), "OVR");
    assert_eq!(bench.memory(), "abcdefgh");
}

#[test]
fn a_circular_transfer_starts_again_at_its_target() {
    let mut memory = [0; 2];
    let mut bench = Bench::new(gated(), Transfer { mode: DmaMode::Circular, ..single(2) }, &mut memory);
    bench.play("==abcdefghijkl-==");
    assert_eq!(bench.memory(), "ijklefgh");
}

#[test]
fn a_double_buffer_alternates_between_its_targets() {
    let mut memory = [0; 4];
    let mut bench = Bench::new(gated(), Transfer { mode: DmaMode::Double, ..single(2) }, &mut memory);
    assert_eq!(bench.camif.target(), Target::Zero);
    bench.play("==abcdefghi");
    assert_eq!(bench.camif.target(), Target::One);
    bench.play("jklmnopq");
    assert_eq!(bench.camif.target(), Target::Zero);
    bench.play("rst-==");
    assert_eq!(bench.memory(), "qrstefghijklmnop");
}

#[test]
fn the_target_in_use_is_locked() {
    let mut memory = [0; 4];
    let mut bench = Bench::new(gated(), Transfer { mode: DmaMode::Double, ..single(1) }, &mut memory);
    let before = bench.camif.peek(Register::DmaTarget0);
    bench.camif.write(Register::DmaTarget0, 3);
    assert_eq!(bench.camif.peek(Register::DmaTarget0), before);
    bench.camif.write(Register::DmaTarget1, 2);
    assert_eq!(bench.camif.peek(Register::DmaTarget1), 2);
}

#[test]
fn a_burst_waits_until_it_is_full() {
    for (burst, words) in [(Burst::One, 1), (Burst::Two, 2), (Burst::Four, 4)] {
        let mut memory = [0; 8];
        let mut bench = Bench::new(gated(), Transfer { burst, ..single(8) }, &mut memory);
        bench.play("==");
        for _ in 0..words * 4 {
            assert_eq!(bench.camif.requests(), 0, "{burst:?}");
            bench.play("x");
        }
        assert_eq!(bench.camif.requests(), 1);
        bench.play("y");
        assert_eq!(bench.camif.peek(Register::DmaCount), 8 - words);
    }
}

#[test]
fn a_frame_end_flushes_a_burst_that_is_not_full() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), Transfer { burst: Burst::Four, ..single(8) }, &mut memory);
    bench.play("==abcdefgh-=");
    assert_eq!(bench.memory(), "abcdefgh");
}

#[test]
fn line_by_line_each_line_fills_a_transfer_of_its_own() {
    let mut memory = [0; 4];
    let transfer = Transfer { mode: DmaMode::Double, line_by_line: true, burst: Burst::Four, ..single(2) };
    let mut bench = Bench::new(gated(), transfer, &mut memory);
    bench.play("==abcde");
    bench.play("-=");
    assert_eq!(bench.camif.events().line_words, 2, "a short line ends its transfer early, padded to a word");
    assert_eq!(flags(&mut bench), "half complete");
    bench.play("=ijklmnopqrst-=");
    assert_eq!(flags(&mut bench), "half complete");
    assert_eq!(bench.camif.events().line_words, 2, "the rest of a long line is dropped");
    let bytes: Vec<u8> = bench.camif.lent(0).unwrap().iter().flat_map(|word| word.to_le_bytes()).collect();
    assert_eq!(bytes, b"abcde\0\0\0ijklmnop");
}

#[test]
fn a_target_outside_lent_memory_is_an_error_and_stops() {
    let mut memory = [0; 4];
    let mut bench = Bench::new(gated(), Transfer { mode: DmaMode::Double, ..single(1) }, &mut memory);
    bench.camif.write(Register::DmaTarget1, 3 << 28);
    bench.play("==abcdefghi");
    assert_eq!(flags(&mut bench), "complete error");
    assert!(!DmaControl::new_with_raw_value(bench.camif.peek(Register::DmaControl)).enable());
}

#[test]
fn a_count_is_cut_to_the_bits_that_the_part_has() {
    let mut camif = Camif::new(Part::STM32F4, Bus::IDEAL);
    camif.write(Register::DmaCount, 65_536 + 5);
    assert_eq!(camif.read(Register::DmaCount), 5);
}

#[test]
fn the_seam_refuses_what_the_part_cannot_do() {
    let mut memory = [0; 4];
    let mut camif = Camif::new(Part::STM32F4, Bus::IDEAL);
    assert_eq!(camif.aim(Target::Zero, 0, 0), Err(DmaError::NotLent { slot: 0 }));
    camif.lend(0, &mut memory).unwrap();
    assert_eq!(camif.aim(Target::Zero, 0, 4), Err(DmaError::OutOfBounds { slot: 0, needed: 5, lent: 4 }));
    camif.aim(Target::Zero, 0, 1).unwrap();
    assert_eq!(camif.start(single(4)), Err(DmaError::OutOfBounds { slot: 0, needed: 5, lent: 4 }));
    let too_long = DmaError::TransferLength { words: 65_536, limit: 65_535 };
    assert_eq!(camif.start(single(65_536)), Err(too_long));
    assert!(camif.start(Transfer { line_by_line: true, ..single(1) }).is_err());
}

#[test]
fn lent_memory_comes_back_only_when_nothing_aims_at_it() {
    let (mut first, mut second) = ([0; 1], [0; 1]);
    let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
    camif.lend(0, &mut first).unwrap();
    camif.lend(1, &mut second).unwrap();
    assert!(camif.lend(1, &mut []).is_err(), "the slot is taken");
    camif.aim(Target::Zero, 0, 0).unwrap();
    camif.start(single(1)).unwrap();
    assert!(camif.take_back(0).is_none());
    assert!(camif.take_back(1).is_some());
    camif.stop();
    assert!(camif.take_back(0).is_some());
}

#[test]
fn interrupts_of_the_dma_are_enabled_one_by_one() {
    for (half, expected_at) in [(true, 1), (false, 2)] {
        let mut memory = [0; 2];
        let mut bench = Bench::new(gated(), Transfer { half_interrupt: half, ..single(2) }, &mut memory);
        bench.play("==abcd");
        bench.play("e");
        assert_eq!(bench.camif.interrupts().dma, expected_at == 1);
        bench.play("fghi");
        assert!(bench.camif.interrupts().dma);
        bench.camif.write(Register::DmaClear, DmaStatus::MASK);
        assert!(!bench.camif.interrupts().dma);
    }
}

#[test]
fn a_slow_bus_overruns_just_when_the_fifo_is_full() {
    // A burst of one word is requested at the 4th clock; the 5th word comes 16 clocks later, and a grant takes one.
    for (latency, overruns) in [(15, false), (16, true)] {
        let mut memory = [0; 64];
        let mut bench = Bench::new(gated(), single(64), &mut memory);
        *bench.camif.bus_mut() =
            Bus { hold: Some(crate::camif::Hold { request: 0, clocks: latency }), ..Bus::IDEAL };
        bench.play("==abcdefghijklmnopqrstuvwxyz-==");
        assert_eq!(bench.events().contains("OVR"), overruns, "latency {latency}");
    }
}

#[test]
fn stalls_are_repeated_by_their_seed() {
    let run = |seed| {
        let mut memory = [0; 64];
        let mut bench = Bench::new(gated(), single(64), &mut memory);
        let stall = Some(Stall { one_in: 4, clocks: 9 });
        *bench.camif.bus_mut() = Bus { latency_max: 4, stall, seed, ..Bus::IDEAL };
        bench.play("==abcdefghijklmnopqrstuvwxyz0123456789abcdefghijklmnopqrstuvwxyz0123456789-==");
        (bench.events(), bench.memory())
    };
    assert_eq!(run(1), run(1));
    assert!((2..20).any(|seed| run(seed) != run(1)));
}

#[test]
fn a_bus_error_stops_the_dma_and_the_words_before_it_stay() {
    let mut memory = [0; 4];
    let mut bench = Bench::new(gated(), Transfer { mode: DmaMode::Double, ..single(2) }, &mut memory);
    bench.camif.bus_mut().error = Some(1);
    bench.play("==abcdefgh");
    assert_eq!(flags(&mut bench), "half error");
    assert!(!DmaControl::new_with_raw_value(bench.camif.peek(Register::DmaControl)).enable());
    bench.play("ijkl");
    assert_eq!(bench.memory(), "abcd");
}
