//! Which frames are taken.

use super::*;
use crate::camif::registers::FrameRate;

const FRAME_A: &str = "==abcd-efgh-==";
const FRAME_B: &str = "==ijkl-mnop-==";

#[test]
fn a_snapshot_takes_one_frame_and_clears_capture() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated().with_snapshot(true), single(8), &mut memory);
    bench.play("==abcd-");
    assert!(bench.control().capture());
    bench.play("efgh-==");
    assert!(!bench.control().capture());
    bench.play(FRAME_B);
    assert_eq!(bench.memory(), "abcdefgh");
}

#[test]
fn continuous_capture_takes_frame_after_frame() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play(FRAME_A).play(FRAME_B);
    assert_eq!(bench.memory(), "abcdefghijklmnop");
    assert!(bench.control().capture());
}

#[test]
fn clearing_capture_takes_effect_at_the_frame_end() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("==abcd-");
    bench.camif.write(Register::Control, gated().with_capture(false).raw_value());
    assert!(bench.control().capture(), "reads 1 until it stops");
    bench.play("efgh-==");
    assert!(!bench.control().capture());
    bench.play(FRAME_B);
    assert_eq!(bench.memory(), "abcdefgh");
}

#[test]
fn capture_set_again_before_the_frame_end_goes_on() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("==abcd-");
    bench.camif.write(Register::Control, gated().with_capture(false).raw_value());
    bench.camif.write(Register::Control, gated().raw_value());
    bench.play("efgh-==").play(FRAME_B);
    assert_eq!(bench.memory(), "abcdefghijklmnop");
}

#[test]
fn capture_set_during_a_frame_waits_for_the_next() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated().with_capture(false), single(8), &mut memory);
    bench.play("==abcd-");
    bench.camif.write(Register::Control, gated().raw_value());
    bench.play("efgh-==").play(FRAME_B);
    assert_eq!(bench.memory(), "ijklmnop");
}

#[test]
fn frame_rate_takes_one_of_two_or_four_frames() {
    for (rate, expected) in [
        (FrameRate::All, "aaaabbbbccccddddeeee"),
        (FrameRate::Half, "aaaacccceeee"),
        (FrameRate::Quarter, "aaaaeeee"),
    ] {
        let mut memory = [0; 8];
        let mut bench = Bench::new(gated().with_frame_rate(rate), single(8), &mut memory);
        for frame in ["==aaaa-==", "==bbbb-==", "==cccc-==", "==dddd-==", "==eeee-=="] {
            bench.play(frame);
        }
        assert_eq!(bench.memory(), expected);
    }
}

#[test]
fn a_snapshot_ignores_the_frame_rate() {
    let mut memory = [0; 8];
    let control = gated().with_snapshot(true).with_frame_rate(FrameRate::Quarter);
    let mut bench = Bench::new(control, single(8), &mut memory);
    bench.play(FRAME_A);
    bench.camif.write(Register::Control, control.raw_value());
    bench.play(FRAME_B);
    assert_eq!(bench.memory(), "abcdefghijklmnop");
}

#[test]
fn an_overrun_empties_the_fifo_and_waits_for_the_next_frame_start() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.camif.bus_mut().hold = Some(crate::camif::Hold { request: 1, clocks: 40 });
    // The first word moves; the second waits for the bus until the FIFO of four words is full.
    bench.play("==abcdefghijklmnopqrstuvwx");
    assert_eq!(bench.events(), "OVR");
    assert!(!bench.status().fifo_not_empty());
    bench.play("yzyzyzyz-==");
    assert_eq!(bench.events(), "VSYNC LINE", "no FRAME: it is lost");
    assert!(bench.control().capture());
    bench.play("====================").play(FRAME_B);
    assert_eq!(bench.memory(), "abcdijklmnop", "the DMA's position is not rewound");
}

#[test]
fn the_fifo_holds_four_words_and_the_fifth_overruns() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.camif.stop();
    bench.play("==abcdefghijklmnopqrs");
    assert_eq!(bench.events(), "");
    assert_eq!(bench.camif.fifo_level(), 4);
    bench.play("t");
    assert_eq!(bench.events(), "OVR");
}

#[test]
fn an_overrun_of_a_snapshot_clears_capture() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated().with_snapshot(true), single(8), &mut memory);
    bench.camif.stop();
    bench.play("==abcdefghijklmnopqrst");
    assert_eq!(bench.events(), "OVR");
    assert!(!bench.control().capture());
}

#[test]
fn jpeg_pads_the_last_word_with_zeros() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated().with_jpeg(true), single(8), &mut memory);
    bench.play("==ab-c---de-f~==");
    assert_eq!(bench.memory(), "abcdef", "HSYNC is data enable, and the sixth byte is not lost");
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("==ab-c---de-f~==");
    assert_eq!(bench.memory(), "abcd", "outside JPEG an incomplete word at the frame's end is dropped");
}

#[test]
fn disabling_resets_the_capture_side() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.camif.stop();
    bench.play("==abcdef");
    assert!(bench.status().fifo_not_empty());
    bench.camif.write(Register::Control, 0);
    assert!(!bench.status().fifo_not_empty());
    bench.camif.write(Register::Control, gated().raw_value());
    bench.play("ghij-==");
    assert!(!bench.status().fifo_not_empty(), "the frame under way is not resumed");
}
