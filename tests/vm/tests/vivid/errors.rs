//! What goes wrong in a device, by vivid's own injection: each is a typed error or a count, and the device works afterwards.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use camif_vm::command::host_sim;
use host_sim::capture::v4l2::{V4l2, open, set_control};
use host_sim::capture::{CaptureDevice as _, CaptureError, Limits, Session, Settings, Statistics, capture};

use crate::{ONE, PLANES, cameras};

fn start(path: &str, controls: &[(&str, &str)]) -> Result<V4l2, CaptureError> {
    let controls = controls.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    let settings =
        Settings { size: Some((320, 180)), rate: Some(50.0), controls, buffers: 4, ..Settings::default() };
    V4l2::start(Path::new(path), &settings)
}

/// Captures so many frames; after each, `each` can do something to the device.
fn take(device: &mut V4l2, frames: u64, each: &mut dyn FnMut(&Statistics)) -> Session {
    let limits = Limits { frames: Some(frames), timeout: Duration::from_secs(3) };
    capture(device, limits, None, &AtomicBool::new(false), each)
}

/// Sets a control as another program would, while the device streams.
fn press(path: &str, control: &str, value: &str) {
    set_control(&open(Path::new(path)).unwrap(), control, value).unwrap();
}

/// The device gives whole frames.
fn works(path: &str) {
    let session = take(&mut start(path, &[]).unwrap(), 3, &mut |_| {});
    assert!(session.error.is_none() && session.statistics.is_clean(), "{session:?}");
    assert_eq!(session.statistics.good, 3);
}

#[test]
#[ignore = "tests/vm/run"]
fn dropped_buffers_are_counted_as_lost() {
    cameras();
    for path in [ONE, PLANES] {
        let mut device = start(path, &[("percentage_of_dropped_buffers", "50")]).unwrap();
        let session = take(&mut device, 20, &mut |_| {});
        drop(device);
        press(path, "percentage_of_dropped_buffers", "0");
        println!("{:?}", session.statistics);
        assert!(session.error.is_none() && session.statistics.good == 20, "{session:?}");
        assert!((3..100).contains(&session.statistics.lost), "{session:?}");
    }
}

#[test]
#[ignore = "tests/vm/run"]
fn a_device_that_sends_nothing_is_a_timeout() {
    cameras();
    press(ONE, "percentage_of_dropped_buffers", "100");
    let waited = std::time::Instant::now();
    let said = host_sim(&["capture", "--v4l2", ONE, "--timeout", "0.7"]).expect(2).stderr;
    press(ONE, "percentage_of_dropped_buffers", "0");
    assert!(said.contains("no frame for 0.") && said.contains("after 0 frames"), "{said}");
    assert!(waited.elapsed() >= Duration::from_millis(700));
    works(ONE);
}

#[test]
#[ignore = "tests/vm/run"]
fn a_frame_flagged_as_damaged_is_counted_and_not_used() {
    cameras();
    let folder = tempfile::tempdir().unwrap();
    for path in [ONE, PLANES] {
        let mut device = start(path, &[]).unwrap();
        let session = take(&mut device, 12, &mut |so_far| {
            if so_far.taken == 3 {
                press(path, "inject_v4l2_buf_flag_error", "1");
            }
        });
        assert!(session.error.is_none(), "{session:?}");
        assert_eq!((session.statistics.damaged, session.statistics.good), (1, 12), "{session:?}");
    }
    drop(folder);
    // The command says it, with status 1.
    let child = camif_vm::command::command(
        "host-sim",
        &["capture", "--v4l2", ONE, "--size", "320x180", "--frames", "150", "--json"],
    );
    let child = { child }.spawn().unwrap();
    std::thread::sleep(Duration::from_millis(700));
    press(ONE, "inject_v4l2_buf_flag_error", "1");
    let finished = camif_vm::command::Finished::of(child).expect(1);
    assert_eq!(finished.device()["damaged"], 1, "{finished:?}");
}

