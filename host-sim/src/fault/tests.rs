//! Faults drawn: what they make of the wires of a tiny sensor.

use std::convert::Infallible;

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use super::{FaultKind, FaultSpec, Injector};
use crate::profile::{Profile, SyncMode, built_ins};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// Every clock as it went over the wires.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Clocks(Vec<(Sync, u16)>);

impl StretchSink for Clocks {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        self.0.extend((0..samples.len()).map(|clock| (sync, samples.get(clock).unwrap())));
        Ok(())
    }
}

fn tiny(sync: &str) -> Profile {
    let (hblank, vblank) = match sync {
        "marker" => (0, 0),
        "embedded" => (8, 28),
        _ => (3, 5),
    };
    Profile::from_toml(&format!(
        "[bus]\nsync = \"{sync}\"\n[frame]\nwidth = 12\nheight = 3\nformat = \"gray8\"\n\
         [timing]\nhblank = {hblank}\nvblank = {vblank}\n"
    ))
    .unwrap()
}

fn play(profile: &Profile, faults: &str, frames: usize) -> Clocks {
    let faults: Vec<FaultSpec> = faults.split_whitespace().map(|text| text.parse().unwrap()).collect();
    let mut injector = Injector::new(profile, &faults, 7, Clocks::default()).unwrap();
    let mut sensor = Sensor::new(profile.clone()).unwrap();
    for frame in 0..frames {
        let bytes: Vec<u8> =
            (0..profile.bytes_per_frame()).map(|at| (17 + 3 * at + frame as u64) as u8).collect();
        sensor.play_frame_bytes(&bytes, &mut injector).unwrap();
    }
    sensor.close(&mut injector).unwrap();
    injector.finish().unwrap()
}

/// A wave a wire, as the waves in the documentation.
fn waves(clocks: &Clocks) -> String {
    let wave = |level: fn(&Sync) -> bool| -> String {
        clocks.0.iter().map(|(sync, _)| if level(sync) { '‾' } else { '_' }).collect()
    };
    format!("{}\n{}", wave(|sync| sync.hsync), wave(|sync| sync.vsync))
}

#[test]
fn waves_of_faults_on_gated_wires() {
    let profile = tiny("gated");
    let drawn = |fault: &str| waves(&play(&profile, fault, 1));
    assert_eq!(
        drawn(""),
        "‾‾‾‾‾____________‾‾‾____________‾‾‾____________‾‾‾‾‾\n\
         ‾‾‾‾‾__________________________________________‾‾‾‾‾"
    );
    assert_eq!(
        drawn("line-start-loss:samples=2"),
        "‾‾‾‾‾‾‾__________‾‾‾‾‾__________‾‾‾‾‾__________‾‾‾‾‾\n\
         ‾‾‾‾‾__________________________________________‾‾‾‾‾"
    );
    assert_eq!(
        drawn("inverted-vsync"),
        "‾‾‾‾‾____________‾‾‾____________‾‾‾____________‾‾‾‾‾\n\
         _____‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾_____"
    );
    assert_eq!(
        drawn("short-blanking:percent=34"),
        "‾‾‾‾‾____________‾____________‾____________‾‾‾‾‾\n\
         ‾‾‾‾‾______________________________________‾‾‾‾‾"
    );
    assert_eq!(
        drawn("byte-slip:samples=1"),
        "‾‾‾‾‾‾____________‾‾‾____________‾‾‾____________‾‾‾‾‾\n\
         ‾‾‾‾‾‾__________________________________________‾‾‾‾‾"
    );
    assert_eq!(
        drawn("vsync-in-frame:percent=40"),
        "‾‾‾‾‾____________‾‾‾____________‾‾‾____________‾‾‾‾‾\n\
         ‾‾‾‾‾____________‾‾‾‾‾_________________________‾‾‾‾‾"
    );
}

#[test]
fn wires_do_what_they_say() {
    let profile = tiny("gated");
    let clean = play(&profile, "", 1);
    let same = |fault: &str, change: fn(u16) -> u16| {
        let expected: Vec<u16> = clean.0.iter().map(|(_, data)| change(*data)).collect();
        let got: Vec<u16> = play(&profile, fault, 1).0.iter().map(|(_, data)| *data).collect();
        assert_eq!(got, expected, "{fault}");
    };
    same("stuck-bit:bit=3,level=high", |data| data | 8);
    same("stuck-bit:bit=0,level=low", |data| data & !1);
    same("swapped-bits:a=0,b=7", |data| data & 0x7E | data >> 7 | (data & 1) << 7);
    same("shorted-bits:a=1,b=0,wins=low", |data| if data & 3 == 3 { data } else { data & !3 });
    same("shorted-bits:a=1,b=0,wins=high", |data| if data & 3 == 0 { data } else { data | 3 });
    same("shifted-bits:places=2,to=low", |data| data >> 2);
    same("shifted-bits:places=2,to=high", |data| data << 2 & 0xFF);
    same("reversed-bus", |data| u16::from((data as u8).reverse_bits()));
    same("reversed-bus reversed-bus", |data| data);
}

#[test]
fn every_fault_changes_every_profile_it_can_be_put_into() {
    for mut profile in built_ins() {
        (profile.frame.width, profile.frame.height) = (64, 24);
        if profile.bus.sync == SyncMode::Embedded {
            (profile.timing.hblank, profile.timing.vblank) = (40, 3 * 168 + 90);
        }
        let scene = Scene::Demo { seed: 3 };
        let played = |kind: Option<FaultKind>, seed| {
            let faults: Vec<_> = kind.into_iter().map(FaultSpec::new).collect();
            let mut injector = Injector::new(&profile, &faults, seed, Clocks::default()).ok()?;
            Sensor::new(profile.clone()).unwrap().play(4, &scene, &mut injector).unwrap();
            Some(injector.finish().unwrap())
        };
        let clean = played(None, 0);
        for kind in FaultKind::all().filter(|kind| kind.refusal(&profile).is_none()) {
            let Some(broken) = played(Some(kind), 5) else { continue };
            let untouched = kind == FaultKind::ClockTooFast;
            assert_eq!(Some(&broken) == clean.as_ref(), untouched, "{kind} in {}", profile.name);
            assert_eq!(Some(broken), played(Some(kind), 5), "{kind} comes again");
        }
    }
}
