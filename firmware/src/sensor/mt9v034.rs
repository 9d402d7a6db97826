//! Aptina (onsemi) MT9V034: wide VGA with a global shutter, 10 wires, two-wire interface at 0x48 with data of 16 bits.
//!
//! Source: the data sheet MT9V034 ("Two-Wire Serial Interface", "Output Data Timing" with its table "Frame Time", and the
//! register tables).
//!
//! The address is 0x48, 0x4C, 0x58 or 0x5C by the pins `S_CTRL_ADR1` and `S_CTRL_ADR0`; here both are low. FRAME_VALID is
//! high over a frame and LINE_VALID over a line; PIXCLK is SYSCLK inverted, so its rising edge is in the middle of the data.
//!
//! The modes named `gray8` are for the monochrome part with its upper eight wires, D9 to D2, on D7 to D0 of the interface.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::bus::Addressing;
use super::model::{Identity, Mode, Model, Power};
use super::table::{Step, Table, command, wait, write};
use crate::camif::pins::Edge;
use crate::camif::registers::BusWidth;
use crate::driver::config::SyncMode;

/// Chip version: 0x1324.
pub const CHIP_VERSION: u16 = 0x00;
/// First column, from 1.
pub const COLUMN_START: u16 = 0x01;
/// First row, from 4.
pub const ROW_START: u16 = 0x02;
/// Rows of the array that are read.
pub const WINDOW_HEIGHT: u16 = 0x03;
/// Columns of the array that are read.
pub const WINDOW_WIDTH: u16 = 0x04;
/// Clocks of horizontal blanking.
pub const HORIZONTAL_BLANKING: u16 = 0x05;
/// Rows of vertical blanking.
pub const VERTICAL_BLANKING: u16 = 0x06;
/// Master or slave, outputs on or off.
pub const CHIP_CONTROL: u16 = 0x07;
/// Soft reset.
pub const RESET: u16 = 0x0C;
/// Binning, flips.
pub const READ_MODE: u16 = 0x0D;
/// Row noise correction.
pub const ROW_NOISE: u16 = 0x70;
/// Polarities of the sync wires and PIXCLK.
pub const PIXEL_CLOCK: u16 = 0x72;
/// Test pattern.
pub const TEST_PATTERN: u16 = 0x7F;
/// Automatic exposure and gain.
pub const AUTOMATIC: u16 = 0xAF;

/// The sensor.
pub static MT9V034: Model = Model {
    name: "mt9v034",
    address: 0x48,
    addressing: Addressing::ByteWithWord,
    identity: &[Identity { register: CHIP_VERSION, accepted: &[0x1324] }],
    power: Power { reset_low: 1_000, settle: 1_000 },
    input_hz: 24_000_000,
    input_range_hz: (13_000_000, 27_000_000),
    // Back by itself within 15 clocks.
    reset: Table::new("reset", &[command(RESET, 0x0001), wait(100)]),
    base: Table::new("base", BASE),
    pattern_off: Table::new("test pattern off", &[write(TEST_PATTERN, 0x0000)]),
    // Gray from one side to the other; row noise correction, which would spoil it, is off in the base table.
    pattern_on: Table::new("test pattern on", &[write(TEST_PATTERN, 0x2800)]),
    modes: &[
        mode("vga-raw10", (640, 480), Format::Raw10, Table::new("vga", VGA)),
        mode("qvga-raw10", (320, 240), Format::Raw10, Table::new("qvga", QVGA)),
        mode("vga-gray8", (640, 480), Format::Gray8, Table::new("vga", VGA)),
        mode("qvga-gray8", (320, 240), Format::Gray8, Table::new("qvga", QVGA)),
    ],
};

const fn mode(name: &'static str, size: (u32, u32), format: Format, table: Table) -> Mode {
    Mode {
        name,
        width: size.0,
        height: size.1,
        format,
        bayer: BayerOrder::Grbg,
        bus_width: if matches!(format, Format::Gray8) { BusWidth::Bits8 } else { BusWidth::Bits10 },
        clocks_per_pixel: 1,
        sync: SyncMode::Gated { hsync_blank_high: false, vsync_blank_high: false },
        edge: Edge::Rising,
        // Binning two columns halves PIXCLK.
        pixel_clock: if size.0 < 640 { (1, 2) } else { (1, 1) },
        table,
    }
}

const BASE: &[Step] = &[
    write(CHIP_CONTROL, 0x0388), // master, simultaneous exposure, outputs on
    write(PIXEL_CLOCK, 0x0000),
    write(ROW_NOISE, 0x0000),
    write(AUTOMATIC, 0x0003), // exposure and gain
    // The middle 640 of 752 columns.
    write(COLUMN_START, 1 + (752 - 640) / 2),
    write(ROW_START, 4),
    write(WINDOW_WIDTH, 640),
    write(WINDOW_HEIGHT, 480),
    write(HORIZONTAL_BLANKING, 94),
    write(VERTICAL_BLANKING, 45),
];

static VGA: &[Step] = &[write(READ_MODE, 0x0300)];
/// Two columns and two rows binned: the colours of a mosaic with them.
static QVGA: &[Step] = &[write(READ_MODE, 0x0305)];
