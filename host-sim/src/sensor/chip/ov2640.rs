//! What the registers of an OV2640 mean: data sheet 1.6, tables 12 and 13, figures 7 to 9; application notes 1.03, §6.
//!
//! The sensor reads its array as UXGA, SVGA or CIF; the DSP takes a part of that and scales it down. Left out: raw and JPEG
//! output, the DSP bypassed, zoom inside the sensor, gains and exposure. How blanking is divided before and behind VSYNC is
//! the model's. The picture begins at HREFST and VSTRT as the data sheet has them for each way to read the array.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;

use super::blanking::Lines;
use super::encoding::Encoding;
use super::readout::{Pattern, Readout, Silent};
use super::registers::Registers;
use super::view::View;
use super::virtual_sensor::Mounting;
use super::{Chip, Layout};
use crate::profile::{Bus, Level, SyncMode};

pub(super) static CHIP: Chip = Chip {
    name: "ov2640",
    address: 0x30,
    layout: Layout { address_bytes: 1, data_bytes: 1, bank_select: Some(0xFF), repeated_start: false },
    reset_values: &[
        (0x0005, 0x01),
        (0x00C0, 0xC8),
        (0x00C1, 0x96),
        (0x00D3, 0x02),
        (0x0103, 0x0F),
        (0x0104, 0x20),
        (0x010A, 0x26),
        (0x010B, 0x42),
        (0x0117, 0x11),
        (0x0118, 0x75),
        (0x0119, 0x01),
        (0x011A, 0x97),
        (0x011C, 0x7F),
        (0x011D, 0xA2),
        (0x0132, 0x36),
    ],
    read_only: &[0x010A, 0x010B, 0x011C, 0x011D],
    resets: |register, value| register == 0x0112 && value & 0x80 != 0,
    decode,
};

/// One way to read the array.
struct Reading {
    /// Clocks a line and lines a frame.
    clocks: u32,
    lines: u32,
    /// Where the picture begins, as HREFST and VSTRT count, and its size.
    first: (u32, u32),
    size: (u32, u32),
}

const UXGA: Reading = Reading { clocks: 1_922, lines: 1_248, first: (0x8E, 7), size: (1_600, 1_200) };
const SVGA: Reading = Reading { clocks: 1_190, lines: 672, first: (0x89, 2), size: (800, 600) };

