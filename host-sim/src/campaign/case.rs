use std::convert::Infallible;

use firmware::camif::Bus;
use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;
use serde::{Deserialize, Serialize};

use super::plan::Case;
use super::view::Pictures;
use crate::diagnosis::{Recording, diagnose};
use crate::fault::{FaultKind, Injector, Random};
use crate::receiver::{capture_config, receive};
use crate::sensor::Sensor;

/// What came of a case: a line of the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// Its number.
    pub case: u64,
    /// The profile's name.
    pub profile: String,
    /// What the sensor looked at.
    pub scene: String,
    /// The class put in; nothing for a clean trace.
    pub class: Option<FaultKind>,
    /// The fault with its values.
    pub fault: String,
    /// The seed.
    pub seed: u64,
    /// The frames received are those sent, byte by byte, and no others.
    pub intact: bool,
    /// Classes found, the most likely first, with their confidence and their score in thousandths.
    pub found: Vec<(FaultKind, u32, u32)>,
}

/// Plays into several sinks at once.
struct Both<'a, A, B>(&'a mut A, &'a mut B);

impl<A: StretchSink<Error = Infallible>, B: StretchSink<Error = Infallible>> StretchSink for Both<'_, A, B> {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        self.0.stretch(sync, samples)?;
        self.1.stretch(sync, samples)
    }
}

/// Runs a case. What is diagnosed is the trace and the profile; the truth is only compared.
///
/// # Panics
/// If the driver refuses a built-in profile's settings, which a test of theirs rules out.
#[must_use]
pub fn run(case: &Case, pictures: &Pictures) -> CaseResult {
    let profile = &case.profile;
    let mut random = Random::new(case.seed ^ 0x5CE_E000 ^ case.number << 32);
    let (width, height) = (profile.frame.width, profile.frame.height);
    let (scene, views) = match &case.fault {
        Some(_) => pictures.rich(&mut random, width, height),
        None => pictures.any(case.seed, &mut random, width, height),
    };
    let mut sensor = Sensor::new(profile.clone()).expect("a built-in profile is right");
    let sent: Vec<Vec<u8>> = views
        .iter()
        .map(|picture| sensor.encode(picture).expect("pictures have the profile's size"))
        .collect();
    let faults: Vec<_> = case.fault.iter().cloned().collect();
    let mut recording = Recording::default();
    let mut received: Vec<Option<Vec<u8>>> = Vec::new();
    let factor =
        Injector::new(profile, &faults, case.seed, Nothing).map_or(1, |injector| injector.clock_factor());
    // The bus takes a time that does not depend on the camera's clock, so a faster clock sees more clocks of it.
    let bus =
        if factor > 1 { Bus { latency_max: 2 * factor, seed: case.seed, ..Bus::IDEAL } } else { Bus::IDEAL };
    let mut on_frame = |frame: crate::receiver::Received<'_>| {
        let good = frame.verdict.outcome.is_good();
        received.push(frame.bytes.filter(|_| good).map(<[u8]>::to_vec));
    };
    let _ = receive(&capture_config(profile), bus, &mut on_frame, |receiver| {
        let mut injector = Injector::new(profile, &faults, case.seed, Both(&mut recording, receiver))
            .expect("a case's fault suits its profile");
        for bytes in &sent {
            let Ok(()) = sensor.play_frame_bytes(bytes, &mut injector) else {
                unreachable!("the sink takes all")
            };
        }
        let Ok(()) = sensor.close(&mut injector) else { unreachable!("the sink takes all") };
        let Ok(_) = injector.finish();
    })
    .expect("the driver takes a built-in profile");
    let intact = received.len() == sent.len()
        && received.iter().zip(&sent).all(|(received, sent)| received.as_ref() == Some(sent));
    let diagnosis = diagnose(&recording, profile, Some(profile.timing.pclk_hz.saturating_mul(factor)));
    CaseResult {
        case: case.number,
        profile: profile.name.clone(),
        scene,
        class: case.fault.as_ref().map(|fault| fault.kind),
        fault: case.fault.as_ref().map(ToString::to_string).unwrap_or_default(),
        seed: case.seed,
        intact,
        found: diagnosis
            .findings
            .iter()
            .map(|finding| (finding.fault, thousandths(finding.confidence), thousandths(finding.score)))
            .collect(),
    }
}

fn thousandths(share: f64) -> u32 {
    (1000.0 * share).round() as u32
}

/// A sink that keeps nothing.
struct Nothing;

impl StretchSink for Nothing {
    type Error = Infallible;

    fn stretch(&mut self, _: Sync, _: Samples<'_>) -> Result<(), Infallible> {
        Ok(())
    }
}
