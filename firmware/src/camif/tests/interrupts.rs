//! When events are raised, enabled and cleared.

use super::*;

#[test]
fn vsync_is_raised_with_capture_off() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated().with_capture(false), single(8), &mut memory);
    bench.play("==abcd-==");
    assert_eq!(bench.events(), "VSYNC LINE");
    assert_eq!(bench.memory(), "");
}

#[test]
fn line_is_raised_on_the_edge_to_blanking() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("==abcd");
    assert_eq!(bench.events(), "");
    bench.play("-");
    assert_eq!(bench.events(), "LINE");
    bench.play("----efgh");
    assert_eq!(bench.events(), "");
}

#[test]
fn a_frame_end_inside_a_line_ends_the_line() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("==abcd-efgh~");
    assert_eq!(bench.events(), "FRAME VSYNC LINE", "LINE is the first line's");
    assert_eq!(bench.camif.peek(Register::FrameLines), 2);
    assert_eq!(bench.camif.peek(Register::FrameBytes), 8);
}

#[test]
fn mis_is_ris_and_ier() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    let line = Events::default().with_line(true).raw_value();
    bench.camif.write(Register::InterruptEnable, line);
    bench.play("==abcd-==");
    assert_eq!(bench.camif.read(Register::RawInterrupt), 0b11001);
    assert_eq!(bench.camif.read(Register::MaskedInterrupt), line);
    assert!(bench.camif.interrupts().camif);
}

#[test]
fn writing_one_clears_and_writing_zero_does_not() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.camif.write(Register::InterruptEnable, Events::MASK);
    bench.play("==abcd-==");
    bench.camif.write(Register::InterruptClear, Events::default().with_vsync(true).raw_value());
    assert_eq!(bench.camif.read(Register::RawInterrupt), 0b10001);
    assert!(bench.camif.interrupts().camif);
    bench.camif.write(Register::InterruptClear, Events::MASK);
    assert_eq!(bench.camif.read(Register::RawInterrupt), 0);
    assert!(!bench.camif.interrupts().camif);
    assert_eq!(bench.camif.read(Register::InterruptClear), 0);
}

#[test]
fn run_returns_after_the_clock_that_raises_an_interrupt() {
    use crate::camif::pins::Samples;
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.camif.write(Register::InterruptEnable, Events::default().with_line(true).raw_value());
    bench.play("==abcd");
    let blank = Samples::Repeat { value: 0, clocks: 50 };
    let between_lines = Sync { hsync: true, vsync: false };
    assert_eq!(bench.camif.run(between_lines, blank), 1, "the edge");
    assert_eq!(
        bench.camif.run(between_lines, blank.skip(1)),
        49,
        "an interrupt that stays active stops nothing"
    );
}
