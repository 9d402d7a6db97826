//! Crop window, byte and line selection.

use super::*;
use crate::camif::registers::{ByteSelect, CropSize, CropStart};

/// A block that crops `width` clocks from `x` on, and `height` lines from `y` on.
fn crop(control: Control, (x, y): (u32, u32), (width, height): (u32, u32), memory: &mut [u32]) -> Bench<'_> {
    let words = memory.len() as u32;
    let mut bench = Bench::new(Control::default(), single(words), memory);
    let start = CropStart::new_with_raw_value(y << 16 | x);
    let size = CropSize::new_with_raw_value((height - 1) << 16 | (width - 1));
    bench.camif.write(Register::CropStart, start.raw_value());
    bench.camif.write(Register::CropSize, size.raw_value());
    bench.camif.write(Register::Control, control.with_crop(true).raw_value());
    bench
}

const FRAME: &str = "==abcdefgh-ijklmnop-qrstuvwx-==";

#[test]
fn the_crop_window_counts_pixel_clocks_and_lines() {
    let mut memory = [0; 8];
    let mut bench = crop(gated(), (2, 1), (4, 2), &mut memory);
    bench.play(FRAME);
    assert_eq!(bench.memory(), "klmnstuv");
}

#[test]
fn a_window_wider_than_the_picture_takes_the_picture_only() {
    let mut memory = [0; 8];
    let mut bench = crop(gated(), (4, 2), (400, 400), &mut memory);
    bench.play(FRAME);
    assert_eq!(bench.memory(), "uvwx");
    assert_eq!(bench.events(), "FRAME VSYNC LINE");
}

#[test]
fn frame_is_set_after_the_last_line_of_the_window() {
    let mut memory = [0; 8];
    let mut bench = crop(gated(), (0, 0), (4, 2), &mut memory);
    bench.play("==abcdefgh-ijklmnop");
    assert_eq!(bench.events(), "LINE");
    bench.play("-");
    assert_eq!(bench.events(), "FRAME LINE");
    bench.play("qrstuvwx-==");
    assert_eq!(bench.events(), "VSYNC LINE", "once a frame");
}

#[test]
fn frame_is_set_at_the_frame_end_for_an_empty_window() {
    let mut memory = [0; 8];
    let mut bench = crop(gated(), (0, 100), (4, 1), &mut memory);
    bench.play("==abcdefgh-");
    assert_eq!(bench.events(), "LINE", "LINE comes for lines outside the window");
    bench.play("==");
    assert_eq!(bench.events(), "FRAME VSYNC");
    assert_eq!(bench.memory(), "");
}

#[test]
fn crop_is_ignored_in_jpeg() {
    let mut memory = [0; 8];
    let mut bench = crop(gated().with_jpeg(true), (2, 1), (4, 1), &mut memory);
    bench.play(FRAME);
    assert_eq!(bench.memory(), "abcdefghijklmnopqrstuvwx");
}

#[test]
fn byte_select_takes_one_of_two_one_of_four_or_two_of_four() {
    for (select, odd, expected) in [
        (ByteSelect::All, false, "abcdefgh"),
        (ByteSelect::All, true, "abcdefgh"),
        (ByteSelect::OneOfTwo, false, "aceg"),
        (ByteSelect::OneOfTwo, true, "bdfh"),
        (ByteSelect::TwoOfFour, false, "abef"),
        (ByteSelect::TwoOfFour, true, "cdgh"),
        (ByteSelect::OneOfFour, false, "aeim"),
        (ByteSelect::OneOfFour, true, "bfjn"),
    ] {
        let mut memory = [0; 8];
        let control = gated().with_byte_select(select).with_byte_select_odd(odd);
        let mut bench = Bench::new(control, single(8), &mut memory);
        bench.play("==abcdefghijklmnop-==");
        assert_eq!(&bench.memory()[..expected.len()], expected, "{select:?} odd {odd}");
    }
}

#[test]
fn line_select_takes_one_line_of_two() {
    for (odd, expected) in [(false, "aaaacccc"), (true, "bbbb")] {
        let mut memory = [0; 8];
        let control = gated().with_line_select(true).with_line_select_odd(odd);
        let mut bench = Bench::new(control, single(8), &mut memory);
        bench.play("==aaaa-bbbb-cccc-==");
        assert_eq!(bench.memory(), expected);
        assert_eq!(bench.camif.peek(Register::FrameLines), expected.len() as u32 / 4);
    }
}

#[test]
fn selection_does_not_exist_on_a_part_without_it() {
    let mut camif = Camif::new(Part::STM32F4, Bus::IDEAL);
    camif.write(Register::Control, !0);
    assert_eq!(camif.read(Register::Control), 0x4FFF);
    let mut camif = Camif::new(Part::STM32H7, Bus::IDEAL);
    camif.write(Register::Control, !0);
    assert_eq!(camif.read(Register::Control), 0x1F_4FFF);
}
