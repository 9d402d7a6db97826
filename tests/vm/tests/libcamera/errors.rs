//! What is refused says what, why and what to do; the camera works afterwards.

use std::fs;

use camif_vm::command::host_sim;

use crate::{BARS, LINES, capture};

fn assert_works(id: &str) {
    let _ = capture(id, &["--frames", "1"]).expect(0);
}

#[test]
#[ignore = "tests/vm/run-libcamera"]
fn what_is_not_offered_is_said() {
    for (arguments, said) in [
        (&["--format", "RGB3"][..], "Virtual0: no pixel format `RGB3`; there are NV12"),
        (&["--input", "1"], "Virtual0: --input was refused"),
        (&["--crop", "64x64+0+0"], "Virtual0: the crop 64x64+0+0 was refused: this camera can't crop"),
    ] {
        let error = capture(BARS, &[&["--frames", "1"], arguments].concat()).expect(2).stderr;
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
    for (arguments, said) in [
        // What it has not becomes the largest.
        (["--size", "641x479"], "asked for 641 × 479 pixels, the camera takes 640 × 480"),
        (["--rate", "1000"], "asked for 1000 frames a second, the camera takes 60.00"),
    ] {
        let finished = capture(BARS, &[&["--frames", "1"][..], &arguments].concat()).expect(0);
        assert!(finished.stderr.contains(said), "{arguments:?}: {}", finished.stderr);
    }
    let error = capture("Virtual7", &["--frames", "1"]).expect(2).stderr;
    assert!(error.contains("no camera `Virtual7`; there are ") && error.contains(LINES), "{error}");
}

/// libcamera keeps other programs out by the devices under a camera, of which virtual ones have none: so the same program asks
/// twice.
#[test]
#[ignore = "tests/vm/run-libcamera"]
fn a_camera_in_use_says_so() {
    let finished = capture(BARS, &["--libcamera", BARS, "--frames", "200", "--json"]).expect(2);
    let error = &finished.stderr;
    assert!(
        error.contains("Virtual0: to be captured from was refused")
            && error.contains("another program uses it"),
        "{error}"
    );
    // The other one goes on.
    let devices = finished.json()["devices"].as_array().unwrap().clone();
    assert_eq!((devices.len(), &devices[0]["taken"]), (1, &200.into()));
    assert_works(BARS);
}

/// Memory for frames is what virtual cameras take of the system.
#[test]
#[ignore = "tests/vm/run-libcamera"]
fn without_memory_for_frames_it_says_where_to_look() {
    fs::rename("/dev/dma_heap", "/dev/no-heap").unwrap();
    fs::rename("/dev/udmabuf", "/dev/no-udmabuf").unwrap();
    let listed = host_sim(&["capture", "--list"]);
    let refused = capture(BARS, &["--frames", "1"]);
    fs::rename("/dev/no-heap", "/dev/dma_heap").unwrap();
    fs::rename("/dev/no-udmabuf", "/dev/udmabuf").unwrap();
    assert!(listed.expect(0).stdout.contains(BARS));
    let error = refused.expect(2).stderr;
    assert!(error.contains("memory for frames was refused") && error.contains("/dev/dma_heap"), "{error}");
    assert_works(BARS);
}

/// Each capture starts libcamera and ends it, with frames under way.
#[test]
#[ignore = "tests/vm/run-libcamera"]
fn starting_and_ending_again_and_again_leaves_nothing_behind() {
    for _ in 0..5 {
        let device = capture(LINES, &["--frames", "3", "--json"]).expect(0).device();
        assert_eq!((&device["taken"], &device["error"]), (&3.into(), &serde_json::Value::Null));
    }
}
