//! How the wires, or codes in the data, say where frames and lines are.

use super::*;
use crate::camif::pins::Edge;
use crate::camif::registers::{BusWidth, SyncCodes};

#[test]
fn data_while_a_wire_is_blank_is_ignored() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("==abcd---efgh~~~==");
    assert_eq!(bench.memory(), "abcdefgh");
}

#[test]
fn polarity_bits_give_the_blanking_level() {
    for (hsync_high, vsync_high) in [(false, false), (false, true), (true, false), (true, true)] {
        let mut memory = [0; 4];
        let control = gated().with_hsync_blank_high(hsync_high).with_vsync_blank_high(vsync_high);
        let mut bench = Bench::new(control, single(4), &mut memory);
        for (h_blank, v_blank, data) in [(true, true, "....."), (false, false, "wxyz"), (true, true, ".....")]
        {
            for byte in data.bytes() {
                let sync = Sync { hsync: h_blank == hsync_high, vsync: v_blank == vsync_high };
                bench.camif.step(Pins { sync, data: u16::from(byte) });
            }
        }
        assert_eq!(bench.memory(), "wxyz", "HSPOL {hsync_high} VSPOL {vsync_high}");
    }
}

#[test]
fn the_selected_clock_edge_samples_the_pins() {
    for rising in [false, true] {
        let mut memory = [0; 4];
        let mut bench = Bench::new(gated().with_sample_on_rising(rising), single(4), &mut memory);
        for (on_rising, on_falling) in "==abcd==".bytes().zip("==efgh==".bytes()) {
            for (edge, byte) in [(Edge::Rising, on_rising), (Edge::Falling, on_falling)] {
                let blank = byte == b'=';
                let sync = Sync { hsync: blank, vsync: blank };
                bench.camif.clock_edge(edge, Pins { sync, data: u16::from(byte) });
            }
        }
        assert_eq!(bench.memory(), if rising { "abcd" } else { "efgh" });
    }
}

#[test]
fn capture_starts_when_vsync_goes_inactive() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("abcd-efgh-");
    assert_eq!(bench.memory(), "", "a frame that was under way at ENABLE is not taken");
    bench.play("==ijkl-==");
    assert_eq!(bench.memory(), "ijkl");
}

#[test]
fn samples_wider_than_a_byte_are_zero_extended_to_16_bits_two_a_word() {
    for (width, mask) in [(BusWidth::Bits10, 0x3FF), (BusWidth::Bits12, 0xFFF), (BusWidth::Bits14, 0x3FFF)] {
        let mut memory = [0; 2];
        let mut bench = Bench::new(gated().with_bus_width(width), single(2), &mut memory);
        bench.play("==");
        for data in [0xFFFF, 0x0123, 0xFEDC, 0x0001] {
            bench.camif.step(Pins { sync: Sync::default(), data });
        }
        bench.play("==").camif.elapse(10);
        let expected = [0xFFFF & mask | 0x0123 << 16, 0xFEDC & mask | 1 << 16];
        assert_eq!(bench.camif.lent(0).unwrap(), expected, "{width:?}");
    }
}

#[test]
fn an_8_bit_bus_ignores_the_wires_above() {
    let mut memory = [0; 1];
    let mut bench = Bench::new(gated(), single(1), &mut memory);
    bench.play("==");
    for data in [0x1141, 0x2242, 0x3343, 0xFF44] {
        bench.camif.step(Pins { sync: Sync::default(), data });
    }
    assert_eq!(bench.memory(), "ABCD");
}

#[test]
fn a_marker_says_that_line_and_frame_ended_before_its_sample() {
    let mut memory = [0; 16];
    let mut bench = Bench::marker(single(16), &mut memory);
    bench.play("abcd");
    assert_eq!(bench.events(), "");
    bench.play("Efgh");
    assert_eq!(bench.events(), "LINE");
    assert_eq!(bench.camif.peek(Register::LineBytes), 4);
    bench.play("1jkl");
    assert_eq!(bench.events(), "FRAME VSYNC LINE");
    assert_eq!(bench.camif.peek(Register::FrameBytes), 8);
    assert_eq!(bench.camif.peek(Register::FrameLines), 2);
    assert_eq!(bench.memory(), "abcdEfgh1jkl", "every clock carries data, marked or not");
}

