//! OmniVision OV7670: VGA, 8 wires, a DSP that makes YUV and RGB, SCCB at 0x21.
//!
//! Sources: the data sheet, version 1.4 (§ "Register Set", table 5, and figures 5 and 6 for the timing), and the OV7670/OV7171
//! implementation guide 1.0 (§3 clock and frame rate, §4 output formats).
//!
//! Where they disagree: the data sheet has the internal clock be XCLK / (CLKRC\[5:0\] + 1); the guide halves that unless the
//! doubler, CLKRC\[7\], is on. The table turns it on with a divider of 1, where both say 24 MHz from 24 MHz. And the order
//! of Y, U and V is set by TSLB\[3\] with COM13\[0\] in one and COM13\[1\] in the other: both bits are 0 here.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::bus::Addressing;
use super::model::{Identity, Mode, Model, Power};
use super::table::{Step, Table, command, update, wait, write};
use crate::camif::pins::Edge;
use crate::camif::registers::BusWidth;
use crate::driver::config::SyncMode;

/// VSTRT and VSTOP, low bits.
pub const VREF: u16 = 0x03;
/// PID: 0x76.
pub const PID: u16 = 0x0A;
/// VER: 0x73.
pub const VER: u16 = 0x0B;
/// COM3: byte swap, scaling, down-sampling.
pub const COM3: u16 = 0x0C;
/// CLKRC: doubler, external clock, divider.
pub const CLKRC: u16 = 0x11;
/// COM7: reset, size and format.
pub const COM7: u16 = 0x12;
/// COM10: polarities of the sync wires and of PCLK.
pub const COM10: u16 = 0x15;
/// HSTART: first pixel of a line, high bits.
pub const HSTART: u16 = 0x17;
/// HSTOP: the pixel after the last, high bits.
pub const HSTOP: u16 = 0x18;
/// VSTRT: first line, high bits.
pub const VSTRT: u16 = 0x19;
/// VSTOP: the line after the last, high bits.
pub const VSTOP: u16 = 0x1A;
/// MVFP: mirror and flip.
pub const MVFP: u16 = 0x1E;
/// EXHCH: dummy pixels, high bits.
pub const EXHCH: u16 = 0x2A;
/// EXHCL: dummy pixels, low bits.
pub const EXHCL: u16 = 0x2B;
/// ADVFL: dummy lines, low bits.
pub const ADVFL: u16 = 0x2D;
/// ADVFH: dummy lines, high bits.
pub const ADVFH: u16 = 0x2E;
/// HREF: HSTART and HSTOP, low bits.
pub const HREF: u16 = 0x32;
/// TSLB: order of Y, U and V; automatic window.
pub const TSLB: u16 = 0x3A;
/// COM13: gamma, saturation, order of U and V.
pub const COM13: u16 = 0x3D;
/// COM14: divider of PCLK while scaling.
pub const COM14: u16 = 0x3E;
/// COM15: range and kind of RGB.
pub const COM15: u16 = 0x40;
/// DBLV: PLL.
pub const DBLV: u16 = 0x6B;
/// `SCALING_XSC`: horizontal scale, and the first bit of the test pattern.
pub const SCALING_XSC: u16 = 0x70;
/// `SCALING_YSC`: vertical scale, and the second bit of the test pattern.
pub const SCALING_YSC: u16 = 0x71;
/// `SCALING_DCWCTR`: down-sampling.
pub const SCALING_DCWCTR: u16 = 0x72;
/// `SCALING_PCLK_DIV`: clock of the DSP while scaling.
pub const SCALING_PCLK_DIV: u16 = 0x73;
/// RGB444.
pub const RGB444: u16 = 0x8C;
/// `SCALING_PCLK_DELAY`.
pub const SCALING_PCLK_DELAY: u16 = 0xA2;

