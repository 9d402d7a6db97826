//! Controls, rates, crops: what is asked for is what the device has then, as `v4l2-ctl` sees it.

use std::path::Path;
use std::time::Duration;

use camif_vm::bars;
use camif_vm::command::host_sim;
use host_sim::capture::v4l2::V4l2;
use host_sim::capture::{CaptureDevice as _, Settings};

use crate::{ONE, SMALL, cameras, v4l2_ctl};

#[test]
#[ignore = "tests/vm/run"]
fn controls_are_listed_and_set() {
    cameras();
    let capture = ["capture", "--v4l2", ONE, "--controls"];
    let with = |more: &[&str]| host_sim(&[&capture[..], more].concat());
    let listed = with(&["--json"]).expect(0).json();
    let controls = listed["controls"].as_array().unwrap();
    let theirs = v4l2_ctl(ONE, &["--list-ctrls"]);
    // `v4l2-ctl` writes "name 0x... (kind) : values", and headings without a number.
    let theirs: Vec<&str> = theirs
        .lines()
        .filter(|line| line.contains(" 0x"))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    let ours: Vec<&str> = controls.iter().filter_map(|control| control["name"].as_str()).collect();
    assert_eq!(ours, theirs);

    let set = [
        "--set",
        "gain_automatic=off",
        "--set",
        "gain=77",
        "--set",
        "test_pattern=100% red",
        "--set",
        "string=a=c",
    ];
    let text = with(&set).expect(0).stdout;
    assert!(text.lines().any(|line| line.starts_with("gain ") && line.contains(" 77 ")), "{text}");
    let theirs = v4l2_ctl(ONE, &["--get-ctrl=gain,test_pattern,string"]);
    assert!(theirs.contains("gain: 77\n") && theirs.contains("string: 'a=c"), "{theirs}");
    // By its number in the menu, while capturing.
    let _ = host_sim(&["capture", "--v4l2", ONE, "--frames", "1", "--set", "test_pattern=1"]).expect(0);
    assert!(v4l2_ctl(ONE, &["--get-ctrl=test_pattern"]).contains("test_pattern: 1"));

    for (setting, said) in [
        ("gane=5", "no control `gane`; there are gain, "),
        ("gain=1000", "give a number from 0 to 255"),
        ("gain=much", "give a number from 0 to 255"),
        ("test_pattern=100% Colourbar", "no menu item `100% Colourbar`; there are 100% Colorbar, "),
        ("boolean=perhaps", "give on or off"),
        ("ro_integer_32_bits=5", "it can only be read"),
    ] {
        // A control that this kernel does not have would be another message.
        let error = with(&["--set", setting]).expect(2).stderr;
        assert!(error.contains(said) || error.contains("no control `ro_"), "{setting}: {error}");
    }
}

/// The intervals are those of the device's own clock.
#[test]
#[ignore = "tests/vm/run"]
fn the_rate_asked_for_is_the_rate_that_comes() {
    cameras();
    for rate in [10.0, 25.0, 50.0] {
        let settings =
            Settings { size: Some((320, 180)), rate: Some(rate), buffers: 4, ..Settings::default() };
        let mut device = V4l2::start(Path::new(ONE), &settings).unwrap();
        assert_eq!((device.opened().format.rate, &device.opened().notes[..]), (Some(rate), &[][..]));
        let mut times = Vec::new();
        while times.len() < 12 {
            let frame = device.next(Duration::from_secs(5)).unwrap().expect("a frame in five seconds");
            times.push((frame.sequence(), std::time::Instant::now()));
        }
        let (first, last) = (times[1], times[11]);
        let measured = f64::from(last.0 - first.0) / (last.1 - first.1).as_secs_f64();
        println!("{rate} asked for, {measured:.1} measured");
        // The first is waited for late on a busy machine, which shortens the time.
        assert!((0.6 * rate..2.0 * rate).contains(&measured), "{rate}: {measured}");
    }
    // What it does not have is the next, with a note.
    let asked = ["capture", "--v4l2", ONE, "--size", "640x480", "--rate", "1000", "--frames", "1"];
    let said = host_sim(&asked).expect(0).stderr;
    assert!(said.contains("asked for 1000 frames a second, the device takes"), "{said}");
}

#[test]
#[ignore = "tests/vm/run"]
fn what_is_not_offered_is_said() {
    cameras();
    let with = |more: &[&str]| host_sim(&[&["capture", "--v4l2", ONE, "--frames", "1"], more].concat());
    let said = with(&["--format", "H264"]).expect(2).stderr;
    assert!(said.contains("no pixel format `H264`; there are "), "{said}");
    let said = with(&["--size", "641x479"]).expect(0).stderr;
    assert!(said.contains("asked for 641 × 479 pixels, the device takes 640 × 480"), "{said}");
    let said = with(&["--input", "9"]).expect(2).stderr;
    assert!(said.contains("no input `9`; there are ") && said.contains("3 (HDMI 0)"), "{said}");
    let said = with(&["--crop", "160x90+8+8"]).expect(2).stderr;
    assert!(said.contains("the crop 160x90+8+8 was refused") && said.contains("can't crop"), "{said}");
}

/// HDMI is what vivid can crop. The bars of the part are those of the whole, moved.
#[test]
#[ignore = "tests/vm/run"]
fn a_crop_is_the_part_asked_for() {
    cameras();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let asked = ["capture", "--v4l2", ONE, "--input", "3", "--format", "RGB3", "--frames", "1", "--out", out];
    let capture = |more: &[&str]| {
        let finished = host_sim(&[&asked[..], more].concat());
        (finished, host_sim::picture::read(&folder.path().join("frame-0000.png")).unwrap())
    };
    let whole = capture(&["--size", "1280x720"]);
    let part = capture(&["--crop", "320x180+104+64"]);
    let outside = capture(&["--crop", "320x180+60000+64"]).0;
    // Back to the camera.
    let _ = host_sim(&["capture", "--v4l2", ONE, "--input", "0", "--size", SMALL, "--frames", "1"]).expect(0);
    let (_, whole) = (whole.0.expect(0), whole.1);
    let (_, part) = (part.0.expect(0), part.1);
    assert_eq!(bars::difference(&whole, &bars::picture(1280, 720, 255), 2).0, 0, "the whole");
    assert_eq!(part.dimensions(), (320, 180));
    let expected = image::imageops::crop_imm(&whole, 104, 64, 320, 180).to_image();
    let other = part.pixels().zip(expected.pixels()).filter(|(got, wanted)| got != wanted).count();
    assert_eq!(other, 0, "pixels are not those of the part");
    assert!(outside.stderr.contains("asked to crop") || outside.status == Some(2), "{outside:?}");
}