#[test]
fn one_idle_clock_closes_the_last_marked_frame() {
    let mut memory = [0; 16];
    let mut bench = Bench::marker(single(16), &mut memory);
    bench.play("abcdEfgh");
    assert_eq!(bench.events(), "LINE");
    bench.play("0");
    assert_eq!(bench.events(), "FRAME VSYNC LINE");
    assert_eq!(bench.memory(), "abcdEfgh");
}

#[test]
fn a_marker_held_for_several_clocks_counts_once() {
    let mut memory = [0; 16];
    let mut bench = Bench::marker(single(16), &mut memory);
    bench.play("abcdEFGHijklMNop0");
    assert_eq!(bench.camif.peek(Register::FrameLines), 3, "abcd EFGHijkl MNop");
}

#[test]
fn the_marker_mode_does_not_exist_on_a_part_without_it() {
    let mut camif = Camif::new(Part::STM32F4, Bus::IDEAL);
    camif.write(Register::Extension, 1);
    assert_eq!(camif.read(Register::Extension), 0);
}

const BT656: u32 = 0xFF9D_80FF;

fn embedded(codes: u32, unmask: u32, memory: &mut [u32]) -> Bench<'_> {
    let words = memory.len() as u32;
    let mut bench = Bench::new(Control::default(), single(words), memory);
    bench.camif.write(Register::SyncCode, codes);
    bench.camif.write(Register::SyncUnmask, unmask);
    // The polarity bits would make every clock blank, were they not ignored.
    let control = Control::default().with_capture(true).with_enable(true).with_embedded_sync(true);
    bench.camif.write(Register::Control, control.raw_value());
    bench
}

#[test]
fn bt656_takes_the_frame_after_the_first_frame_end() {
    let mut memory = [0; 8];
    let mut bench = embedded(BT656, !0, &mut memory);
    bench.bytes(b"\xFF\0\0\x80lost\xFF\0\0\x9D");
    assert_eq!(bench.events(), "", "no frame end was seen yet");
    bench.bytes(b"\xFF\0\0\xAB....\xFF\0\0\xB6");
    bench.bytes(b"..\xFF\0\0\x80abcd\xFF\0\0\x9D..\xFF\0\0\x80efgh\xFF\0\0\x9D");
    assert_eq!(bench.events(), "LINE");
    bench.bytes(b"....\xFF\0\0\xAB");
    assert_eq!(bench.events(), "FRAME VSYNC");
    assert_eq!(bench.memory(), "abcdefgh");
}

#[test]
fn embedded_codes_are_programmable_and_masked() {
    let mut memory = [0; 8];
    let codes =
        SyncCodes::default().with_frame_start(1).with_line_start(2).with_line_end(3).with_frame_end(4);
    let mut bench = embedded(codes.raw_value(), 0x0F0F_0F0F, &mut memory);
    bench.bytes(b"\xFF\0\0\xA1\xFF\0\0\xB2abcd\xFF\0\0\xC3\xFF\0\0\xD4");
    assert_eq!(bench.events(), "FRAME VSYNC LINE");
    assert_eq!(bench.memory(), "abcd");
}

#[test]
fn a_sync_error_empties_the_fifo_and_waits_for_the_next_frame() {
    let mut memory = [0; 8];
    let codes = 0x0403_0201;
    let mut bench = embedded(codes, !0, &mut memory);
    bench.camif.bus_mut().latency_min = 1000;
    bench.camif.bus_mut().latency_max = 1000;
    bench.bytes(b"\xFF\0\0\x01\xFF\0\0\x02abcdefgh...\xFF\0\0\x02");
    assert_eq!(bench.events(), "ERR");
    assert!(!bench.status().fifo_not_empty());
    *bench.camif.bus_mut() = Bus::IDEAL;
    bench.camif.elapse(1000);
    bench.bytes(b"ijkl\xFF\0\0\x03\xFF\0\0\x01\xFF\0\0\x02mnop\xFF\0\0\x03\xFF\0\0\x04");
    assert_eq!(bench.events(), "FRAME VSYNC LINE");
    assert_eq!(bench.memory(), "mnop");
}
