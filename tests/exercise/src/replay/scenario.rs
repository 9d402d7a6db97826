//! Which trace, which configuration, which bus, and what goes wrong when.

use algos_nostd::image::Rgb;
use algos_nostd::quantize::Probe;
use firmware::camif::Bus;
use firmware::camif::registers::SyncCodes;
use firmware::driver::Config;
use firmware::driver::config::{Damaged, Policy, SyncMode};
use firmware::pipeline::{Balance, Norm, Output, Palette, Settings, Smoothing, Thresholds};

/// Something that goes wrong for some ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disturbance {
    /// The first tick of it, from 0.
    pub from: u64,
    /// How many there are.
    pub ticks: u64,
    /// What it is.
    pub what: Trouble,
}

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// The block's interrupt is masked, and the main loop is busy elsewhere.
    Masked,
    /// The pixel clock stands still; the trace goes on after it.
    Silence,
    /// VSYNC is stuck at this level.
    Vsync(bool),
    /// HSYNC is stuck at this level.
    Hsync(bool),
    /// The memory bus is another one.
    Bus(Bus),
    /// The main loop holds what it has taken, and takes nothing more.
    Nap,
}

impl Disturbance {
    /// This tick is one of them.
    #[must_use]
    pub fn covers(&self, tick: u64) -> bool {
        (self.from..self.from + self.ticks).contains(&tick)
    }
}

/// A camera of a scenario.
#[derive(Clone, Copy, Debug)]
pub struct Scenario {
    /// Its name, and that of its trace.
    pub name: &'static str,
    /// The profile of the trace, by its name on the host.
    pub profile: &'static str,
    /// Frames in the trace.
    pub frames: u64,
    /// Faults of the trace, as `host-sim inject` takes them.
    pub faults: &'static [&'static str],
    /// The first frame that has them, and the first that has them no more; as the wires count, from 1 where blanking
    /// comes before the first frame.
    pub faulty: (u64, u64),
    /// The memory bus.
    pub bus: Bus,
    /// What goes wrong while the trace plays.
    pub disturbance: Option<Disturbance>,
    /// Capture is line by line.
    pub lines: bool,
    /// How frames are taken.
    pub policy: Policy,
    /// Ticks that the main loop waits for a frame or line.
    pub patience: u64,
    /// Frames that are not as configured are handed out.
    pub deliver_damaged: bool,
    /// Frames are kept until none comes any more for want of a buffer, then all are given back.
    pub hoard: bool,
    /// What must be seen, in the words of [`outcome`](super::consumer::outcome) and [`cause`](super::consumer::cause), and
    /// nothing else.
    pub seen: &'static [&'static str],
    /// Frames of the trace that may be missing at most. The last one never may.
    pub missing: usize,
}

/// Nothing goes wrong.
pub(super) const CLEAN: Scenario = Scenario {
    name: "",
    profile: SMALL,
    frames: 4,
    faults: &[],
    faulty: (0, 0),
    bus: Bus::IDEAL,
    disturbance: None,
    lines: false,
    policy: Policy::InOrder,
    patience: 300,
    deliver_damaged: false,
    hoard: false,
    seen: &[],
    missing: 0,
};

/// The profiles of the faults: small, so that many frames pass.
pub(super) const SMALL: &str = "small-gated";
/// The same with markers and without blanking.
pub(super) const SMALL_MARKER: &str = "small-marker";
/// The same with codes in the data, two bytes a pixel.
pub(super) const SMALL_EMBEDDED: &str = "small-embedded";
/// Their size.
pub const SMALL_SIZE: (u32, u32) = (64, 48);
/// Words of a buffer for a line of so many pixels: three bytes a pixel, whatever the format.
#[must_use]
pub const fn line_words(width: u32) -> usize {
    (width * 3).div_ceil(4) as usize
}

