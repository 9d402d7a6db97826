//! OmniVision OV5640: five megapixels with a scaler, 8 of its 10 wires, SCCB at 0x3C with addresses of 16 bits.
//!
//! Sources: the data sheet, version 2.03 (chapter 2 for power-up and PLL, 4 for windowing and test pattern, 6 for the digital
//! video port, 7 for the register tables), and the application notes for the parallel port 2.13 (clock).
//!
//! Where they disagree: the register table has 1 in 0x4740\[1:0\] mean "active high"; boards that work agree that with both
//! bits 0, their reset values, HREF is high over data and VSYNC is high between frames. The table leaves them so.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::bus::Addressing;
use super::model::{Identity, Mode, Model, Power};
use super::table::{Step, Table, command, update, wait, write};
use crate::camif::pins::Edge;
use crate::camif::registers::BusWidth;
use crate::driver::config::SyncMode;

/// `SYSTEM CTRL0`: reset and power-down by software.
pub const SYSTEM: u16 = 0x3008;
/// Chip identity, high byte: 0x56.
pub const CHIP_ID_HIGH: u16 = 0x300A;
/// Chip identity, low byte: 0x40.
pub const CHIP_ID_LOW: u16 = 0x300B;
/// MIPI or parallel port.
pub const MIPI_CONTROL: u16 = 0x300E;
/// Pads that drive: FREX, VSYNC, HREF, PCLK, D9 to D6.
pub const PAD_OUTPUT_1: u16 = 0x3017;
/// Pads that drive: D5 to D0.
pub const PAD_OUTPUT_2: u16 = 0x3018;
/// Bits a sample, which divide the PLL's clock.
pub const PLL_BITS: u16 = 0x3034;
/// System divider of the PLL.
pub const PLL_SYSTEM: u16 = 0x3035;
/// Multiplier of the PLL.
pub const PLL_MULTIPLIER: u16 = 0x3036;
/// Divider before the PLL, and its root divider.
pub const PLL_PRE: u16 = 0x3037;
/// Clock from the pad or the PLL.
pub const CLOCK_SELECT: u16 = 0x3103;
/// Root dividers of PCLK and SCLK.
pub const ROOT_DIVIDER: u16 = 0x3108;
/// Eight registers of the array's window: first and last column and line, high byte first.
pub const WINDOW: u16 = 0x3800;
/// Width of the output, high byte.
pub const OUTPUT_WIDTH: u16 = 0x3808;
/// Height of the output, high byte.
pub const OUTPUT_HEIGHT: u16 = 0x380A;
/// HTS: clocks a line, high byte.
pub const LINE_LENGTH: u16 = 0x380C;
/// VTS: lines a frame, high byte.
pub const FRAME_LENGTH: u16 = 0x380E;
/// Offset of the picture in the window, high byte.
pub const OFFSET_X: u16 = 0x3810;
/// The same, vertically.
pub const OFFSET_Y: u16 = 0x3812;
/// Steps over the array's columns: odd and even.
pub const STEP_X: u16 = 0x3814;
/// The same over its lines.
pub const STEP_Y: u16 = 0x3815;
/// Flip and binning of lines.
pub const FLIP: u16 = 0x3820;
/// Mirror and binning of columns.
pub const MIRROR: u16 = 0x3821;
/// Divider of PCLK, where [`PCLK_MANUAL`] says so.
pub const PCLK_DIVIDER: u16 = 0x3824;
/// What stands on the wires.
pub const FORMAT: u16 = 0x4300;
/// Whether PCLK is divided by [`PCLK_DIVIDER`].
pub const PCLK_MANUAL: u16 = 0x460C;
/// Polarities.
pub const POLARITY: u16 = 0x4740;
/// Parts of the ISP: scaling among them.
pub const ISP_CONTROL_1: u16 = 0x5001;
/// What of the ISP goes to the format.
pub const FORMAT_MUX: u16 = 0x501F;
/// Test pattern.
pub const TEST_PATTERN: u16 = 0x503D;

/// The sensor.
pub static OV5640: Model = Model {
    name: "ov5640",
    // 0x78 to write and 0x79 to read.
    address: 0x3C,
    addressing: Addressing::Word,
    identity: &[
        Identity { register: CHIP_ID_HIGH, accepted: &[0x56] },
        Identity { register: CHIP_ID_LOW, accepted: &[0x40] },
    ],
    // Power-up (chapter 2): at least 1 ms from power-down low to reset high, 20 ms to the first access.
    power: Power { reset_low: 5_000, settle: 20_000 },
    input_hz: 24_000_000,
    input_range_hz: (6_000_000, 27_000_000),
    reset: Table::new(
        "reset",
        &[command(CLOCK_SELECT, 0x11), command(SYSTEM, 0x82), wait(10_000), command(SYSTEM, 0x42)],
    ),
    base: Table::new("base", BASE),
    pattern_off: Table::new("test pattern off", &[update(TEST_PATTERN, 0x80, 0)]),
    // Eight colour bars.
    pattern_on: Table::new("test pattern on", &[update(TEST_PATTERN, 0x83, 0x80)]),
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
        sync: SyncMode::Gated { hsync_blank_high: false, vsync_blank_high: true },
        edge: Edge::Rising,
        // 24 MHz / 3 × 70 / 2 / 2 / 2.5 = 56 MHz, divided by 2 or 4.
        pixel_clock: if raw || size.0 < 640 { (7, 12) } else { (7, 6) },
        table,
    }
}

