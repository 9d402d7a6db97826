//! What the registers of an OV7670 mean: data sheet 1.4, table 5 and figures 5 and 6; implementation guide 1.0, §3.
//!
//! Where the two disagree: see the driver's `firmware::sensor::ov7670`. The internal clock follows the guide (halved unless
//! CLKRC\[7\] is set), the order of U and V the bit that the guide names, COM13\[0\]. Left out: CIF and QCIF, BT.656,
//! gains, exposure, gamma and the colour matrix. The picture begins at pixel 158 of line 10.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;

use super::blanking::Lines;
use super::encoding::Encoding;
use super::readout::{Pattern, Readout, Silent};
use super::registers::Registers;
use super::view::View;
use super::virtual_sensor::Mounting;
use super::{Chip, SCCB};
use crate::profile::{Bus, Level, SyncMode};

pub(super) static CHIP: Chip = Chip {
    name: "ov7670",
    address: 0x21,
    layout: SCCB,
    reset_values: &[
        (0x0A, 0x76),
        (0x0B, 0x73),
        (0x11, 0x80),
        (0x17, 0x11),
        (0x18, 0x61),
        (0x19, 0x03),
        (0x1A, 0x7B),
        (0x1C, 0x7F),
        (0x1D, 0xA2),
        (0x1E, 0x01),
        (0x32, 0x80),
        (0x3A, 0x0D),
        (0x3D, 0x88),
        (0x3E, 0x00),
        (0x40, 0xC0),
        (0x6B, 0x0A),
        (0x70, 0x3A),
        (0x71, 0x35),
        (0x72, 0x11),
        (0x73, 0x00),
        (0xA2, 0x02),
    ],
    read_only: &[0x0A, 0x0B, 0x1C, 0x1D],
    resets: |register, value| register == 0x12 && value & 0x80 != 0,
    decode,
};

// Pixels of a line and lines of a frame, before dummies.
const LINE: u32 = 784;
const FRAME: u32 = 510;

