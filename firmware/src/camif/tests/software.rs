//! Registers as software meets them.

use super::*;
use crate::camif::{AccessWidth, BusError};

#[test]
fn every_register_resets_to_zero() {
    let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
    for register in Register::ALL {
        assert_eq!(camif.read(register), 0, "{register:?}");
    }
}

#[test]
fn any_width_but_32_bits_is_a_bus_error() {
    let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
    for width in [AccessWidth::Byte, AccessWidth::HalfWord] {
        assert_eq!(camif.bus_read(0, width), Err(BusError::Width { width, offset: 0 }));
        assert_eq!(camif.bus_write(0x0C, width, 1), Err(BusError::Width { width, offset: 0x0C }));
    }
    assert_eq!(camif.bus_read(2, AccessWidth::Word), Err(BusError::NoRegister { offset: 2 }));
    assert_eq!(camif.bus_read(0x2C, AccessWidth::Word), Err(BusError::NoRegister { offset: 0x2C }));
    camif.bus_write(0x0C, AccessWidth::Word, 0xFFFF_FFFF).unwrap();
    assert_eq!(camif.bus_read(0x0C, AccessWidth::Word), Ok(0x1F));
}

#[test]
fn read_only_registers_ignore_writes() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.play("==abcd-");
    for register in [
        Register::Status,
        Register::RawInterrupt,
        Register::MaskedInterrupt,
        Register::Data,
        Register::LineBytes,
        Register::FrameBytes,
        Register::FrameLines,
        Register::DmaStatus,
    ] {
        let before = bench.camif.peek(register);
        bench.camif.write(register, !before);
        assert_eq!(bench.camif.peek(register), before, "{register:?}");
    }
}

#[test]
fn reserved_bits_read_zero() {
    let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
    for (register, expected) in [
        (Register::Control, 0x1F_4FFF),
        (Register::InterruptEnable, 0x1F),
        (Register::SyncCode, !0),
        (Register::SyncUnmask, !0),
        (Register::CropStart, 0x1FFF_3FFF),
        (Register::CropSize, 0x3FFF_3FFF),
        (Register::Extension, 1),
        (Register::DmaTarget0, 0x7FFF_FFFF),
    ] {
        camif.write(register, !0);
        assert_eq!(camif.read(register), expected, "{register:?}");
    }
}

#[test]
fn dr_takes_words_out_of_the_fifo() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    bench.camif.stop();
    bench.play("==abcdefgh");
    assert!(bench.status().fifo_not_empty());
    assert_eq!(bench.camif.read(Register::Data).to_le_bytes(), *b"abcd");
    assert_eq!(bench.camif.read(Register::Data).to_le_bytes(), *b"efgh");
    assert!(!bench.status().fifo_not_empty());
    assert_eq!(bench.camif.read(Register::Data), 0, "an empty FIFO reads 0");
}

#[test]
fn sr_shows_the_wires_as_blank_or_not() {
    let mut memory = [0; 8];
    let mut bench = Bench::new(gated(), single(8), &mut memory);
    for (wave, hsync, vsync) in
        [("=", true, true), ("a", false, false), ("-", true, false), ("~", false, true)]
    {
        bench.play(wave);
        let status = bench.status();
        assert_eq!((status.hsync(), status.vsync()), (hsync, vsync), "{wave}");
    }
}

#[test]
fn counters_do_not_exist_on_a_part_without_them() {
    let mut memory = [0; 8];
    let mut camif = Camif::new(Part::STM32F4, Bus::IDEAL);
    camif.lend(0, &mut memory).unwrap();
    camif.aim(Target::Zero, 0, 0).unwrap();
    camif.start(single(8)).unwrap();
    camif.write(Register::Control, gated().raw_value());
    let mut bench = Bench { camif };
    bench.play("==abcd-==");
    assert_eq!(bench.memory(), "abcd");
    for register in [Register::LineBytes, Register::FrameBytes, Register::FrameLines] {
        assert_eq!(bench.camif.read(register), 0);
    }
}
