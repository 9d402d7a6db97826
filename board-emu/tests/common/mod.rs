//! What the tests of images share: where the images are, and a camera of small frames.

// Each test program uses a part of it.
#![allow(dead_code)]

use std::path::PathBuf;

use board_emu::board::Kind;
use board_emu::footage::Footage;
use host_sim::fault::{FaultSpec, Injector};
use host_sim::profile::Profile;
use host_sim::scene::Scene;
use host_sim::sensor::Sensor;

pub const BOARDS: [Kind; 2] = [Kind::Stm32h743, Kind::Stm32f429];

/// Frames of 160 × 120 gray pixels, 36 a second.
const PROFILE: &str = r#"
[bus]
bits = 8
clock_edge = "rising"
sync = "gated"
hsync_blank = "low"
vsync_blank = "high"
[frame]
width = 160
height = 120
format = "gray8"
[timing]
pclk_hz = 1_000_000
hblank = 40
vblank = 4000
"#;

/// The pixel clock of that.
pub const PCLK_HZ: u32 = 1_000_000;

pub fn profile() -> Profile {
    Profile::from_toml(PROFILE).unwrap()
}

/// The image, if it has been built: `cargo xtask board-emu` builds all and says where they are.
pub fn image(name: &str, board: Kind) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("CAMIF_IMAGES") else {
        println!("skipped: CAMIF_IMAGES does not say where the images are (cargo xtask board-emu)");
        return None;
    };
    let path = PathBuf::from(folder).join(format!("{name}-{}.elf", board.name()));
    assert!(path.is_file(), "{} is not there", path.display());
    Some(path)
}

/// Frames of the demo scene, through faults; also their bytes before those, and the pixel clock after them.
pub fn footage(frames: u64, faults: &[FaultSpec]) -> Result<(Footage, Vec<Vec<u8>>, u32), String> {
    let profile = profile();
    let mut sensor = Sensor::new(profile.clone()).unwrap();
    let scene = Scene::named("demo", 0).unwrap();
    let injector = Injector::new(&profile, faults, 7, Footage::default());
    let mut injector = injector.map_err(|error| error.to_string())?;
    let mut sent = Vec::new();
    sensor.play_watched(frames, &scene, &mut injector, |_, bytes| sent.push(bytes.to_vec())).unwrap();
    let pclk_hz = PCLK_HZ * injector.clock_factor();
    Ok((injector.finish().unwrap(), sent, pclk_hz))
}
