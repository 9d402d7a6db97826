//! OmniVision OV2640: UXGA with a DSP that scales, 8 of its 10 wires, SCCB at 0x30, two banks of registers.
//!
//! Sources: the data sheet, version 1.6 (table 12 "Device Control Register List (when 0xFF = 00)", table 13 the same for 01,
//! figures 7 to 9 for the timing), and the software application notes 1.03 (§2 output formats, §6 frame rates).
//!
//! A register's upper byte is its bank: 0x00 the DSP's, 0x01 the sensor's. The array is read as SVGA (800 × 600), every
//! second pixel and line of it, and the DSP scales that to the output. Its raw output is 10 bits wide and not in a mode here.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::bus::Addressing;
use super::model::{Identity, Mode, Model, Power};
use super::table::{Step, Table, command, update, wait, write};
use crate::camif::pins::Edge;
use crate::camif::registers::BusWidth;
use crate::driver::config::SyncMode;

/// `BANK_SEL`, in both banks.
pub const BANK_SELECT: u8 = 0xFF;
/// `R_BYPASS`: the DSP is bypassed.
pub const R_BYPASS: u16 = 0x0005;
/// CTRLI: dividers before the zoom.
pub const CTRLI: u16 = 0x0050;
/// HSIZE: width into the zoom, in 4 pixels.
pub const HSIZE: u16 = 0x0051;
/// VSIZE: height into the zoom, in 4 lines.
pub const VSIZE: u16 = 0x0052;
/// XOFFL: left edge of what is zoomed.
pub const XOFFL: u16 = 0x0053;
/// YOFFL: upper edge of what is zoomed.
pub const YOFFL: u16 = 0x0054;
/// VHYX: high bits of the four before.
pub const VHYX: u16 = 0x0055;
/// TEST: the highest bit of HSIZE.
pub const TEST: u16 = 0x0057;
/// ZMOW: width of the output, in 4 pixels.
pub const ZMOW: u16 = 0x005A;
/// ZMOH: height of the output, in 4 lines.
pub const ZMOH: u16 = 0x005B;
/// ZMHH: high bits of both.
pub const ZMHH: u16 = 0x005C;
/// CTRL2: what of the DSP works.
pub const CTRL2: u16 = 0x0086;
/// SIZEL: low bits of HSIZE8 and VSIZE8.
pub const SIZEL: u16 = 0x008C;
/// HSIZE8: width that the sensor sends, in 8 pixels.
pub const HSIZE8: u16 = 0x00C0;
/// VSIZE8: height that the sensor sends, in 8 lines.
pub const VSIZE8: u16 = 0x00C1;
/// CTRL0: what formats the DSP makes.
pub const CTRL0: u16 = 0x00C2;
/// `R_DVP_SP`: divider of PCLK.
pub const R_DVP_SP: u16 = 0x00D3;
/// `IMAGE_MODE`: what stands on the wires.
pub const IMAGE_MODE: u16 = 0x00DA;
/// RESET of the DSP's parts.
pub const RESET: u16 = 0x00E0;
/// COM1: low bits of VSTRT and VEND.
pub const COM1: u16 = 0x0103;
/// REG04: mirror, flip.
pub const REG04: u16 = 0x0104;
/// PIDH: 0x26.
pub const PIDH: u16 = 0x010A;
/// PIDL: 0x41 or 0x42, by revision.
pub const PIDL: u16 = 0x010B;
/// CLKRC: doubler and divider.
pub const CLKRC: u16 = 0x0111;
/// COM7: reset, what of the array is read, colour bars.
pub const COM7: u16 = 0x0112;
/// COM10: polarities.
pub const COM10: u16 = 0x0115;
/// HREFST: first pixel, high bits.
pub const HREFST: u16 = 0x0117;
/// HREFEND: the pixel after the last, high bits.
pub const HREFEND: u16 = 0x0118;
/// VSTRT: first line, high bits.
pub const VSTRT: u16 = 0x0119;
/// VEND: the line after the last, high bits.
pub const VEND: u16 = 0x011A;
/// MIDH: 0x7F, of OmniVision.
pub const MIDH: u16 = 0x011C;
/// MIDL: 0xA2.
pub const MIDL: u16 = 0x011D;
/// REG32: low bits of HREFST and HREFEND.
pub const REG32: u16 = 0x0132;

