//! What the registers of an OV5640 mean: data sheet 2.03, chapters 2 (PLL), 4 (windowing), 6 (video port), 7.
//!
//! The window of the array is stepped over, loses its offsets on all sides, and is scaled to the output. Left out: JPEG,
//! MIPI, BT.656, gains and exposure. The picture is the 2,560 × 1,920 pixels from (32, 16) on. How blanking is divided before
//! and behind VSYNC is the model's.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;

use super::blanking::Lines;
use super::encoding::Encoding;
use super::ov7670::shifted;
use super::readout::{Pattern, Readout, Silent};
use super::registers::Registers;
use super::view::View;
use super::virtual_sensor::Mounting;
use super::{Chip, Layout};
use crate::profile::{Bus, Level, SyncMode};

pub(super) static CHIP: Chip = Chip {
    name: "ov5640",
    address: 0x3C,
    layout: Layout { address_bytes: 2, data_bytes: 1, bank_select: None, repeated_start: false },
    reset_values: &[
        (0x3008, 0x02),
        (0x300A, 0x56),
        (0x300B, 0x40),
        (0x300E, 0x58),
        (0x3034, 0x1A),
        (0x3035, 0x11),
        (0x3036, 0x69),
        (0x3037, 0x03),
        (0x3108, 0x16),
        (0x3804, 0x0A),
        (0x3805, 0x3F),
        (0x3806, 0x07),
        (0x3807, 0x9F),
        (0x3808, 0x0A),
        (0x3809, 0x20),
        (0x380A, 0x07),
        (0x380B, 0x98),
        (0x380C, 0x0B),
        (0x380D, 0x1C),
        (0x380E, 0x07),
        (0x380F, 0xB0),
        (0x3811, 0x10),
        (0x3813, 0x04),
        (0x3814, 0x11),
        (0x3815, 0x11),
        (0x3820, 0x40),
        (0x3824, 0x01),
        (0x4300, 0xF8),
        (0x460C, 0x20),
        (0x4740, 0x20),
        (0x5001, 0x01),
    ],
    read_only: &[0x300A, 0x300B],
    resets: |register, value| register == 0x3008 && value & 0x80 != 0,
    decode,
};