const BASE: &[Step] = &[
    write(CLOCK_SELECT, 0x03),
    write(PAD_OUTPUT_1, 0x7F),
    write(PAD_OUTPUT_2, 0xFC),
    write(MIPI_CONTROL, 0x58), // MIPI off, parallel port on
    // 24 MHz / 3 × 70 = 560 MHz, by 2 (system), 2 (root) and 2.5 (ten bits): 56 MHz; SCLK half of it.
    write(PLL_BITS, 0x1A),
    write(PLL_SYSTEM, 0x21),
    write(PLL_MULTIPLIER, 70),
    write(PLL_PRE, 0x13),
    write(ROOT_DIVIDER, 0x01),
    write(PCLK_MANUAL, 0x22),
    write(POLARITY, 0x20), // PCLK rises in the middle of the data
    // 1,896 clocks a line and 984 lines: 15 frames a second.
    write(LINE_LENGTH, 1_896 >> 8),
    write(LINE_LENGTH + 1, 1_896 & 0xFF),
    write(FRAME_LENGTH, 984 >> 8),
    write(FRAME_LENGTH + 1, 984 & 0xFF),
];

/// A window of the array, and how it is stepped over.
struct Window {
    first: (u16, u16),
    last: (u16, u16),
    offset: (u16, u16),
    /// Every second pair of columns and lines, binned; else all of them.
    half: bool,
}

/// All of the array, for the scaler (data sheet, chapter 4).
const WHOLE: Window = Window { first: (0, 4), last: (2_623, 1_947), offset: (16, 6), half: true };
/// Its middle, pixel by pixel: the scaler takes no mosaic.
const MIDDLE: Window = Window { first: (984, 732), last: (1_639, 1_219), offset: (8, 4), half: false };

const fn steps(window: &Window, size: (u16, u16), pclk_divider: u16, format: u16, mux: u16) -> [Step; 24] {
    const fn high(value: u16) -> u16 {
        value >> 8
    }
    const fn low(value: u16) -> u16 {
        value & 0xFF
    }
    let (step, bin) = if window.half { (0x31, 1) } else { (0x11, 0) };
    [
        write(WINDOW, high(window.first.0)),
        write(WINDOW + 1, low(window.first.0)),
        write(WINDOW + 2, high(window.first.1)),
        write(WINDOW + 3, low(window.first.1)),
        write(WINDOW + 4, high(window.last.0)),
        write(WINDOW + 5, low(window.last.0)),
        write(WINDOW + 6, high(window.last.1)),
        write(WINDOW + 7, low(window.last.1)),
        write(OUTPUT_WIDTH, high(size.0)),
        write(OUTPUT_WIDTH + 1, low(size.0)),
        write(OUTPUT_HEIGHT, high(size.1)),
        write(OUTPUT_HEIGHT + 1, low(size.1)),
        write(OFFSET_X + 1, low(window.offset.0)),
        write(OFFSET_Y + 1, low(window.offset.1)),
        write(STEP_X, step),
        write(STEP_Y, step),
        write(FLIP, 0x40 | bin),
        write(MIRROR, bin),
        write(PCLK_DIVIDER, pclk_divider),
        write(FORMAT, format),
        write(FORMAT_MUX, mux),
        // Effects, scaling, colour matrix, white balance.
        write(ISP_CONTROL_1, if window.half { 0xA3 } else { 0x83 }),
        write(SYSTEM, 0x02),
        wait(1_000),
    ]
}

static VGA_RGB565: &[Step] = &steps(&WHOLE, (640, 480), 2, 0x61, 0x01);
static QVGA_RGB565: &[Step] = &steps(&WHOLE, (320, 240), 4, 0x61, 0x01);
static VGA_YUV422: &[Step] = &steps(&WHOLE, (640, 480), 2, 0x30, 0x00);
static QVGA_YUV422: &[Step] = &steps(&WHOLE, (320, 240), 4, 0x30, 0x00);
static VGA_RAW8: &[Step] = &steps(&MIDDLE, (640, 480), 4, 0x00, 0x03);
