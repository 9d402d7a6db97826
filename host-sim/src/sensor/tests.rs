use std::convert::Infallible;

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;
use proptest::prelude::*;

use super::receive::{Clocks, Received, receive};
use super::{PlayError, Sensor};
use crate::profile::{Choice, Level, Profile, SyncMode, built_ins};
use crate::scene::Scene;

/// Where the sync wires rise, in pixel clocks from the start.
#[derive(Default)]
struct Edges {
    clocks: u64,
    stretches: u64,
    before: Sync,
    hsync: Vec<u64>,
    vsync: Vec<u64>,
}

impl StretchSink for Edges {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        if sync.hsync && !self.before.hsync {
            self.hsync.push(self.clocks);
        }
        if sync.vsync && !self.before.vsync {
            self.vsync.push(self.clocks);
        }
        self.before = sync;
        self.clocks += samples.len() as u64;
        self.stretches += 1;
        Ok(())
    }
}

#[test]
fn vga_rgb888_has_hsync_every_1920_clocks_and_vsync_every_921600() {
    let mut sensor = Sensor::new(Profile::built_in("vga-rgb888").unwrap()).unwrap();
    let mut edges = Edges::default();
    sensor.play(3, &Scene::Bars, &mut edges).unwrap();
    assert_eq!(edges.hsync, (1..=3 * 480).map(|line| line * 1_920).collect::<Vec<_>>());
    assert_eq!(edges.vsync, [921_600, 2 * 921_600, 3 * 921_600]);
    assert_eq!(edges.clocks, 3 * 921_600 + 1, "and one idle clock");
    assert_eq!(edges.stretches, 2 * 3 * 480, "a line is a marker and the rest");
}

#[test]
fn frames_come_as_often_as_the_profile_says() {
    for profile in built_ins() {
        let mut sensor = Sensor::new(profile.clone()).unwrap();
        let picture = Scene::Gradient.render(0, profile.frame.width, profile.frame.height);
        let bytes = sensor.encode(&picture).unwrap();
        assert_eq!(bytes.len() as u64, profile.bytes_per_frame());
        let mut ends = Vec::new();
        let mut edges = Edges::default();
        for _ in 0..3 {
            sensor.play_frame_bytes(&bytes, &mut edges).unwrap();
            ends.push(edges.clocks);
        }
        // From the first frame to the second, what comes before a stream's first frame may differ.
        assert_eq!(ends[2] - ends[1], profile.clocks_per_frame(), "{}", profile.name);
    }
}

fn small(mut profile: Profile, width: u32, height: u32) -> Profile {
    (profile.frame.width, profile.frame.height) = (width, height);
    if profile.bus.sync == SyncMode::Embedded {
        // Three lines of blanking and some filler.
        profile.timing.hblank = 11;
        profile.timing.vblank = 11 + 3 * (profile.samples_per_line() + 11) + 5;
    }
    profile
}

/// The samples of each line in a frame's bytes, cut the naive way.
fn samples_of(profile: &Profile, bytes: &[u8]) -> Received {
    let samples: Vec<u16> = if profile.bus.bits == 8 {
        bytes.iter().copied().map(u16::from).collect()
    } else {
        bytes.chunks(2).map(|pair| u16::from(pair[0]) | u16::from(pair[1]) << 8).collect()
    };
    samples.chunks(profile.samples_per_line() as usize).map(<[u16]>::to_vec).collect()
}

#[test]
fn every_profile_arrives_as_it_was_sent() {
    for profile in built_ins() {
        let profile = small(profile, 10, 6);
        let mut sensor = Sensor::new(profile.clone()).unwrap();
        let scene = Scene::Noise { seed: 9 };
        let mut clocks = Clocks::default();
        sensor.play(3, &scene, &mut clocks).unwrap();
        let sent: Vec<_> = (0..3)
            .map(|frame| samples_of(&profile, &sensor.encode(&scene.render(frame, 10, 6)).unwrap()))
            .collect();
        assert_eq!(receive(&profile, &clocks.0), sent, "{}", profile.name);
        // A second stream on the same wires.
        sensor.play(3, &scene, &mut clocks).unwrap();
        if profile.bus.sync != SyncMode::Marker {
            assert_eq!(receive(&profile, &clocks.0).len(), 6, "{}", profile.name);
        }
    }
}