/// The sensor.
pub static OV2640: Model = Model {
    name: "ov2640",
    // 0x60 to write and 0x61 to read.
    address: 0x30,
    addressing: Addressing::Banked { select: BANK_SELECT },
    identity: &[
        Identity { register: MIDH, accepted: &[0x7F] },
        Identity { register: MIDL, accepted: &[0xA2] },
        Identity { register: PIDH, accepted: &[0x26] },
        Identity { register: PIDL, accepted: &[0x42, 0x41] },
    ],
    power: Power { reset_low: 3_000, settle: 3_000 },
    input_hz: 24_000_000,
    input_range_hz: (6_000_000, 24_000_000),
    reset: Table::new("reset", &[command(COM7, 0x80), wait(5_000)]),
    base: Table::new("base", BASE),
    pattern_off: Table::new("test pattern off", &[update(COM7, 0x02, 0)]),
    pattern_on: Table::new("test pattern on", &[update(COM7, 0x02, 0x02)]),
    modes: &[
        mode("vga-rgb565", (640, 480), Format::Rgb565Be, Table::new("vga-rgb565", VGA_RGB565)),
        mode("qvga-rgb565", (320, 240), Format::Rgb565Be, Table::new("qvga-rgb565", QVGA_RGB565)),
        mode("vga-yuv422", (640, 480), Format::Yuyv, Table::new("vga-yuv422", VGA_YUV422)),
        mode("qvga-yuv422", (320, 240), Format::Yuyv, Table::new("qvga-yuv422", QVGA_YUV422)),
    ],
};

const fn mode(name: &'static str, size: (u32, u32), format: Format, table: Table) -> Mode {
    Mode {
        name,
        width: size.0,
        height: size.1,
        format,
        bayer: BayerOrder::Bggr,
        bus_width: BusWidth::Bits8,
        clocks_per_pixel: 2,
        // HREF is high over data, VSYNC high between frames; data changes on the falling edge of PCLK.
        sync: SyncMode::Gated { hsync_blank_high: false, vsync_blank_high: true },
        edge: Edge::Rising,
        pixel_clock: if size.0 < 640 { (1, 2) } else { (1, 1) },
        table,
    }
}

const BASE: &[Step] = &[
    write(CLKRC, 0x01), // no doubler, divided by 2: 15 frames a second
    write(COM10, 0x00), // all polarities as in figure 7
    write(REG04, 0x28), // HREF on, neither mirror nor flip; bit 5 is always set
    // The array as SVGA: pixels 2 × 137 to 2 × 537, lines 2 × 2 to 2 × 302.
    write(COM7, 0x40),
    write(HREFST, 0x11),
    write(HREFEND, 0x43),
    write(REG32, 0x09),
    write(VSTRT, 0x00),
    write(VEND, 0x4B),
    write(COM1, 0x0A),
    // The DSP holds its output while it is programmed; the modes end that.
    write(RESET, 0x04),
    write(R_BYPASS, 0x00),
    // All 800 × 600 of it is zoomed.
    write(HSIZE8, 800 / 8),
    write(VSIZE8, 600 / 8),
    write(SIZEL, 0x00),
    write(CTRLI, 0x00),
    write(HSIZE, 800 / 4),
    write(VSIZE, 600 / 4),
    write(XOFFL, 0x00),
    write(YOFFL, 0x00),
    write(VHYX, 0x00),
    write(TEST, 0x00),
    write(CTRL2, 0x3D), // down-sampling, special effects, U and V, colour matrix
];

/// Output size, divider of PCLK, format, and off it goes.
const fn steps(size: (u16, u16), divider: u16, control: u16, image: u16) -> [Step; 7] {
    [
        write(ZMOW, size.0 / 4),
        write(ZMOH, size.1 / 4),
        write(ZMHH, 0x00),
        write(R_DVP_SP, divider),
        write(CTRL0, control),
        write(IMAGE_MODE, image),
        write(RESET, 0x00),
    ]
}

static VGA_RGB565: &[Step] = &steps((640, 480), 1, 0x0E, 0x08);
static QVGA_RGB565: &[Step] = &steps((320, 240), 2, 0x0E, 0x08);
static VGA_YUV422: &[Step] = &steps((640, 480), 1, 0x0C, 0x00);
static QVGA_YUV422: &[Step] = &steps((320, 240), 2, 0x0C, 0x00);
