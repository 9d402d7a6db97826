use firmware::camif::registers::{BusWidth, SyncCodes};
use firmware::driver::config::{Config, Damaged, Policy, SyncMode as DriverSync};

use crate::profile::{Profile, SyncMode};

/// BT.656: the first line after the vertical blanking starts the frame, any other code ends it.
const BT656_CODES: u32 = 0xFF9D_80FF;

/// What the driver must know to capture this profile's frames, in order, damaged ones included.
///
/// The profile must have passed [`Profile::check`].
#[must_use]
pub fn capture_config(profile: &Profile) -> Config {
    let (hsync_high, vsync_high) = (profile.bus.hsync_blank.is_high(), profile.bus.vsync_blank.is_high());
    let sync = match profile.bus.sync {
        SyncMode::Gated => DriverSync::Gated { hsync_blank_high: hsync_high, vsync_blank_high: vsync_high },
        SyncMode::Marker => {
            DriverSync::Marker { hsync_active_high: hsync_high, vsync_active_high: vsync_high }
        }
        SyncMode::Embedded => DriverSync::Embedded {
            codes: SyncCodes::new_with_raw_value(BT656_CODES),
            unmask: SyncCodes::new_with_raw_value(u32::MAX),
        },
    };
    let mut config = Config::new(sync, profile.samples_per_line(), profile.frame.height);
    config.bus_width = BusWidth::from_bits(profile.bus.bits).unwrap_or(BusWidth::Bits8);
    config.edge = profile.bus.clock_edge;
    config.policy = Policy::InOrder;
    config.damaged = Damaged::Deliver;
    config.pclk_hz = profile.timing.pclk_hz;
    config
}
