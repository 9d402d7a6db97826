//! The traces of the scenarios, with their faults in them.

use std::path::Path;

use anyhow::{Context, Result};
use exercise::replay::scenario::Scenario;
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
    let Some(size) = scenario.gated_size() else { return Ok(Profile::find(scenario.profile)?) };
    let mut profile = Profile::find("vga-rgb888-gated")?;
    profile.name = scenario.profile.to_owned();
    (profile.frame.width, profile.frame.height) = size;
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
        let faults = [scenario.faults.parse::<FaultSpec>()?];
        let mut injector = Injector::new(&profile, &faults, 1, &mut writer)?;
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

/// Writes a scenario's trace under its name.
///
/// # Errors
/// As [`trace`], and if it cannot be written.
pub fn write(scenario: &Scenario, folder: &Path) -> Result<()> {
    let path = folder.join(format!("{}.camt", scenario.name));
    std::fs::write(&path, trace(scenario)?).with_context(|| format!("cannot write {}", path.display()))
}
