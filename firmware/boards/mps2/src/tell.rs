//! What a scenario tells, as defmt's messages: the very words of the host.

use exercise::replay::check::Failure;
use exercise::replay::consumer::Told;
use exercise::replay::scenario::Scenario;

use crate::rig;

/// Tells what happened.
pub fn tell(scenario: &Scenario, told: &Told) {
    let name = scenario.name;
    match *told {
        Told::Frame(number, outcome, checksum) => {
            defmt::info!("{=str}: frame {=u32} {=str}, {=u32:08x}", name, number, outcome, checksum);
        }
        Told::Lost(damage) => defmt::info!("{=str}: lost a frame: {=str}", name, damage),
        Told::Timeout(cause) => defmt::info!("{=str}: nothing came: {=str}", name, cause),
        Told::Refused => defmt::info!("{=str}: a line of another length", name),
        Told::Total([delivered, dropped, lost, skipped, overruns]) => defmt::info!(
            "{=str}: {=u32} delivered, {=u32} dropped, {=u32} lost, {=u32} skipped, {=u32} overruns",
            name,
            delivered,
            dropped,
            lost,
            skipped,
            overruns
        ),
    }
}

/// Tells what the driver did.
pub fn accesses(scenario: &Scenario) {
    let record = rig::record();
    for access in record.told(scenario) {
        let (kind, place) = (access.kind.name(), access.place);
        defmt::info!("{=str}: {=str} {=u32:x} {=u32:08x}", scenario.name, kind, place, access.value);
    }
    defmt::info!("{=str}: {=u32} accesses, {=u32:08x}", scenario.name, record.count, record.checksum());
}

/// Tells what was not as it is to be.
pub fn failure(scenario: &Scenario, failure: &Failure) {
    let (what, word, number) = failure.parts();
    defmt::error!("{=str} failed: {=str} {=str} ({=u32})", scenario.name, what, word, number);
}