/// The sensor.
pub static OV7670: Model = Model {
    name: "ov7670",
    // 0x42 to write and 0x43 to read (data sheet, SCCB interface).
    address: 0x21,
    addressing: Addressing::Byte,
    identity: &[Identity { register: PID, accepted: &[0x76] }, Identity { register: VER, accepted: &[0x73] }],
    // The data sheet asks for a millisecond after a reset.
    power: Power { reset_low: 1_000, settle: 1_000 },
    input_hz: 24_000_000,
    input_range_hz: (10_000_000, 48_000_000),
    reset: Table::new("reset", &[command(COM7, 0x80), wait(1_000)]),
    base: Table::new("base", BASE),
    pattern_off: Table::new(
        "test pattern off",
        &[update(SCALING_XSC, 0x80, 0), update(SCALING_YSC, 0x80, 0)],
    ),
    // 1, 0: eight colour bars.
    pattern_on: Table::new(
        "test pattern on",
        &[update(SCALING_XSC, 0x80, 0x80), update(SCALING_YSC, 0x80, 0)],
    ),
    modes: &[
        mode("vga-rgb565", (640, 480), Format::Rgb565Be, Table::new("vga-rgb565", VGA_RGB565)),
        mode("qvga-rgb565", (320, 240), Format::Rgb565Be, Table::new("qvga-rgb565", QVGA_RGB565)),
        mode("vga-yuv422", (640, 480), Format::Yuyv, Table::new("vga-yuv422", VGA_YUV422)),
        mode("qvga-yuv422", (320, 240), Format::Yuyv, Table::new("qvga-yuv422", QVGA_YUV422)),
        mode("vga-raw8", (640, 480), Format::Raw8, Table::new("vga-raw8", VGA_RAW8)),
    ],
};

const fn mode(name: &'static str, size: (u32, u32), format: Format, table: Table) -> Mode {
    let raw = matches!(format, Format::Raw8);
    Mode {
        name,
        width: size.0,
        height: size.1,
        format,
        bayer: BayerOrder::Bggr,
        bus_width: BusWidth::Bits8,
        clocks_per_pixel: if raw { 1 } else { 2 },
        // HREF is high over data, VSYNC high between frames; data changes on the falling edge of PCLK.
        sync: SyncMode::Gated { hsync_blank_high: false, vsync_blank_high: true },
        edge: Edge::Rising,
        pixel_clock: if raw || size.0 < 640 { (1, 2) } else { (1, 1) },
        table,
    }
}

const BASE: &[Step] = &[
    write(CLKRC, 0x80), // doubler on, divided by 1
    write(DBLV, 0x0A),  // PLL bypassed, regulator on
    write(COM10, 0x00), // HREF rather than HSYNC, all polarities as in figure 5
    write(TSLB, 0x04),  // the window is that of HSTART to VREF; Y first
    write(COM13, 0xC0), // gamma and automatic saturation, U before V
    // The window: pixels 158 to 798 of 784 a line, that is 14 of the next, and lines 10 to 490.
    write(HSTART, 158 >> 3),
    write(HSTOP, 14 >> 3),
    write(HREF, 0x80 | (14 & 7) << 3 | 158 & 7),
    write(VSTRT, 10 >> 2),
    write(VSTOP, 490 >> 2),
    write(VREF, (490 & 3) << 2 | 10 & 3),
    write(MVFP, 0x00),
    write(RGB444, 0x00),
    write(SCALING_XSC, 0x3A),
    write(SCALING_YSC, 0x35),
    write(SCALING_PCLK_DELAY, 0x02),
    // Reserved, and without it colours are wrong: known to everybody who brought this sensor up.
    write(0xB0, 0x84),
];

const VGA: [Step; 4] =
    [write(COM3, 0x00), write(COM14, 0x00), write(SCALING_DCWCTR, 0x00), write(SCALING_PCLK_DIV, 0xF0)];

/// Every second pixel of every second line, PCLK halved.
const QVGA: [Step; 4] =
    [write(COM3, 0x04), write(COM14, 0x19), write(SCALING_DCWCTR, 0x11), write(SCALING_PCLK_DIV, 0xF1)];

/// Levels 0x00 to 0xFF, RGB565.
const RGB565: [Step; 2] = [write(COM7, 0x04), write(COM15, 0xD0)];
const YUV422: [Step; 2] = [write(COM7, 0x00), write(COM15, 0xC0)];
/// The mosaic as it leaves the array.
const RAW: [Step; 2] = [write(COM7, 0x01), write(COM15, 0xC0)];

const fn joined(size: [Step; 4], format: [Step; 2]) -> [Step; 6] {
    [format[0], format[1], size[0], size[1], size[2], size[3]]
}

static VGA_RGB565: &[Step] = &joined(VGA, RGB565);
static QVGA_RGB565: &[Step] = &joined(QVGA, RGB565);
static VGA_YUV422: &[Step] = &joined(VGA, YUV422);
static QVGA_YUV422: &[Step] = &joined(QVGA, YUV422);
static VGA_RAW8: &[Step] = &joined(VGA, RAW);
