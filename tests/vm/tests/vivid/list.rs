use std::collections::BTreeSet;

use camif_vm::command::{host_sim, run};

use crate::{ONE, PLANES, cameras, load, v4l2_ctl};

#[test]
#[ignore = "tests/vm/run"]
fn a_machine_without_a_camera_is_told_what_to_check() {
    let loaded = run("rmmod", &["vivid"]).status == Some(0);
    let listed = host_sim(&["capture", "--list"]).expect(0);
    assert!(listed.stdout.starts_with("no capture device found\n"), "{}", listed.stdout);
    assert!(listed.stdout.contains("modprobe"), "{}", listed.stdout);
    let listed = host_sim(&["capture", "--list", "--json"]).expect(0).json();
    assert_eq!(listed["devices"].as_array().unwrap().len(), 0);
    let said = host_sim(&["capture", "--frames", "1"]).expect(2).stderr;
    assert_eq!(said, "error: no capture device found; `host-sim capture --list` says what to check\n");
    let said = host_sim(&["capture", "--v4l2", ONE, "--frames", "1"]).expect(2).stderr;
    assert!(said.contains("No such file") && said.contains("--list"), "{said}");
    if loaded {
        load();
    }
}

/// Codes, sizes and rates are those that `v4l2-ctl` finds.
#[test]
#[ignore = "tests/vm/run"]
fn everything_that_a_device_offers_is_listed() {
    cameras();
    let listed = host_sim(&["capture", "--list", "--json"]).expect(0).json();
    let devices = listed["devices"].as_array().unwrap();
    assert_eq!([&devices[0]["id"], &devices[1]["id"]], [ONE, PLANES]);
    for device in devices {
        assert_eq!(device["name"], "vivid");
        let inputs: Vec<&str> =
            device["inputs"].as_array().unwrap().iter().flat_map(|name| name.as_str()).collect();
        assert_eq!(inputs, ["Webcam 0", "TV 0", "S-Video 0", "HDMI 0"]);
        let ours: BTreeSet<String> = device["formats"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|format| {
                let code = format["code"].as_str().unwrap();
                let sizes = format["sizes"].as_array().unwrap().iter();
                sizes.flat_map(move |size| {
                    let rates = size["rates"].as_array().unwrap().iter();
                    rates.map(move |rate| {
                        format!("{code} {}x{} {:.3}", size["width"], size["height"], rate.as_f64().unwrap())
                    })
                })
            })
            .collect();
        let text = v4l2_ctl(device["id"].as_str().unwrap(), &["--list-formats-ext"]);
        let (mut code, mut size) = (String::new(), String::new());
        let mut theirs = BTreeSet::new();
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            if let Some((_, rest)) = line.split_once("]: '") {
                code = rest.split('\'').next().unwrap().replace(' ', "");
            } else if let ["Size:", "Discrete", found] = words[..] {
                size = found.to_owned();
            } else if let ["Interval:", "Discrete", _, rate, "fps)"] = words[..] {
                theirs.insert(format!("{code} {size} {}", rate.trim_start_matches('(')));
            }
        }
        assert!(theirs.len() > 500, "{text}");
        assert_eq!(ours, theirs);
    }
    let text = host_sim(&["capture", "--list"]).expect(0).stdout;
    assert!(
        text.starts_with("--v4l2 /dev/video0  vivid (vivid, platform:vivid-000)\n  --input 0  Webcam 0\n"),
        "{text}"
    );
}
