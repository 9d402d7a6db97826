//! What becomes of frames: files, pictures, traces.

use std::fs;
use std::path::Path;

use camif_vm::command::{Finished, command, host_sim, interrupt, run, wait_until};

use crate::{BARS, LINES, assert_shows_bars, capture, read};

fn sequence(file: &serde_json::Value) -> u32 {
    u32::try_from(file["sequence"].as_u64().unwrap()).unwrap()
}

#[test]
#[ignore = "tests/vm/run-libcamera"]
fn frames_are_the_bars() {
    for (size, width, height) in [("640x480", 640, 480), ("320x240", 320, 240)] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().unwrap();
        let device =
            capture(BARS, &["--size", size, "--frames", "5", "--out", out, "--json"]).expect(0).device();
        assert_eq!(
            (&device["format"], &device["width"], &device["height"]),
            (&"NV12".into(), &width.into(), &height.into())
        );
        assert_eq!(
            (&device["lost"], &device["damaged"], &device["short"]),
            (&0.into(), &0.into(), &0.into())
        );
        // Nothing is copied: pictures are made of the camera's memory, which is written to files as it is.
        assert_eq!(device["copied_bytes_per_frame"], 0);
        let files = device["files"].as_array().unwrap();
        assert_eq!(files.len(), 5);
        for (number, file) in files.iter().enumerate() {
            let picture = read(folder.path(), &format!("frame-{number:04}.png"));
            assert_shows_bars(&picture, sequence(file));
            let raw = fs::read(folder.path().join(format!("frame-{number:04}.raw"))).unwrap();
            assert_eq!(raw.len(), (width * height * 3 / 2) as usize);
            assert_eq!(crc32fast::hash(&raw), u32::try_from(file["crc32"].as_u64().unwrap()).unwrap());
            // White's luma in the middle of its bar.
            let middle = (width / 16 + width - (sequence(file) + 1) % width) % width;
            assert_eq!(raw[(height / 2 * width + middle) as usize], 235);
        }
        fs::copy(folder.path().join("frame-0000.png"), format!("/out/libcamera-{size}.png")).unwrap();
    }
}

#[test]
#[ignore = "tests/vm/run-libcamera"]
fn lines_are_black_and_white_and_slanted() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let _ = capture(LINES, &["--frames", "1", "--out", out, "--keep", "png", "--rate", "30"]).expect(0);
    let picture = read(folder.path(), "frame-0000.png");
    assert_eq!(picture.dimensions(), (320, 180));
    let white = picture.pixels().filter(|pixel| pixel.0[1] > 250).count();
    let black = picture.pixels().filter(|pixel| pixel.0[1] < 5).count();
    assert!(white > 20_000 && black > 20_000, "{white} white, {black} black");
    // A line further down is the same, moved to the left by as much.
    let same = (0..300).filter(|x| picture.get_pixel(*x, 20) == picture.get_pixel(x + 10, 10)).count();
    assert!(same > 280, "{same} of 300");
    fs::copy(folder.path().join("frame-0000.png"), "/out/libcamera-lines.png").unwrap();
}

/// A real picture, through trace and block, comes out as it went in.
#[test]
#[ignore = "tests/vm/run-libcamera"]
fn frames_go_through_the_block() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (trace, captured, received) = (path("trace.camt"), path("captured"), path("received"));
    let _ = capture(
        BARS,
        &["--size", "640x480", "--frames", "2", "--out", &captured, "--keep", "png", "--as-trace", &trace],
    )
    .expect(0);
    let replayed = host_sim(&["replay", &trace, "--out", &received, "--json"]).expect(0).json();
    let frames = replayed["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 2);
    for (number, frame) in frames.iter().enumerate() {
        assert_eq!(frame["verdict"], "good");
        let name = format!("frame-{number:04}.png");
        let sent = read(Path::new(&captured), &name);
        assert!(sent == read(Path::new(&received), &name), "frame {number}");
        // As the bus had them: red, green and blue of each pixel.
        let raw = fs::read(Path::new(&received).join(format!("frame-{number:04}.raw"))).unwrap();
        assert!(raw == *sent.as_raw(), "frame {number}");
    }
}

#[test]
#[ignore = "tests/vm/run-libcamera"]
fn a_pipeline_runs_on_frames() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let op = "gray|canny:low=50,high=150";
    let _ = capture(BARS, &["--size", "320x240", "--frames", "1", "--out", out, "--keep", "png", "--op", op])
        .expect(0);
    let made = read(folder.path(), "frame-0000-op.png");
    let expected = folder.path().join("expected.png");
    let source = folder.path().join("frame-0000.png");
    let (source, expected) = (source.to_str().unwrap(), expected.to_str().unwrap());
    let _ = host_sim(&["process", source, "--op", op, "-o", expected]).expect(0);
    assert!(made == read(folder.path(), "expected.png"));
    assert!(made.pixels().any(|pixel| pixel.0 == [255; 3]), "no edge");
}

/// A picture takes longer than these cameras do: frames are left out with a count, and the camera goes on.
#[test]
#[ignore = "tests/vm/run-libcamera"]
fn ctrl_c_ends_with_whole_files_and_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let asked =
        ["capture", "--libcamera", BARS, "--size", "640x480", "--out", out, "--keep", "png", "--json"];
    let child = command("host-sim", &asked).spawn().unwrap();
    wait_until("six frames", || folder.path().join("frame-0005.png").exists());
    interrupt(&child);
    let device = Finished::of(child).expect(0).device();
    let (good, dropped) = (device["good"].as_u64().unwrap(), device["dropped"].as_u64().unwrap());
    assert!(dropped > 0, "{device}");
    assert_eq!(device["lost"], 0);
    let files = device["files"].as_array().unwrap();
    assert_eq!(
        (files.len() as u64, fs::read_dir(folder.path()).unwrap().count() as u64),
        (good - dropped, good - dropped)
    );
    for (number, file) in files.iter().enumerate() {
        assert_shows_bars(&read(folder.path(), &format!("frame-{number:04}.png")), sequence(file));
    }
}

/// Two of libcamera and one of the kernel's own in one command.
#[test]
#[ignore = "tests/vm/run-libcamera"]
fn several_cameras_of_both_kinds_at_once() {
    let _ = run("insmod", &["/modules/vivid.ko", "n_devs=1", "node_types=0x1"]).expect(0);
    wait_until("/dev/video0", || Path::new("/dev/video0").exists());
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let finished = host_sim(&[
        "capture",
        "--v4l2",
        "/dev/video0",
        "--libcamera",
        BARS,
        "--libcamera",
        LINES,
        "--frames",
        "2",
        "--out",
        out,
        "--json",
    ])
    .expect(0);
    let _ = run("rmmod", &["vivid"]).expect(0);
    let devices = finished.json()["devices"].as_array().unwrap().clone();
    let names: Vec<&str> = devices.iter().flat_map(|device| device["device"].as_str()).collect();
    assert_eq!(names, ["/dev/video0", BARS, LINES]);
    for folder_name in ["video0", BARS, LINES] {
        let files = fs::read_dir(folder.path().join(folder_name)).unwrap().count();
        assert_eq!(files, 4, "{folder_name}");
    }
}
