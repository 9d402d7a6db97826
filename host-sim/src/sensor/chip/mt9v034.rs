//! What the registers of an MT9V034 mean: data sheet, "Output Data Timing" with its table "Frame Time", and the register tables.
//!
//! Left out: slave mode, context B, interlaced readout, LVDS, companding, gains and exposure, LINE_VALID during vertical
//! blanking. The picture is the whole array of 752 × 480 from column 1 of row 4 on. Binned pixels of a mosaic are gray.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;

use super::encoding::Encoding;
use super::ov7670::shifted;
use super::readout::{Pattern, Readout, Silent};
use super::registers::Registers;
use super::view::View;
use super::virtual_sensor::Mounting;
use super::{Chip, Layout};
use crate::profile::{Bus, Level, SyncMode, Timing};

pub(super) static CHIP: Chip = Chip {
    name: "mt9v034",
    address: 0x48,
    layout: Layout { address_bytes: 1, data_bytes: 2, bank_select: None, repeated_start: true },
    reset_values: &[
        (0x00, 0x1324),
        (0x01, 0x0001),
        (0x02, 0x0004),
        (0x03, 0x01E0),
        (0x04, 0x02F0),
        (0x05, 0x005E),
        (0x06, 0x002D),
        (0x07, 0x0388),
        (0x0B, 0x01E0),
        (0x0D, 0x0300),
        (0xAF, 0x0003),
    ],
    read_only: &[0x00],
    resets: |register, value| register == 0x0C && value & 1 != 0,
    decode,
};

/// Clocks from the end of a frame's last line to the fall of FRAME_VALID ("Frame Time", P2).
const FRAME_END: u32 = 23;

fn decode(registers: &Registers, mounting: &Mounting) -> Result<Readout, Silent> {
    let bit = |register, bit| registers.bit(register, bit);
    let bits = |register, low, count| registers.bits(register, low, count);
    let mut notes = Vec::new();
    if !bit(0x07, 7) {
        return Err(Silent::Off { reason: "R0x07[7] turns the outputs off" });
    }
    if !bit(0x07, 3) {
        return Err(Silent::NotModelled { what: "slave mode by R0x07[3]" });
    }
    if bit(0x07, 15) {
        return Err(Silent::NotModelled { what: "context B by R0x07[15]" });
    }
    if bits(0x72, 2, 2) != 0 {
        return Err(Silent::NotModelled { what: "LINE_VALID during vertical blanking by R0x72[3:2]" });
    }
    let binning = |low| match bits(0x0D, low, 2) {
        0 => Ok(1),
        1 => Ok(2),
        2 => Ok(4),
        _ => Err(Silent::NoFrame { reason: "R0x0D[3:0] has a binning of 3, which is none" }),
    };
    let (down, across) = (binning(0)?, binning(2)?);
    let (first, top) = (u32::from(registers.get(0x01)), u32::from(registers.get(0x02)));
    let (width, height) = (u32::from(registers.get(0x04)), u32::from(registers.get(0x03)));
    if width > 752 || height > 480 {
        return Err(Silent::NoFrame { reason: "the window is larger than 752 × 480" });
    }
    let least = 61 + 10 * (across - 1);
    let mut blanking = u32::from(registers.get(0x05));
    if blanking < least {
        notes.push("R0x05, horizontal blanking, is below its least value, which is taken");
        blanking = least;
    }
    if width + blanking < 690 {
        notes.push("a row is shorter than 690 clocks, which is what the sensor needs and takes");
        blanking = 690 - width;
    }
    // In master clocks; binned columns halve and quarter PIXCLK.
    let rows = u32::from(registers.get(0x06));
    let vblank = blanking + rows * (width + blanking) + 4;
    let timing = Timing {
        pclk_hz: mounting.input_hz / across,
        hblank: blanking / across,
        vblank: vblank / across,
        vfront: FRAME_END / across,
        vback: (blanking - FRAME_END) / across,
    };
    let output = (width / across, height / down);
    let origin = (i64::from(first) - 1, i64::from(top) - 4);
    let gray = mounting.monochrome || across > 1 || down > 1;
    let encoding = match (mounting.wires, gray) {
        (8, true) => Encoding::Format(Format::Gray8),
        (8, false) => Encoding::Format(Format::Raw8),
        (10, true) => Encoding::Luma10,
        (10, false) => Encoding::Format(Format::Raw10),
        _ => return Err(Silent::NotModelled { what: "a mounting with other than 8 or 10 data wires" }),
    };
    let pattern = match (bit(0x7F, 13), bits(0x7F, 11, 2)) {
        (false, _) => None,
        (true, 1) => Some(Pattern::RampX),
        (true, 2) => Some(Pattern::RampY),
        (true, 3) => Some(Pattern::RampDiagonal),
        (true, _) => return Err(Silent::NotModelled { what: "the plain test pattern of R0x7F" }),
    };
    let level = |high: bool| if high { Level::High } else { Level::Low };
    Readout {
        sensor: CHIP.name,
        bus: Bus {
            bits: mounting.wires,
            clock_edge: if bit(0x72, 4) { Edge::Falling } else { Edge::Rising },
            sync: SyncMode::Gated,
            hsync_blank: level(bit(0x72, 0)),
            vsync_blank: level(bit(0x72, 1)),
        },
        timing,
        view: View { whole: (752, 480), origin, size: (output.0 * across, output.1 * down), output },
        encoding,
        bayer: shifted(BayerOrder::Grbg, origin),
        mirror: bit(0x0D, 5),
        flip: bit(0x0D, 4),
        negative: false,
        pattern,
        notes,
    }
    .checked()
}