/// Words of a buffer for a frame of this width and height. Host and images lend the same: the driver's record tells how much.
#[must_use]
pub const fn frame_words((width, height): (u32, u32)) -> usize {
    (width * height * 3).div_ceil(4) as usize
}

/// Frames that a scenario has at most.
pub const MOST_FRAMES: usize = 16;

/// The profile of what is looked at: no larger than a serial line carries.
const QVGA: &str = "qvga-gated";
/// Its size.
pub const STREAM_SIZE: (u32, u32) = (320, 240);

/// VGA line by line into Sobel.
pub const SOBEL: Scenario =
    Scenario { name: "sobel", profile: "vga-rgb888", frames: 2, lines: true, ..CLEAN };
/// VGA line by line into Canny.
pub const CANNY: Scenario =
    Scenario { name: "canny", profile: "vga-rgb888", frames: 2, lines: true, ..CLEAN };
/// VGA line by line into indices of a palette.
pub const PALETTE: Scenario =
    Scenario { name: "palette", profile: "vga-rgb888", frames: 2, lines: true, ..CLEAN };
/// Whole frames.
pub const FRAMES: Scenario = Scenario { name: "frames", frames: 6, ..CLEAN };
/// Whole frames for a serial line, again and again.
pub const STREAM: Scenario = Scenario { name: "stream", profile: QVGA, frames: 8, ..CLEAN };

/// The sixteen colours of old: the corners of the cube, the same at half the light, and a light gray.
pub static COLORS: [Rgb; 16] = {
    let mut colors = [Rgb { r: 0, g: 0, b: 0 }; 16];
    let mut index = 0;
    while index < 16 {
        let level = if index < 8 { 128 } else { 255 };
        colors[index] = Rgb {
            r: if index & 1 != 0 { level } else { 0 },
            g: if index & 2 != 0 { level } else { 0 },
            b: if index & 4 != 0 { level } else { 0 },
        };
        index += 1;
    }
    // Black is there once; light gray in place of the other.
    colors[8] = Rgb { r: 192, g: 192, b: 192 };
    colors
};

impl Scenario {
    /// Width and height of its profile, pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        match self.profile {
            SMALL | SMALL_MARKER | SMALL_EMBEDDED => SMALL_SIZE,
            QVGA => STREAM_SIZE,
            _ => (640, 480),
        }
    }

    /// What the driver is told. The host checks that the profile says the same.
    #[must_use]
    pub fn config(&self) -> Config {
        let (width, height) = self.size();
        let (sync, clocks) = match self.profile {
            SMALL | QVGA => (SyncMode::Gated { hsync_blank_high: true, vsync_blank_high: true }, width * 3),
            SMALL_EMBEDDED => {
                // BT.656: the first line after the vertical blanking starts the frame, any other code ends it.
                let codes = SyncCodes::new_with_raw_value(0xFF9D_80FF);
                let unmask = SyncCodes::new_with_raw_value(u32::MAX);
                (SyncMode::Embedded { codes, unmask }, width * 2)
            }
            _ => (SyncMode::Marker { hsync_active_high: true, vsync_active_high: true }, width * 3),
        };
        let mut config = Config::new(sync, clocks, height);
        config.policy = self.policy;
        config.damaged = if self.deliver_damaged { Damaged::Deliver } else { Damaged::Discard };
        config
    }

    /// What the vision is told. `probes` is a palette's memory.
    #[must_use]
    pub fn settings<'m>(&self, probes: &'m mut [Probe; COLORS.len()]) -> Settings<'m> {
        let output = match self.name {
            "canny" => Output::Canny(Smoothing::Gaussian5, Thresholds { low: 50, high: 150, norm: Norm::L2 }),
            "palette" => Output::Palette(Palette { colors: &COLORS, probes }),
            _ => Output::Sobel(Smoothing::Gaussian3),
        };
        Settings { balance: Balance::GrayWorld, output, ..Settings::new(640, 480) }
    }
}