#[test]
#[ignore = "tests/vm/run"]
fn sequence_numbers_wrap_without_a_loss() {
    cameras();
    let mut device = start(ONE, &[("wrap_sequence_number", "on")]).unwrap();
    let mut sequences = Vec::new();
    for _ in 0..150 {
        sequences.push(device.next(Duration::from_secs(3)).unwrap().unwrap().sequence());
    }
    drop(device);
    assert!(sequences[0] > u32::MAX - 200 && *sequences.last().unwrap() < 1000, "{sequences:?}");
    let mut device = start(ONE, &[]).unwrap();
    let session = take(&mut device, 150, &mut |_| {});
    drop(device);
    press(ONE, "wrap_sequence_number", "off");
    let counted = session.statistics;
    assert_eq!((counted.good, counted.restarts), (150, 0), "{counted:?}");
    assert!(counted.lost < 50, "{counted:?}");
}

#[test]
#[ignore = "tests/vm/run"]
fn a_stream_that_fails_is_an_error_and_what_came_is_counted() {
    cameras();
    for path in [ONE, PLANES] {
        let mut device = start(path, &[]).unwrap();
        let session = take(&mut device, 100, &mut |so_far| {
            if so_far.taken == 4 {
                press(path, "inject_fatal_streaming_error", "1");
            }
        });
        match session.error {
            Some(CaptureError::Stopped { frames, what, .. }) => {
                assert!(frames >= 4 && what.starts_with("VIDIOC_DQBUF: "), "{frames} {what}");
            }
            other => panic!("{other:?}"),
        }
        drop(device);
        works(path);
    }
}

#[test]
#[ignore = "tests/vm/run"]
fn a_refusal_to_start_names_the_request() {
    cameras();
    for (control, request) in [
        ("inject_vidioc_streamon_error", "VIDIOC_STREAMON"),
        ("inject_vidioc_reqbufs_error", "VIDIOC_REQBUFS"),
    ] {
        for path in [ONE, PLANES] {
            press(path, control, "1");
            match start(path, &[]) {
                Err(CaptureError::Refused { setting, what, .. }) => {
                    assert_eq!(setting, "streaming");
                    assert!(what.starts_with(request), "{what}");
                }
                other => panic!("{control}: {other:?}"),
            }
            works(path);
        }
    }
}

#[test]
#[ignore = "tests/vm/run"]
fn a_buffer_that_is_not_taken_back_ends_the_capture() {
    cameras();
    let mut device = start(ONE, &[]).unwrap();
    let session = take(&mut device, 100, &mut |so_far| {
        if so_far.taken == 4 {
            press(ONE, "inject_vidioc_qbuf_error", "1");
        }
    });
    match session.error {
        Some(CaptureError::Stopped { what, .. }) => assert!(what.starts_with("VIDIOC_QBUF: "), "{what}"),
        other => panic!("{other:?}"),
    }
    drop(device);
    works(ONE);
}

#[test]
#[ignore = "tests/vm/run"]
fn an_unplugged_device_leaves_whole_files() {
    cameras();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let asked = ["capture", "--v4l2", ONE, "--size", "320x180", "--format", "RGB3", "--out", out, "--json"];
    let child = camif_vm::command::command("host-sim", &asked).spawn().unwrap();
    camif_vm::command::wait_until("five frames", || folder.path().join("frame-0004.png").exists());
    press(ONE, "disconnect", "1");
    let finished = camif_vm::command::Finished::of(child).expect(2);
    assert!(
        finished.stderr.contains("gone after") && finished.stderr.contains("plug it in again"),
        "{}",
        finished.stderr
    );
    let device = finished.device();
    let names: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().file_name()).collect();
    let good = device["good"].as_u64().unwrap() - device["dropped"].as_u64().unwrap();
    assert_eq!(names.len() as u64, 2 * good, "{names:?}");
    for number in 0..good {
        let path = folder.path().join(format!("frame-{number:04}.png"));
        let picture = host_sim::picture::read(&path).unwrap();
        assert_eq!(camif_vm::bars::difference(&picture, &camif_vm::bars::picture(320, 180, 255), 0).0, 0);
        assert_eq!(std::fs::read(path.with_extension("raw")).unwrap(), *picture.as_raw());
    }
    // The last user has gone, so vivid plugs itself in again.
    works(ONE);
}