#[test]
fn embedded_data_holds_no_byte_of_a_code() {
    let profile = small(Profile::built_in("bt656-vga-yuv422").unwrap(), 4, 2);
    let mut sensor = Sensor::new(profile.clone()).unwrap();
    let mut clocks = Clocks::default();
    let bytes = [0xFF, 0, 0, 0x80, 0xFF, 0, 0, 0xB6, 0, 1, 2, 0xFD, 0xFE, 0xFF, 0, 0x9D];
    sensor.play_frame_bytes(&bytes, &mut clocks).unwrap();
    sensor.close(&mut clocks).unwrap();
    let sent = [0xFE, 1, 1, 0x80, 0xFE, 1, 1, 0xB6, 1, 1, 2, 0xFD, 0xFE, 0xFE, 1, 0x9D];
    assert_eq!(receive(&profile, &clocks.0), [samples_of(&profile, &sent)]);
}

#[test]
fn what_is_no_frame_is_not_played() {
    let mut sensor = Sensor::new(small(Profile::default(), 10, 6)).unwrap();
    let mut clocks = Clocks::default();
    assert_eq!(
        sensor.play_frame_bytes(&[0; 179], &mut clocks),
        Err(PlayError::Length { expected: 180, got: 179 })
    );
    let picture = Scene::Bars.render(0, 9, 6);
    assert!(matches!(sensor.play_picture(&picture, &mut clocks), Err(PlayError::Size(_))));
    sensor.close(&mut clocks).unwrap();
    assert!(clocks.0.is_empty(), "there was nothing to close");
    let mut wrong = Profile::default();
    wrong.bus.bits = 9;
    assert!(Sensor::new(wrong).is_err());
}

#[test]
fn a_sink_that_has_enough_stops_the_sensor() {
    struct Full(u32);
    impl StretchSink for Full {
        type Error = &'static str;
        fn stretch(&mut self, _: Sync, _: Samples<'_>) -> Result<(), &'static str> {
            self.0 = self.0.checked_sub(1).ok_or("full")?;
            Ok(())
        }
    }
    for profile in built_ins() {
        let mut sensor = Sensor::new(small(profile, 10, 6)).unwrap();
        for room in 0..8 {
            assert_eq!(sensor.play(2, &Scene::Bars, &mut Full(room)), Err(PlayError::Sink("full")));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Whatever the timing and the levels: the naive receiver gets the bytes that were given, frame by frame.
    #[test]
    fn any_timing_arrives_as_it_was_sent(
        which in 0..9usize,
        (half_width, height) in (1..6u32, 1..5u32),
        levels in (prop::sample::select(Level::NAMES), prop::sample::select(Level::NAMES)),
        (hblank, extra, vfront, vback) in (0..20u32, 0..60u32, 0..5u32, 0..5u32),
        frames in 0..4u64,
        seed in any::<u64>(),
    ) {
        let mut profile = small(built_ins().nth(which).unwrap(), 2 * half_width, height);
        (profile.bus.hsync_blank, profile.bus.vsync_blank) = (levels.0.1, levels.1.1);
        let timing = &mut profile.timing;
        match profile.bus.sync {
            SyncMode::Marker => {}
            SyncMode::Gated => {
                (timing.hblank, timing.vfront, timing.vback) = (hblank + 1, vfront, vback);
                timing.vblank = vfront + vback + 1 + extra;
            }
            SyncMode::Embedded => {
                timing.hblank = hblank + 8;
                timing.vblank = 4 * half_width + 2 * (hblank + 8) + extra;
            }
        }
        let mut sensor = Sensor::new(profile.clone()).unwrap();
        let scene = Scene::Noise { seed };
        let (mut clocks, mut sent) = (Clocks::default(), Vec::new());
        for frame in 0..frames {
            let bytes = sensor.encode(&scene.render(frame, profile.frame.width, height)).unwrap();
            sent.push(samples_of(&profile, &bytes));
            sensor.play_frame_bytes(&bytes, &mut clocks).unwrap();
        }
        sensor.close(&mut clocks).unwrap();
        if frames == 0 {
            prop_assert!(clocks.0.is_empty());
        } else {
            prop_assert_eq!(receive(&profile, &clocks.0), sent);
        }
    }
}