fn decode(registers: &Registers, mounting: &Mounting) -> Result<Readout, Silent> {
    let bit = |register, bit| registers.bit(register, bit);
    let bits = |register, low, count| registers.bits(register, low, count);
    if bit(0x3008, 6) {
        return Err(Silent::Off { reason: "0x3008[6] is power-down by software" });
    }
    if bits(0x3017, 4, 3) != 0b111 {
        return Err(Silent::Off { reason: "0x3017[6:4] keeps VSYNC, HREF or PCLK from driving" });
    }
    if bits(0x3017, 0, 4) != 0b1111 || bits(0x3018, 4, 4) != 0b1111 {
        return Err(Silent::Off { reason: "0x3017[3:0] or 0x3018[7:4] keeps data wires from driving" });
    }
    if bit(0x300E, 2) {
        return Err(Silent::Off { reason: "0x300E[2] has MIPI instead of the parallel port" });
    }
    let clocks = Clocks::of(registers, mounting)?;
    let encoding = match (bits(0x4300, 4, 4), bits(0x4300, 0, 4), bits(0x501F, 0, 3)) {
        (0, _, 3..=5) => Encoding::Format(Format::Raw8),
        (3, 0, 0) => Encoding::Format(Format::Yuyv),
        (3, 1, 0) => Encoding::Yvyu,
        (3, 2 | 0xF, 0) => Encoding::Format(Format::Uyvy),
        (3, 3, 0) => Encoding::Vyuy,
        (6, 0, 1) => Encoding::Bgr565,
        (6, 1, 1) => Encoding::Format(Format::Rgb565Be),
        (6, 0xF, 1) => Encoding::Format(Format::Rgb565Le),
        (0 | 3 | 6, _, _) => {
            return Err(Silent::NoFrame { reason: "0x501F does not bring what 0x4300 puts on the wires" });
        }
        _ => return Err(Silent::NotModelled { what: "the format of 0x4300[7:4]" }),
    };
    let raw = encoding == Encoding::Format(Format::Raw8);
    let clocks_per_pixel = if raw { 1 } else { 2 };
    let step = |register| bits(register, 4, 4).midpoint(bits(register, 0, 4)).max(1);
    let (across, down) = (step(0x3814), step(0x3815));
    let (first, top) = (registers.pair(0x3800), registers.pair(0x3802));
    let window = (
        (registers.pair(0x3804) + 1).saturating_sub(first) / across,
        (registers.pair(0x3806) + 1).saturating_sub(top) / down,
    );
    let offset = (registers.pair(0x3810), registers.pair(0x3812));
    let inner = (window.0.saturating_sub(2 * offset.0), window.1.saturating_sub(2 * offset.1));
    let output = (registers.pair(0x3808), registers.pair(0x380A));
    if output.0 > inner.0 || output.1 > inner.1 {
        return Err(Silent::NoFrame { reason: "the output is larger than the window less its offsets" });
    }
    let scaling = bit(0x5001, 5);
    if scaling && raw {
        return Err(Silent::NoFrame { reason: "the scaler, 0x5001[5], takes no mosaic" });
    }
    // Without the scaler the output is the window's upper left part.
    let used = if scaling { inner } else { output };
    let (line, total) = (u64::from(registers.pair(0x380C)), u64::from(registers.pair(0x380E)));
    if u64::from(window.0) > line && across == 1 && scaling {
        return Err(Silent::NoFrame { reason: "HTS is shorter than the window" });
    }
    let lines = Lines {
        line: line * clocks.pclk_hz / clocks.sclk_hz.max(1),
        total,
        active: u64::from(used.1),
        back: 12,
        sync: 4,
    };
    let timing = lines
        .timing(u32::try_from(clocks.pclk_hz).unwrap_or(u32::MAX), output.1, output.0 * clocks_per_pixel)
        .ok_or(Silent::NoFrame { reason: "PCLK is too slow for a line, or VTS too short for the window" })?;
    let origin = (i64::from(first + offset.0 * across) - 32, i64::from(top + offset.1 * down) - 16);
    let level = |high: bool| if high { Level::High } else { Level::Low };
    Readout {
        sensor: CHIP.name,
        bus: Bus {
            bits: 8,
            clock_edge: if bit(0x4740, 5) { Edge::Rising } else { Edge::Falling },
            sync: SyncMode::Gated,
            hsync_blank: level(bit(0x4740, 1)),
            vsync_blank: level(!bit(0x4740, 0)),
        },
        timing,
        view: View { whole: (2_560, 1_920), origin, size: (used.0 * across, used.1 * down), output },
        encoding,
        bayer: if raw { shifted(BayerOrder::Bggr, origin) } else { BayerOrder::Rggb },
        mirror: bits(0x3821, 1, 2) != 0,
        flip: bits(0x3820, 1, 2) != 0,
        negative: false,
        pattern: match (bit(0x503D, 7), bits(0x503D, 0, 2)) {
            (false, _) => None,
            (true, 0) => Some(Pattern::Bars),
            (true, _) => return Err(Silent::NotModelled { what: "the test pattern of 0x503D[1:0]" }),
        },
        notes: Vec::new(),
    }
    .checked()
}

/// Clocks in hertz: of a pixel of the array, and of the wires.
struct Clocks {
    sclk_hz: u64,
    pclk_hz: u64,
}

impl Clocks {
    /// Chapter 2: input / pre-divider × multiplier / system / root / bits, then a root divider each.
    fn of(registers: &Registers, mounting: &Mounting) -> Result<Self, Silent> {
        let bits = |register, low, count| registers.bits(register, low, count);
        let input = u64::from(mounting.input_hz);
        let root = if registers.bit(0x3103, 1) {
            let [pre, system] = [bits(0x3037, 0, 4), bits(0x3035, 4, 4)].map(|value| match value {
                0 => 16,
                value => u64::from(value),
            });
            let vco = input * u64::from(bits(0x3036, 0, 8)) / pre;
            if !(400_000_000..=1_200_000_000).contains(&vco) {
                return Err(Silent::NoFrame { reason: "the PLL would run below 400 MHz or above 1,200 MHz" });
            }
            let halved = if registers.bit(0x3037, 4) { 2 } else { 1 };
            let tenths = match bits(0x3034, 0, 4) {
                8 => 20,
                10 => 25,
                _ => 10,
            };
            vco * 10 / system / halved / tenths
        } else {
            input
        };
        let divider = match (registers.bit(0x460C, 1), bits(0x3824, 0, 5)) {
            (false, _) | (true, 0) => 1,
            (true, divider) => u64::from(divider),
        };
        let pclk_hz = root >> bits(0x3108, 4, 2);
        Ok(Self { sclk_hz: root >> bits(0x3108, 0, 2), pclk_hz: pclk_hz / divider })
    }
}
