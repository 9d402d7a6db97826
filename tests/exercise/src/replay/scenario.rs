//! Which trace, which configuration, which bus.

use firmware::camif::{Bus, Hold, Stall};
use firmware::driver::Config;
use firmware::driver::config::{Damaged, Policy, SyncMode};
use firmware::pipeline::{Balance, Norm, Output, Settings, Smoothing, Thresholds};

/// A camera of a scenario.
#[derive(Clone, Copy, Debug)]
pub struct Scenario {
    /// Its name, and that of its trace.
    pub name: &'static str,
    /// The profile of the trace, by its name on the host.
    pub profile: &'static str,
    /// Frames in the trace.
    pub frames: u64,
    /// Faults of the trace, as `host-sim inject` takes them; none if empty.
    pub faults: &'static str,
    /// The memory bus.
    pub bus: Bus,
    /// Ticks that the main loop waits for a frame or line.
    pub patience: u64,
    /// Frames that are not as configured are handed out.
    pub deliver_damaged: bool,
    /// Frame buffers are kept by the consumer, and never come back.
    pub hoard: bool,
}

/// Nothing goes wrong.
const CLEAN: Scenario = Scenario {
    name: "",
    profile: SMALL,
    frames: 4,
    faults: "",
    bus: Bus::IDEAL,
    patience: 300,
    deliver_damaged: false,
    hoard: false,
};

/// The profile of the faults: small, so that many frames pass.
const SMALL: &str = "small-gated";
/// Its size.
pub const SMALL_SIZE: (u32, u32) = (64, 48);

/// The profile of what is looked at: no larger than a serial line carries.
const QVGA: &str = "qvga-gated";
/// Its size.
pub const STREAM_SIZE: (u32, u32) = (320, 240);

/// VGA line by line into Sobel.
pub const SOBEL: Scenario = Scenario { name: "sobel", profile: "vga-rgb888", frames: 2, ..CLEAN };
/// VGA line by line into Canny.
pub const CANNY: Scenario = Scenario { name: "canny", profile: "vga-rgb888", frames: 2, ..CLEAN };
/// Whole frames.
pub const FRAMES: Scenario = Scenario { name: "frames", frames: 6, ..CLEAN };
/// Whole frames for a serial line, again and again.
pub const STREAM: Scenario = Scenario { name: "stream", profile: QVGA, frames: 8, ..CLEAN };

/// One fault each, and what the driver makes of it.
pub static FAULTS: [Scenario; 12] = [
    Scenario { name: "clean", ..CLEAN },
    Scenario { name: "slow-bus", bus: Bus { latency_max: 3, seed: 7, ..Bus::IDEAL }, ..CLEAN },
    Scenario {
        name: "overrun",
        frames: 8,
        bus: Bus { hold: Some(Hold { request: 1_000, clocks: 100 }), ..Bus::IDEAL },
        ..CLEAN
    },
    Scenario {
        name: "stalls",
        frames: 12,
        bus: Bus { latency_max: 2, stall: Some(Stall { one_in: 3_000, clocks: 60 }), seed: 3, ..Bus::IDEAL },
        ..CLEAN
    },
    Scenario {
        name: "bus-stands-still",
        bus: Bus { latency_min: 1 << 30, latency_max: 1 << 30, ..Bus::IDEAL },
        ..CLEAN
    },
    Scenario { name: "short-line", frames: 8, faults: "short-line:count=1,samples=6", ..CLEAN },
    Scenario { name: "long-line", frames: 8, faults: "long-line:count=1,samples=6", ..CLEAN },
    Scenario {
        name: "missing-hsync",
        frames: 8,
        faults: "missing-hsync:count=2",
        deliver_damaged: true,
        ..CLEAN
    },
    Scenario { name: "vsync-in-frame", frames: 8, faults: "vsync-in-frame", ..CLEAN },
    Scenario { name: "missing-vsync", frames: 8, faults: "missing-vsync", ..CLEAN },
    Scenario { name: "no-clock", frames: 0, patience: 4, ..CLEAN },
    Scenario { name: "no-buffer", frames: 12, patience: 600, hoard: true, ..CLEAN },
];

impl Scenario {
    /// The size of a profile that is VGA's with gated lines, but smaller; `None` for one of the host's own.
    #[must_use]
    pub fn gated_size(&self) -> Option<(u32, u32)> {
        match self.profile {
            SMALL => Some(SMALL_SIZE),
            QVGA => Some(STREAM_SIZE),
            _ => None,
        }
    }

    /// What the driver is told. The host checks that the profile says the same.
    #[must_use]
    pub fn config(&self) -> Config {
        let gated = self.gated_size();
        let (sync, clocks, lines) = if let Some((width, height)) = gated {
            let sync = SyncMode::Gated { hsync_blank_high: true, vsync_blank_high: true };
            (sync, width * 3, height)
        } else {
            (SyncMode::Marker { hsync_active_high: true, vsync_active_high: true }, 640 * 3, 480)
        };
        let mut config = Config::new(sync, clocks, lines);
        config.policy = Policy::InOrder;
        config.damaged = if self.deliver_damaged { Damaged::Deliver } else { Damaged::Discard };
        config
    }

    /// What the vision is told.
    #[must_use]
    pub fn settings(&self) -> Settings<'static> {
        let output = match self.name {
            "canny" => Output::Canny(Smoothing::Gaussian5, Thresholds { low: 50, high: 150, norm: Norm::L2 }),
            _ => Output::Sobel(Smoothing::Gaussian3),
        };
        Settings { balance: Balance::GrayWorld, output, ..Settings::new(640, 480) }
    }
}