fn decode(registers: &Registers, mounting: &Mounting) -> Result<Readout, Silent> {
    let bit = |register, bit| registers.bit(register, bit);
    let bits = |register, low, count| registers.bits(register, low, count);
    let mut notes = Vec::new();
    if bit(0x09, 4) {
        return Err(Silent::Off { reason: "COM2[4] is soft sleep" });
    }
    if bit(0x12, 5) || bit(0x12, 3) {
        return Err(Silent::NotModelled { what: "CIF and QCIF by COM7[5] and COM7[3]" });
    }
    if bit(0x04, 6) {
        return Err(Silent::NotModelled { what: "BT.656 by COM1[6]" });
    }
    // CLKRC, DBLV.
    let pll = [1, 4, 6, 8][bits(0x6B, 6, 2) as usize];
    let internal_hz = match bit(0x11, 6) {
        true => u64::from(mounting.input_hz),
        false => {
            let doubled = if bit(0x11, 7) { 2 } else { 1 };
            u64::from(mounting.input_hz) * pll * doubled / 2 / u64::from(bits(0x11, 0, 6) + 1)
        }
    };
    // COM7: the mosaic takes one clock of the internal clock's half a pixel, all else two of it.
    let encoding = match (bit(0x12, 2), bit(0x12, 0)) {
        (false, true) | (true, true) => Encoding::Format(Format::Raw8),
        (false, false) => match (bit(0x3A, 3), bit(0x3D, 0)) {
            (false, false) => Encoding::Format(Format::Yuyv),
            (false, true) => Encoding::Yvyu,
            (true, false) => Encoding::Format(Format::Uyvy),
            (true, true) => Encoding::Vyuy,
        },
        (true, false) if bit(0x8C, 1) => Encoding::Rgb444,
        (true, false) => match bits(0x40, 4, 2) {
            1 if bit(0x0C, 6) => Encoding::Format(Format::Rgb565Le),
            1 => Encoding::Format(Format::Rgb565Be),
            3 => Encoding::Rgb555,
            _ => return Err(Silent::NotModelled { what: "RGB of 8 bits by COM15[5:4]" }),
        },
    };
    let raw = encoding == Encoding::Format(Format::Raw8);
    let clocks_per_pixel: u32 = if raw { 1 } else { 2 };
    // Window, in pixels of 784 and lines of 510; dummies come after both and move nothing.
    let line = LINE + (bits(0x2A, 4, 4) << 8 | bits(0x2B, 0, 8));
    let frame = FRAME + (bits(0x2E, 0, 8) << 8 | bits(0x2D, 0, 8));
    let (first, last) = (bits(0x17, 0, 8) << 3 | bits(0x32, 0, 3), bits(0x18, 0, 8) << 3 | bits(0x32, 3, 3));
    let (top, bottom) = (bits(0x19, 0, 8) << 2 | bits(0x03, 0, 2), bits(0x1A, 0, 8) << 2 | bits(0x03, 2, 2));
    let width = if last > first { last - first } else { (last + LINE).saturating_sub(first) };
    let height = bottom.checked_sub(top).ok_or(Silent::NoFrame { reason: "VSTOP is above VSTRT" })?;
    // Down-sampling: by COM7 for QVGA, else by hand.
    let (across, down, divider) = match (bit(0x12, 4), bit(0x0C, 2) && bit(0x3E, 4)) {
        (true, _) => (2, 2, 2),
        (false, true) => (1 << bits(0x72, 0, 2), 1 << bits(0x72, 4, 2), 1 << bits(0x3E, 0, 3).min(4)),
        (false, false) if bit(0x3E, 4) => (1, 1, 1 << bits(0x3E, 0, 3).min(4)),
        (false, false) => (1, 1, 1),
    };
    if bit(0x3E, 4) && !bit(0x73, 3) && bits(0x73, 0, 3) != bits(0x3E, 0, 3) {
        notes.push("SCALING_PCLK_DIV and COM14 divide differently: real sensors tear lines");
    }
    // Array lines in pixel clocks.
    let line_clocks = line * clocks_per_pixel / divider;
    let pclk_hz = internal_hz / if raw { 2 } else { 1 } / u64::from(divider);
    let mut output = (width / across, height / down);
    let room = (line_clocks * down).saturating_sub(1) / clocks_per_pixel;
    if output.0 > room {
        notes.push("a line takes more pixel clocks than there are: its end is cut off");
        output.0 = room;
    }
    let lines = Lines {
        line: u64::from(line_clocks),
        total: u64::from(frame),
        active: u64::from(output.1 * down),
        // Line 10 comes 17 lines after VSYNC (figure 6).
        back: u64::from((top + 7).min(frame)),
        sync: 3,
    };
    let timing = lines
        .timing(u32::try_from(pclk_hz).unwrap_or(u32::MAX), output.1, output.0 * clocks_per_pixel)
        .ok_or(Silent::NoFrame { reason: "the window does not fit 510 lines and those of ADVFL" })?;
    let level = |high: bool| if high { Level::High } else { Level::Low };
    if bit(0x15, 6) {
        notes.push("COM10[6], HSYNC on the HREF pin, is taken for HREF");
    }
    if bit(0x15, 5) {
        notes.push("COM10[5], no PCLK between lines, makes no difference to a receiver");
    }
    let pattern = match (bit(0x70, 7), bit(0x71, 7), bit(0x12, 1)) {
        (true, true, _) => Some(Pattern::FadingBars),
        (true, false, _) | (false, false, true) => Some(Pattern::Bars),
        (false, true, _) => return Err(Silent::NotModelled { what: "the shifting 1 of SCALING_YSC[7]" }),
        (false, false, false) => None,
    };
    let origin = (i64::from(first) - 158, i64::from(top) - 10);
    // The order has no meaning but for the mosaic.
    let order = if raw { shifted(BayerOrder::Bggr, origin) } else { BayerOrder::Rggb };
    Readout {
        sensor: CHIP.name,
        bus: Bus {
            bits: 8,
            clock_edge: if bit(0x15, 4) { Edge::Falling } else { Edge::Rising },
            sync: SyncMode::Gated,
            hsync_blank: level(bit(0x15, 3)),
            vsync_blank: level(!bit(0x15, 1)),
        },
        timing,
        view: View { whole: (640, 480), origin, size: (output.0 * across, output.1 * down), output },
        encoding,
        bayer: order,
        mirror: bit(0x1E, 5),
        flip: bit(0x1E, 4),
        negative: bit(0x3A, 5),
        pattern,
        notes,
    }
    .checked()
}

/// The mosaic that a window starts with.
pub(super) fn shifted(order: BayerOrder, origin: (i64, i64)) -> BayerOrder {
    use BayerOrder::{Bggr, Gbrg, Grbg, Rggb};
    let across = |order| match order {
        Rggb => Grbg,
        Grbg => Rggb,
        Bggr => Gbrg,
        Gbrg => Bggr,
    };
    let down = |order| match order {
        Rggb => Gbrg,
        Gbrg => Rggb,
        Bggr => Grbg,
        Grbg => Bggr,
    };
    let order = if origin.0 & 1 == 1 { across(order) } else { order };
    if origin.1 & 1 == 1 { down(order) } else { order }
}
