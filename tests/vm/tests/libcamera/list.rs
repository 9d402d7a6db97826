use camif_vm::command::host_sim;
use serde_json::json;

use crate::{BARS, LINES, capture};

/// Names, sizes and rates are those of `virtual.yaml`. libcamera adds common sizes between those.
#[test]
#[ignore = "tests/vm/run-libcamera"]
fn cameras_are_listed() {
    let listed = host_sim(&["capture", "--list", "--json"]).expect(0).json();
    let devices = listed["devices"].as_array().unwrap();
    for (id, name, sizes, rates) in [
        (BARS, "Test Virtual Camera", [(320, 240), (640, 480)], (30.0, 60.0)),
        (LINES, "Lines", [(320, 180); 2], (15.0, 30.0)),
    ] {
        let device = devices.iter().find(|device| device["id"] == id).unwrap_or_else(|| panic!("{listed}"));
        assert_eq!((&device["interface"], &device["name"]), (&json!("libcamera"), &json!(name)));
        assert!(device["place"].as_str().unwrap().starts_with("libcamera v0."), "{device}");
        let formats = device["formats"].as_array().unwrap();
        assert_eq!(
            (formats.len(), &formats[0]["code"], &formats[0]["picture"]),
            (1, &json!("NV12"), &json!(true))
        );
        for (width, height) in sizes {
            let offered = formats[0]["sizes"].as_array().unwrap();
            assert!(offered.contains(&json!({ "width": width, "height": height, "rates": [] })), "{device}");
        }
        let offered = [0, 1].map(|index| device["rates"][index].as_f64().unwrap().round());
        assert_eq!(offered, [rates.0, rates.1]);
    }
    let text = host_sim(&["capture", "--list"]).expect(0).stdout;
    assert!(text.contains("--libcamera Virtual0  Test Virtual Camera (libcamera v0."), "{text}");
    assert!(text.contains("\n  --rate 30 to 60\n  --format NV12    NV12\n    --size 320x240\n"), "{text}");
}

#[test]
#[ignore = "tests/vm/run-libcamera"]
fn controls_are_listed_and_set() {
    let listed = capture(BARS, &["--controls", "--json"]).expect(0).json();
    let limits = json!({
        "name": "FrameDurationLimits", "kind": "int64[]", "minimum": "16666", "maximum": "33333", "default": "", "items": [],
    });
    assert!(listed["controls"].as_array().unwrap().contains(&limits), "{listed}");
    let text = capture(BARS, &["--controls"]).expect(0).stdout;
    assert!(text.contains("FrameDurationLimits") && text.contains("16666 to 33333"), "{text}");
    let _ = capture(BARS, &["--frames", "2", "--set", "FrameDurationLimits=20000,20000"]).expect(0);
    for (setting, said) in [
        ("Brightnes=0.5", "no control `Brightnes`; there are FrameDurationLimits"),
        ("FrameDurationLimits=fast", "give int64[], from 16666 to 33333"),
    ] {
        let error = capture(BARS, &["--frames", "1", "--set", setting]).expect(2).stderr;
        assert!(error.contains(said), "{setting}: {error}");
    }
    let error = capture(BARS, &["--controls", "--set", "Brightness=1"]).expect(2).stderr;
    assert!(error.contains("last as long as a capture"), "{error}");
}

#[test]
#[ignore = "tests/vm/run-libcamera"]
fn a_machine_without_a_camera_is_told_what_to_check() {
    const CAMERAS: &str = "/usr/share/libcamera/pipeline/virtual/virtual.yaml";
    std::fs::rename(CAMERAS, "/tmp/virtual.yaml").unwrap();
    let listed = host_sim(&["capture", "--list"]);
    let named = capture(BARS, &["--frames", "1"]);
    std::fs::rename("/tmp/virtual.yaml", CAMERAS).unwrap();
    let text = listed.expect(0).stdout;
    assert!(text.contains("libcamera: it finds no camera") || text.contains("--v4l2"), "{text}");
    let error = named.expect(2).stderr;
    assert!(error.contains("no capture device found"), "{error}");
}
