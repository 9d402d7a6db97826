//! The traces of the scenarios, with their faults in them.

use std::path::Path;

use anyhow::{Context, Result};
use exercise::replay::scenario::{MOST_FRAMES, Scenario};
use firmware::driver::crc32;
use firmware::trace::{ChunkBuffer, Header, StretchSink, Writer};
use host_sim::fault::{FaultSpec, Injector};
use host_sim::profile::Profile;
use host_sim::scene::Scene;
use host_sim::sensor::Sensor;

/// The profile of a scenario: a built-in one, or the small one for faults, which is VGA's with less of everything.
///
/// # Errors
/// If there is no such profile.
pub fn profile(scenario: &Scenario) -> Result<Profile> {
    let large = match scenario.profile {
        "small-gated" | "qvga-gated" => "vga-rgb888-gated",
        "small-marker" => "vga-rgb888",
        "small-embedded" => "bt656-vga-yuv422",
        name => return Ok(Profile::find(name)?),
    };
    let mut profile = Profile::find(large)?;
    profile.name = scenario.profile.to_owned();
    (profile.frame.width, profile.frame.height) = scenario.size();
    profile.check()?;
    Ok(profile)
}

/// The bytes of a scenario's trace, a `.camt`.
///
/// # Errors
/// If the sensor or a fault cannot be had.
pub fn trace(scenario: &Scenario) -> Result<Vec<u8>> {
    let profile = profile(scenario)?;
    let header = Header {
        bus_bits: u8::try_from(profile.bus.bits)?,
        vsync_active: profile.bus.vsync_blank.is_high(),
        pclk_hz: profile.timing.pclk_hz,
    };
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes, header, &profile.to_toml(), Box::new(ChunkBuffer::new()))
        .map_err(|error| anyhow::anyhow!("a trace's header: {error:?}"))?;
    if scenario.faults.is_empty() {
        play(scenario, &profile, &mut writer)?;
    } else {
        let faults =
            scenario.faults.iter().map(|fault| fault.parse()).collect::<Result<Vec<FaultSpec>, _>>()?;
        let (first, end) = scenario.faulty;
        let mut injector = Injector::new(&profile, &faults, 1, &mut writer)?.during(first..end);
        play(scenario, &profile, &mut injector)?;
        injector.finish().map_err(|_| anyhow::anyhow!("{}: the trace is refused", scenario.name))?;
    }
    writer.finish().map_err(|error| anyhow::anyhow!("a trace's end: {error:?}"))?;
    Ok(bytes)
}

fn play<S: StretchSink>(scenario: &Scenario, profile: &Profile, sink: &mut S) -> Result<()> {
    let mut sensor = Sensor::new(profile.clone())?;
    let played = sensor.play(scenario.frames, &Scene::Moving, sink);
    played.map_err(|error| anyhow::anyhow!("{}: {error}", scenario.name))
}

/// CRC-32 of the bytes of each frame that the sensor sends, before any fault: by the picture, and not by the block.
///
/// # Errors
/// If the sensor cannot be had, or there are more than [`MOST_FRAMES`].
pub fn sent(scenario: &Scenario) -> Result<Vec<u32>> {
    anyhow::ensure!(scenario.frames <= MOST_FRAMES as u64, "{}: too many frames", scenario.name);
    let profile = profile(scenario)?;
    let (width, height) = (profile.frame.width, profile.frame.height);
    let sensor = Sensor::new(profile)?;
    let checksum = |number| Ok(crc32(&sensor.encode(&Scene::Moving.render(number, width, height))?));
    (0..scenario.frames).map(checksum).collect()
}

/// Writes a scenario's trace, and the checksums of what was sent, under its name.
///
/// # Errors
/// As [`trace`] and [`sent`], and if they cannot be written.
pub fn write(scenario: &Scenario, folder: &Path) -> Result<()> {
    let sent: Vec<u8> = sent(scenario)?.into_iter().flat_map(u32::to_le_bytes).collect();
    for (extension, bytes) in [("camt", trace(scenario)?), ("sent", sent)] {
        let path = folder.join(format!("{}.{extension}", scenario.name));
        std::fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}