fn decode(registers: &Registers, mounting: &Mounting) -> Result<Readout, Silent> {
    let bit = |register, bit| registers.bit(register, bit);
    let bits = |register, low, count| registers.bits(register, low, count);
    let mut notes = Vec::new();
    if bit(0x0109, 4) {
        return Err(Silent::Off { reason: "COM2[4] is soft sleep" });
    }
    if bit(0x00E0, 2) {
        return Err(Silent::Off { reason: "RESET[2] holds the video port in reset" });
    }
    if bit(0x0005, 0) {
        return Err(Silent::NotModelled { what: "the DSP bypassed by R_BYPASS[0]" });
    }
    let reading = match bits(0x0112, 4, 3) {
        0 => &UXGA,
        4 => &SVGA,
        _ => return Err(Silent::NotModelled { what: "CIF by COM7[6:4]" }),
    };
    let encoding = match bits(0x00DA, 2, 3) {
        0 if bit(0x00C2, 3) && bit(0x00C2, 2) => match (bit(0x00DA, 0), bit(0x00C2, 4)) {
            (false, false) => Encoding::Format(Format::Yuyv),
            (false, true) => Encoding::Yvyu,
            (true, false) => Encoding::Format(Format::Uyvy),
            (true, true) => Encoding::Vyuy,
        },
        2 if bit(0x00C2, 1) => match bit(0x00DA, 0) {
            false => Encoding::Format(Format::Rgb565Be),
            true => Encoding::Format(Format::Rgb565Le),
        },
        0 | 2 => return Err(Silent::NoFrame { reason: "IMAGE_MODE asks for what CTRL0 does not make" }),
        _ => return Err(Silent::NotModelled { what: "raw and JPEG by IMAGE_MODE" }),
    };
    // What the sensor sends, in units of two pixels and two lines.
    let (first, last) =
        (bits(0x0117, 0, 8) << 3 | bits(0x0132, 0, 3), bits(0x0118, 0, 8) << 3 | bits(0x0132, 3, 3));
    let (top, bottom) =
        (bits(0x0119, 0, 8) << 2 | bits(0x0103, 0, 2), bits(0x011A, 0, 8) << 2 | bits(0x0103, 2, 2));
    let sent = (2 * last.saturating_sub(first), 2 * bottom.saturating_sub(top));
    // What of it the DSP takes.
    let taken = (
        bits(0x00C0, 0, 8) << 3 | bits(0x008C, 3, 3) | bits(0x008C, 6, 1) << 11,
        bits(0x00C1, 0, 8) << 3 | bits(0x008C, 0, 3),
    );
    if taken.0 > sent.0 || taken.1 > sent.1 {
        return Err(Silent::NoFrame { reason: "HSIZE8 or VSIZE8 is more than the sensor's window sends" });
    }
    let zoomed = (
        (bits(0x0051, 0, 8) | bits(0x0055, 3, 1) << 8 | bits(0x0057, 7, 1) << 9) * 4,
        (bits(0x0052, 0, 8) | bits(0x0055, 7, 1) << 8) * 4,
    );
    let offset = (bits(0x0053, 0, 8) | bits(0x0055, 0, 3) << 8, bits(0x0054, 0, 8) | bits(0x0055, 4, 3) << 8);
    if offset.0 + zoomed.0 > taken.0 || offset.1 + zoomed.1 > taken.1 {
        return Err(Silent::NoFrame {
            reason: "HSIZE, VSIZE and their offsets reach past HSIZE8 and VSIZE8",
        });
    }
    let output = (
        (bits(0x005A, 0, 8) | bits(0x005C, 0, 2) << 8) * 4,
        (bits(0x005B, 0, 8) | bits(0x005C, 2, 1) << 8) * 4,
    );
    let divided = (zoomed.0 >> bits(0x0050, 0, 3), zoomed.1 >> bits(0x0050, 3, 3));
    if output.0 > divided.0 || output.1 > divided.1 {
        return Err(Silent::NoFrame {
            reason: "the zoom does not enlarge: ZMOW or ZMOH is more than it gets",
        });
    }
    // Clocks: sensor, system (twice it), PCLK.
    let doubled = if bit(0x0111, 7) { 2 } else { 1 };
    let sensor_hz = u64::from(mounting.input_hz) * doubled / u64::from(bits(0x0111, 0, 6) + 1);
    let divider = match bits(0x00D3, 0, 7) {
        0 => 1,
        divider => u64::from(divider),
    };
    if bit(0x00D3, 7) {
        notes.push("R_DVP_SP[7], automatic PCLK, is taken as the divider in its other bits");
    }
    let pclk_hz = 2 * sensor_hz / divider;
    let lines = Lines {
        line: u64::from(reading.clocks) * 2 / divider,
        total: u64::from(reading.lines),
        active: u64::from(zoomed.1),
        back: u64::from(top + 16),
        sync: 4,
    };
    let timing = lines.timing(u32::try_from(pclk_hz).unwrap_or(u32::MAX), output.1, output.0 * 2).ok_or(
        Silent::NoFrame { reason: "PCLK is too slow for a line, or the window too high for a frame" },
    )?;
    let level = |high: bool| if high { Level::High } else { Level::Low };
    let origin = (
        2 * (i64::from(first) - i64::from(reading.first.0)) + i64::from(offset.0),
        2 * (i64::from(top) - i64::from(reading.first.1)) + i64::from(offset.1),
    );
    Readout {
        sensor: CHIP.name,
        bus: Bus {
            bits: 8,
            clock_edge: if bit(0x0115, 4) { Edge::Falling } else { Edge::Rising },
            sync: SyncMode::Gated,
            hsync_blank: level(bit(0x0115, 3)),
            vsync_blank: level(!bit(0x0115, 1)),
        },
        timing,
        view: View { whole: reading.size, origin, size: zoomed, output },
        encoding,
        bayer: BayerOrder::Rggb,
        mirror: bit(0x0104, 7),
        flip: bit(0x0104, 6),
        negative: false,
        pattern: bit(0x0112, 1).then_some(Pattern::Bars),
        notes,
    }
    .checked()
}
